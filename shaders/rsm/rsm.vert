// Transforms mesh vertices for the sun. For other lights (flag PERSPECTIVE) the geometry shader projects them.
#if !PERSPECTIVE
#include "lib/frame.glsl"
#endif
layout(location = 0) in vec3 position;
layout(location = 1) in vec2 texCoord;
layout(location = 2) in vec3 normal;
#if PERSPECTIVE
out vec3 gNormal;
out vec2 gTexCoord;
#else
out vec3 vPosition;
out vec3 vNormal;
out vec2 vTexCoord;
#endif

void main() {
#if PERSPECTIVE
  gNormal = normal;
  gTexCoord = texCoord;
  gl_Position = vec4(position, 1.0);
#else
  vPosition = position;
  vNormal = normal;
  vTexCoord = texCoord;
  gl_Position = frame.sunClipFromWorld * vec4(position, 1.0);
#endif
}
