// Writes the sum of all wavefronts in the lookup's format. Used without joined cascades.
#include "cascades/block.glsl"
#include "lpv/sums.glsl"
#include "lpv/result.glsl"
layout(local_size_x = GROUP_X, local_size_y = GROUP_Y, local_size_z = 1) in;

void main() {
  ivec3 cell = ivec3(gl_GlobalInvocationID);
  int cells = grids.shape.x, layers = cells * grids.shape.y;
  if (any(greaterThanEqual(cell, ivec3(cells, cells, layers)))) return;
  int at = (cell.z * cells + cell.y) * cells + cell.x, channel = cells * cells * layers;
  texels[at] = asTexel(SUM_AT(nearSums, cell, 0));
  texels[at + channel] = asTexel(SUM_AT(nearSums, cell, 1));
  texels[at + 2 * channel] = asTexel(SUM_AT(nearSums, cell, 2));
}
