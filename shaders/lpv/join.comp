// Joins the cascades, from the coarsest to the finest, one a dispatch: C_k = b_k (M_k + F_k) + up(R_k+1), R_k = b_k F_k + up(R_k+1).
//
// In a fixed number of steps light travels a fixed number of cells, so a finer grid brings it less far: blended as they are,
// grids would darken the picture with each cascade more; summed, as in the published text, they would brighten it. So each
// grid's sum is kept in two parts: M, the light of the first steps, which the next finer grid carries by itself and better, and F, that
// of the later ones, which is too far-travelled for it. A finer grid takes the coarser grids' F over: every step of the light is
// counted once, nothing is ever subtracted. The balance b_k (lpv/balance.comp) makes the finer grid as bright, on the average over a coarser cell,
// as the M that it replaces, so that it adds detail and leaves the brightness alone.
#include "lpv/common.glsl"
#include "lpv/stacked.glsl"
layout(local_size_x = GROUP_X, local_size_y = GROUP_Y, local_size_z = 1) in;
layout(binding = 0) uniform sampler3D farRed;  // the layers of the next coarser cascade are read, those of this one written
layout(binding = 1) uniform sampler3D farGreen;
layout(binding = 2) uniform sampler3D farBlue;
layout(binding = 3) uniform sampler3D balances;  // of this cascade, one for 2x2x2 cells
layout(binding = 0, LPV_FORMAT) uniform image3D sumImageRed;  // M, becomes C
layout(binding = 1, LPV_FORMAT) uniform image3D sumImageGreen;
layout(binding = 2, LPV_FORMAT) uniform image3D sumImageBlue;
layout(binding = 3, LPV_FORMAT) uniform image3D farImageRed;  // F, becomes R
layout(binding = 4, LPV_FORMAT) uniform image3D farImageGreen;
layout(binding = 5, LPV_FORMAT) uniform image3D farImageBlue;
uniform int cascade;

void main() {
  ivec3 cell = ivec3(gl_GlobalInvocationID);
  int cells = lpv.shape.x;
  if (any(greaterThanEqual(cell, ivec3(cells)))) return;
  ivec3 at = ivec3(cell.xy, cascade * cells + cell.z);

  vec4 coarserRed = vec4(0.0), coarserGreen = vec4(0.0), coarserBlue = vec4(0.0);
  float balance = 1.0;
  if (cascade + 1 < lpv.shape.y) {
    vec3 centre = vec3(cell) + 0.5;
    StackedTexel coarser = stackedTexel(lpvCoarserTexel(centre, cascade), cascade + 1);
    coarserRed = coarser.border * textureLod(farRed, coarser.uvw, 0.0);
    coarserGreen = coarser.border * textureLod(farGreen, coarser.uvw, 0.0);
    coarserBlue = coarser.border * textureLod(farBlue, coarser.uvw, 0.0);
    balance = textureLod(balances, centre / float(2 * ((cells + 1) / 2)), 0.0).x;
  }
#define JOIN(sumImage, farImage, coarser)                              \
  {                                                                    \
    vec4 farLight = balance * imageLoad(farImage, at) + coarser;       \
    imageStore(sumImage, at, balance * imageLoad(sumImage, at) + farLight); \
    imageStore(farImage, at, farLight);                                \
  }
  JOIN(sumImageRed, farImageRed, coarserRed)
  JOIN(sumImageGreen, farImageGreen, coarserGreen)
  JOIN(sumImageBlue, farImageBlue, coarserBlue)
}
