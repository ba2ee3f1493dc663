// Transforms mesh vertices for the light. Flag LAYERS: number of target views that the geometry shader projects to; 1:
// there is no geometry shader.
#if !PERSPECTIVE
#include "lib/frame.glsl"
#endif
layout(location = 0) in vec3 position;
layout(location = 1) in vec2 texCoord;
layout(location = 2) in vec3 normal;
#if LAYERS > 1
out vec3 gNormal;
out vec2 gTexCoord;
#else
out vec3 vPosition;
out vec3 vNormal;
out vec2 vTexCoord;
#if PERSPECTIVE
uniform mat4 clipFromPlace[1];  // of positions relative to viewPlace
uniform vec3 viewPlace[1];
#endif
#endif

void main() {
#if LAYERS > 1
  gNormal = normal;
  gTexCoord = texCoord;
  gl_Position = vec4(position, 1.0);
#else
  vPosition = position;
  vNormal = normal;
  vTexCoord = texCoord;
#if PERSPECTIVE
  gl_Position = clipFromPlace[0] * vec4(position - viewPlace[0], 1.0);
#else
  gl_Position = frame.sunClipFromWorld * vec4(position, 1.0);
#endif
#endif
}
