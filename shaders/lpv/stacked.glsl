// Trilinear interpolation in one cascade of a stack that lies in a buffer, x fastest. Values outside are zero, as with
// filtered textures.
#include "lib/clamped_int.glsl"
struct StackedTexels {
  int at[8];
  float weight[8];
};

StackedTexels stackedTexels(vec3 texel, int index) {
  int n = grids.shape.x;
  ivec3 low = clampedInt(floor(texel - 0.5), ivec3(-2), ivec3(n + 1));
  vec3 upper = clamp(texel - 0.5 - vec3(low), 0.0, 1.0);
  StackedTexels result;
  for (int i = 0; i < 8; ++i) {
    ivec3 bit = ivec3(i & 1, i >> 1 & 1, i >> 2), cell = low + bit;
    vec3 weight = mix(1.0 - upper, upper, vec3(bit));
    bool inside = all(greaterThanEqual(cell, ivec3(0))) && all(lessThan(cell, ivec3(n)));
    cell = clamp(cell, ivec3(0), ivec3(n - 1));
    result.at[i] = ((index * n + cell.z) * n + cell.y) * n + cell.x;
    result.weight[i] = inside ? weight.x * weight.y * weight.z : 0.0;
  }
  return result;
}

// Maps a point of a cascade, in its cells, to the next coarser cascade.
vec3 lpvCoarserTexel(vec3 texel, int cascade) {
  vec3 position = grids.cascades[cascade].minimum + texel * grids.cascades[cascade].cellSize;
  return (position - grids.cascades[cascade + 1].minimum) / grids.cascades[cascade + 1].cellSize;
}
