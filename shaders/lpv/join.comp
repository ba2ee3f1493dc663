// Joins the cascades from the coarsest to the finest, one per dispatch: C_k = b_k (M_k + F_k) + up(R_k+1), R_k = b_k
// F_k + up(R_k+1).
//
// In a fixed number of steps light travels a fixed number of cells, so a finer grid carries it less far. Simply
// blending the grids would darken the picture with each added cascade; summing them, as in the published text, would
// brighten it. So each grid's sum is kept in two parts: M, the light of the first steps, which the next finer grid
// computes itself and more accurately, and F, the light of the later steps, which travels too far for the finer grid. A
// finer grid takes over F from the coarser grids: every step of the light counts once, and nothing is ever subtracted.
// The balance b_k (lpv/balance.comp) makes the finer grid as bright, averaged over a coarser cell, as the M it
// replaces. It therefore adds detail and preserves brightness.
#include "cascades/block.glsl"
#include "lpv/stacked.glsl"
#include "lpv/sums.glsl"
#include "lpv/result.glsl"
layout(local_size_x = GROUP_X, local_size_y = GROUP_Y, local_size_z = 1) in;
layout(binding = 6) uniform samplerBuffer coarserReceived;  // R of the next coarser cascade
layout(binding = 7) uniform samplerBuffer balances;         // of this cascade, one per 2x2x2 cells
// aliased Received: reads the next coarser cascade and writes this one
layout(std430, binding = 0) writeonly buffer Received { vec4 received[]; };  // R of this cascade
// band 0 of b M, summed over the channels, for lpv/balance.comp
layout(std430, binding = 2) writeonly buffer Balanced { float balanced[]; };
uniform int cascade;

// Interpolates between the balances, one per 2x2x2 cells; clamps at the border.
float balanceAt(ivec3 cell) {
  int pairs = (grids.shape.x + 1) / 2;
  vec3 texel = 0.5 * (vec3(cell) + 0.5) - 0.5;
  ivec3 low = ivec3(floor(texel));  // bounded: half a cell's index
  vec3 upper = texel - vec3(low);
  float balance = 0.0;
  for (int i = 0; i < 8; ++i) {
    ivec3 bit = ivec3(i & 1, i >> 1 & 1, i >> 2), at = clamp(low + bit, ivec3(0), ivec3(pairs - 1));
    vec3 weight = mix(1.0 - upper, upper, vec3(bit));
    balance += weight.x * weight.y * weight.z * texelFetch(balances, (at.z * pairs + at.y) * pairs + at.x).x;
  }
  return balance;
}

void main() {
  ivec3 cell = ivec3(gl_GlobalInvocationID);
  int cells = grids.shape.x;
  if (any(greaterThanEqual(cell, ivec3(cells)))) return;
  ivec3 inStack = ivec3(cell.xy, cascade * cells + cell.z);
  int at = (inStack.z * cells + cell.y) * cells + cell.x, channel = cells * cells * cells * grids.shape.y;

  vec4 coarser[3] = vec4[3](vec4(0.0), vec4(0.0), vec4(0.0));
  float balance = 1.0;
#if HAS_COARSER
  StackedTexels around = stackedTexels(lpvCoarserTexel(vec3(cell) + 0.5, cascade), cascade + 1);
  for (int i = 0; i < 8; ++i)
    for (int c = 0; c < 3; ++c)
      coarser[c] += around.weight[i] * texelFetch(coarserReceived, around.at[i] + c * channel);
  balance = balanceAt(cell);
#endif
  float brightness = 0.0;
#define JOIN(c)                                                              \
  {                                                                          \
    vec4 nearLight = SUM_AT(nearSums, inStack, c);                           \
    vec4 all = balance * SUM_AT(farSums, inStack, c) + coarser[c];           \
    received[at + c * channel] = all;                                        \
    texels[at + c * channel] = asTexel(balance * nearLight + all);           \
    brightness += nearLight.x;                                               \
  }
  JOIN(0)
  JOIN(1)
  JOIN(2)
  balanced[at] = balance * brightness;
}
