// Depth only, from the sun (shadow map) or from the camera (depth pre-pass, so that hidden surfaces are not shaded).
#include "lib/frame.glsl"
#include "lib/lamp_place.glsl"
invariant gl_Position;  // the shading pass must compute exactly this depth
layout(location = 0) in vec3 position;
#if ALPHA_MASK
layout(location = 1) in vec2 texCoord;
centroid out vec2 vTexCoord;
#endif

void main() {
#if FROM_SUN
  gl_Position = frame.sunClipFromWorld * vec4(position, 1.0);
#else
  gl_Position = drawnAt(position);
#endif
#if ALPHA_MASK
  vTexCoord = texCoord;
#endif
}
