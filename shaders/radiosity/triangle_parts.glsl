// A patch divided into 4 x 4 equal triangles, numbered as in engine/scene/triangle_parts.hpp.
#include "lib/clamped_int.glsl"
const int kPatchParts = 16;

// Weights of the second and third corner at a part's centroid.
vec2 partCentroid(int part) {
  int i = part < 7 ? 0 : part < 12 ? 1 : part < 15 ? 2 : 3, j = part - i * (8 - i);
  float third = (j & 1) == 0 ? 1.0 / 3.0 : 2.0 / 3.0;
  return 0.25 * (vec2(i, j / 2) + third);
}

// The part that contains a point.
int partAt(vec2 weights) {
  vec2 at = 4.0 * weights;
  int i = clampedInt(at.x, 0, 3), pair = clampedInt(at.y, 0, 3 - i);
  int upsideDown = at.x - float(i) + at.y - float(pair) > 1.0 ? 1 : 0;
  return i * (8 - i) + min(2 * pair + upsideDown, 6 - 2 * i);
}
