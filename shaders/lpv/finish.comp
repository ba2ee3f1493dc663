// A sum of fronts as a texture, which the lookup or, in 32 bits, lpv/join.comp filters: from the steps' buffer, or from the textures that the
// layered pass blends into.
#include "lpv/common.glsl"
#include "lpv/storage.glsl"
layout(local_size_x = GROUP_X, local_size_y = GROUP_Y, local_size_z = 1) in;
#if FROM_BUFFER
layout(std430, binding = 2) readonly buffer Sums { vec4 sums[]; };
#else
layout(binding = 0) uniform sampler3D sumRed;
layout(binding = 1) uniform sampler3D sumGreen;
layout(binding = 2) uniform sampler3D sumBlue;
#endif
#if JOINED
#define RESULT_FORMAT rgba32f
#define RESULT(sum) sum
#else
#define RESULT_FORMAT LPV_FORMAT
#define RESULT(sum) toTexel(sum)
#endif
layout(binding = 0, RESULT_FORMAT) writeonly uniform image3D resultRed;
layout(binding = 1, RESULT_FORMAT) writeonly uniform image3D resultGreen;
layout(binding = 2, RESULT_FORMAT) writeonly uniform image3D resultBlue;

void main() {
  ivec3 cell = ivec3(gl_GlobalInvocationID);
  int cells = lpv.shape.x, layers = cells * lpv.shape.y;
  if (any(greaterThanEqual(cell, ivec3(cells, cells, layers)))) return;
#if FROM_BUFFER
  int at = (cell.z * cells + cell.y) * cells + cell.x, channel = cells * cells * layers;
  vec4 sum[3] = vec4[3](sums[at], sums[at + channel], sums[at + 2 * channel]);
#else
  vec4 sum[3] = vec4[3](texelFetch(sumRed, cell, 0), texelFetch(sumGreen, cell, 0), texelFetch(sumBlue, cell, 0));
#endif
  imageStore(resultRed, cell, RESULT(sum[0]));
  imageStore(resultGreen, cell, RESULT(sum[1]));
  imageStore(resultBlue, cell, RESULT(sum[2]));
}
