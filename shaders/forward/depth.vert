// Depth from the light: the shadow map's only stage for opaque meshes.
#include "lib/frame.glsl"
layout(location = 0) in vec3 position;
#if ALPHA_MASK
layout(location = 1) in vec2 texCoord;
out vec2 vTexCoord;
#endif

void main() {
  gl_Position = frame.sunClipFromWorld * vec4(position, 1.0);
#if ALPHA_MASK
  vTexCoord = texCoord;
#endif
}
