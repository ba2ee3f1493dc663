// Joins one cascade to the next coarser one, already joined: C_k = G_k - up(down(G_k)) + up(C_k+1).
//
// In a fixed number of steps light travels a fixed number of cells, so a finer grid brings it less far: blended as they are,
// grids would darken the picture with each cascade more; summed, as in the published text, they would brighten it. But what a
// finer grid lacks came from afar and varies slowly, so the coarser grid has it; what the finer grid adds is detail. So each
// cascade contributes only what the next coarser one cannot represent, its field less its own half-resolution copy (a Laplacian
// pyramid [Burt1983]): the mean stays that of the coarsest grid, however many cascades there are.
#include "lpv/common.glsl"
layout(local_size_x = GROUP_X, local_size_y = GROUP_Y, local_size_z = 1) in;
layout(binding = 0) uniform sampler3D coarseRed;   // down(G), linear
layout(binding = 1) uniform sampler3D coarseGreen;
layout(binding = 2) uniform sampler3D coarseBlue;
layout(binding = 3) uniform sampler3D joinedRed;   // the layers of C_k+1 are read, those of cascade k written
layout(binding = 4) uniform sampler3D joinedGreen;
layout(binding = 5) uniform sampler3D joinedBlue;
layout(binding = 0, LPV_FORMAT) uniform image3D sumRed;
layout(binding = 1, LPV_FORMAT) uniform image3D sumGreen;
layout(binding = 2, LPV_FORMAT) uniform image3D sumBlue;
uniform int cascade;

// Trilinear reading of one cascade out of a stack of them, zero outside; `texel` in texels of that cascade.
struct StackedTexel {
  vec3 uvw;
  float border;
};

StackedTexel stacked(vec3 texel, int index, int side, int count) {
  float n = float(side);
  float border = clamp(min(texel.z, n - texel.z) + 0.5, 0.0, 1.0);
  texel.z = clamp(texel.z, 0.5, n - 0.5) + float(index) * n;
  return StackedTexel(texel / vec3(n, n, n * float(count)), border);
}

void main() {
  ivec3 cell = ivec3(gl_GlobalInvocationID);
  int cells = lpv.shape.x;
  if (any(greaterThanEqual(cell, ivec3(cells)))) return;
  vec3 centre = vec3(cell) + 0.5;
  int half_ = (cells + 1) / 2;
  StackedTexel own = stacked(0.5 * centre, cascade, half_, lpv.shape.y - 1);
  vec3 position = lpv.cascades[cascade].minimum + centre * lpv.cascades[cascade].cellSize;
  vec3 next = (position - lpv.cascades[cascade + 1].minimum) / lpv.cascades[cascade + 1].cellSize;
  StackedTexel joined = stacked(next, cascade + 1, cells, lpv.shape.y);
  ivec3 at = ivec3(cell.xy, cascade * cells + cell.z);
#define JOIN(sum, coarse, finished)                                                          \
  imageStore(sum, at, imageLoad(sum, at) - own.border * textureLod(coarse, own.uvw, 0.0) +   \
                          joined.border * textureLod(finished, joined.uvw, 0.0))
  JOIN(sumRed, coarseRed, joinedRed);
  JOIN(sumGreen, coarseGreen, joinedGreen);
  JOIN(sumBlue, coarseBlue, joinedBlue);
}
