// Where a vertex of a moving object is, and was in the frame before.
#include "lib/frame.glsl"
#include "lib/lamp_place.glsl"
invariant gl_Position;  // exactly the depth that depth.vert has drawn
layout(location = 0) in vec3 position;
layout(location = 3) in vec3 positionBefore;
uniform mat4 clipFromWorldCentred, clipFromWorldBefore;  // of this frame, through pixels' centres; of the one before
out vec4 vNow;
out vec4 vBefore;
#if ALPHA_MASK
layout(location = 1) in vec2 texCoord;
centroid out vec2 vTexCoord;
#endif

void main() {
  gl_Position = drawnAt(position);
  vNow = clipFromWorldCentred * vec4(position, 1.0);
  vBefore = clipFromWorldBefore * vec4(positionBefore, 1.0);
#if ALPHA_MASK
  vTexCoord = texCoord;
#endif
}
