// Half resolution of every cascade but the coarsest: each texel the mean of 2x2x2 cells, what the next coarser grid can
// represent of this one. Stored as c / (E_ref s^2), a mean of these is comparable between cascades.
#include "lpv/common.glsl"
layout(local_size_x = GROUP_X, local_size_y = GROUP_Y, local_size_z = 1) in;
layout(binding = 0) uniform sampler3D sumRed;
layout(binding = 1) uniform sampler3D sumGreen;
layout(binding = 2) uniform sampler3D sumBlue;
layout(binding = 0, LPV_FORMAT) writeonly uniform image3D coarseRed;
layout(binding = 1, LPV_FORMAT) writeonly uniform image3D coarseGreen;
layout(binding = 2, LPV_FORMAT) writeonly uniform image3D coarseBlue;

void main() {
  ivec3 at = ivec3(gl_GlobalInvocationID);
  int cells = lpv.shape.x;
  int half_ = (cells + 1) / 2;
  if (any(greaterThanEqual(at, ivec3(half_, half_, half_ * (lpv.shape.y - 1))))) return;
  ivec3 layer = ivec3(0, 0, at.z / half_ * cells);
  ivec3 first = 2 * ivec3(at.xy, at.z % half_);
  vec4 red = vec4(0.0), green = vec4(0.0), blue = vec4(0.0);
  for (int i = 0; i < 8; ++i) {
    ivec3 cell = first + ivec3(i & 1, i >> 1 & 1, i >> 2);
    if (any(greaterThanEqual(cell, ivec3(cells)))) continue;  // an odd last cell: dark beyond it, not the next cascade's
    red += 0.125 * texelFetch(sumRed, layer + cell, 0);
    green += 0.125 * texelFetch(sumGreen, layer + cell, 0);
    blue += 0.125 * texelFetch(sumBlue, layer + cell, 0);
  }
  imageStore(coarseRed, at, red);
  imageStore(coarseGreen, at, green);
  imageStore(coarseBlue, at, blue);
}
