// The balance between a cascade and the next coarser one, which is already joined: one value per 2x2x2 cells, b = (M' +
// dark) / (own + dark).
//
// own is the cascade's own light M + F averaged over the eight cells; M' is the coarser cascade's M at their centre,
// which these cells replace. Both are band 0, summed over the three channels and stored as c / (E_ref s^2), so they are
// comparable. The quotient is taken here, per cell, and lpv/join.comp interpolates it. Interpolating the two
// brightnesses instead lets dark cells behind walls leak into the quotient next to them, which then no longer preserves
// a cell's mean (docs/measurements/lpv.md has the figures).
#include "cascades/block.glsl"
#include "lpv/stacked.glsl"
#include "lpv/sums.glsl"
layout(local_size_x = GROUP_X, local_size_y = GROUP_Y, local_size_z = 1) in;
layout(binding = 6) uniform samplerBuffer balanced;  // b M of the coarser cascade, band 0 summed over the channels
layout(std430, binding = 3) writeonly buffer Balances { float balances[]; };
uniform int cascade;

const float kLargestBalance = 4.0;  // and its inverse the smallest: a guard for where one grid has no light
const float kDark = 1e-4;           // c / (E_ref s^2) below which there is nothing to balance

void main() {
  ivec3 at = ivec3(gl_GlobalInvocationID);
  int cells = grids.shape.x, pairs = (cells + 1) / 2;
  if (any(greaterThanEqual(at, ivec3(pairs)))) return;
  float own = 0.0;
  for (int i = 0; i < 8; ++i) {
    ivec3 cell = 2 * at + ivec3(i & 1, i >> 1 & 1, i >> 2);
    // with an odd number of cells the last block of two extends beyond the cascade
    if (any(greaterThanEqual(cell, ivec3(cells)))) continue;
    cell.z += cascade * cells;
    own += SUM_AT(nearSums, cell, 0).x + SUM_AT(nearSums, cell, 1).x + SUM_AT(nearSums, cell, 2).x +
           SUM_AT(farSums, cell, 0).x + SUM_AT(farSums, cell, 1).x + SUM_AT(farSums, cell, 2).x;
  }
  StackedTexels coarser = stackedTexels(lpvCoarserTexel(vec3(2 * at + 1), cascade), cascade + 1);
  float replaced = 0.0;
  for (int i = 0; i < 8; ++i) replaced += coarser.weight[i] * texelFetch(balanced, coarser.at[i]).x;
  float b = (max(replaced, 0.0) + kDark) / (0.125 * own + kDark);
  balances[(at.z * pairs + at.y) * pairs + at.x] = clamp(b, 1.0 / kLargestBalance, kLargestBalance);
}
