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
#include "lpv/storage.glsl"
layout(local_size_x = GROUP_X, local_size_y = GROUP_Y, local_size_z = 1) in;
layout(binding = 0) uniform sampler3D farRed;  // F of this cascade, R of the next coarser one
layout(binding = 1) uniform sampler3D farGreen;
layout(binding = 2) uniform sampler3D farBlue;
layout(binding = 3) uniform sampler3D nearRed;  // M
layout(binding = 4) uniform sampler3D nearGreen;
layout(binding = 5) uniform sampler3D nearBlue;
layout(binding = 7) uniform sampler3D balances;  // of this cascade, one for 2x2x2 cells
layout(binding = 0, rgba32f) writeonly uniform image3D farImageRed;  // becomes R
layout(binding = 1, rgba32f) writeonly uniform image3D farImageGreen;
layout(binding = 2, rgba32f) writeonly uniform image3D farImageBlue;
layout(binding = 3, LPV_FORMAT) writeonly uniform image3D resultRed;  // C
layout(binding = 4, LPV_FORMAT) writeonly uniform image3D resultGreen;
layout(binding = 5, LPV_FORMAT) writeonly uniform image3D resultBlue;
layout(binding = 6, r32f) writeonly uniform image3D balanced;  // band 0 of b M, the channels together, for lpv/balance.comp
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
  vec4 nearLight[3] = vec4[3](texelFetch(nearRed, at, 0), texelFetch(nearGreen, at, 0), texelFetch(nearBlue, at, 0));
#define JOIN(channel, farLight, farImage, result, coarser)                       \
  {                                                                              \
    vec4 received = balance * texelFetch(farLight, at, 0) + coarser;             \
    imageStore(farImage, at, received);                                          \
    imageStore(result, at, toTexel(balance * nearLight[channel] + received));    \
  }
  JOIN(0, farRed, farImageRed, resultRed, coarserRed)
  JOIN(1, farGreen, farImageGreen, resultGreen, coarserGreen)
  JOIN(2, farBlue, farImageBlue, resultBlue, coarserBlue)
  imageStore(balanced, at, vec4(balance * (nearLight[0].x + nearLight[1].x + nearLight[2].x)));
}
