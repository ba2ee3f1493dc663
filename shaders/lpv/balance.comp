// The balance of a cascade with the next coarser one, already joined: one value for 2x2x2 cells, b = (M' + dark) / (own + dark).
//
// own is the mean over the eight cells of the cascade's own light, M + F; M' is the coarser cascade's M at their centre, which the eight
// replace. Both are band 0, red, green and blue together, stored as c / (E_ref s^2), so that they are comparable. The quotient is taken here,
// a cell at a time, and lpv/join.comp interpolates it: interpolating the two brightnesses instead lets dark cells behind walls into
// the quotient beside them, which then no longer keeps a cell's mean (engine/lpv/README.md has the figures).
#include "lpv/common.glsl"
#include "lpv/stacked.glsl"
layout(local_size_x = GROUP_X, local_size_y = GROUP_Y, local_size_z = 1) in;
layout(binding = 0) uniform sampler3D farRed;  // F, of the coarser cascade R
layout(binding = 1) uniform sampler3D farGreen;
layout(binding = 2) uniform sampler3D farBlue;
layout(binding = 3) uniform sampler3D sumRed;  // M, of the coarser cascade C = b M + R
layout(binding = 4) uniform sampler3D sumGreen;
layout(binding = 5) uniform sampler3D sumBlue;
layout(binding = 0, r32f) writeonly uniform image3D balance;
uniform int cascade;

const float kLargestBalance = 4.0;  // and its inverse the smallest: a guard where one of the grids sees no light at all
const float kDark = 1e-4;           // c / (E_ref s^2) below which there is no light to balance

void main() {
  ivec3 at = ivec3(gl_GlobalInvocationID);
  int cells = lpv.shape.x;
  if (any(greaterThanEqual(at, ivec3((cells + 1) / 2)))) return;
  float own = 0.0;
  for (int i = 0; i < 8; ++i) {
    ivec3 cell = 2 * at + ivec3(i & 1, i >> 1 & 1, i >> 2);
    if (any(greaterThanEqual(cell, ivec3(cells)))) continue;  // with an odd number of cells the last pair reaches beyond the cascade
    cell.z += cascade * cells;
    own += texelFetch(sumRed, cell, 0).x + texelFetch(sumGreen, cell, 0).x + texelFetch(sumBlue, cell, 0).x +
           texelFetch(farRed, cell, 0).x + texelFetch(farGreen, cell, 0).x + texelFetch(farBlue, cell, 0).x;
  }
  StackedTexel coarser = stackedTexel(lpvCoarserTexel(vec3(2 * at + 1), cascade), cascade + 1);
  float replaced = coarser.border * (textureLod(sumRed, coarser.uvw, 0.0).x + textureLod(sumGreen, coarser.uvw, 0.0).x +
                                     textureLod(sumBlue, coarser.uvw, 0.0).x - textureLod(farRed, coarser.uvw, 0.0).x -
                                     textureLod(farGreen, coarser.uvw, 0.0).x - textureLod(farBlue, coarser.uvw, 0.0).x);
  float b = (max(replaced, 0.0) + kDark) / (0.125 * own + kDark);
  imageStore(balance, at, vec4(clamp(b, 1.0 / kLargestBalance, kLargestBalance)));
}
