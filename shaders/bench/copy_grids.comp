// What a propagation step must at least do: read one set of grids and write the next, and add to the sum. A yardstick of `lucerna bench
// tables`; no technique uses it.
#include "lpv/common.glsl"
layout(local_size_x = GROUP_X, local_size_y = GROUP_Y, local_size_z = 1) in;
layout(binding = 0) uniform sampler3D sourceRed;
layout(binding = 1) uniform sampler3D sourceGreen;
layout(binding = 2) uniform sampler3D sourceBlue;
layout(binding = 0, LPV_FORMAT) writeonly uniform image3D nextRed;
layout(binding = 1, LPV_FORMAT) writeonly uniform image3D nextGreen;
layout(binding = 2, LPV_FORMAT) writeonly uniform image3D nextBlue;
#if WITH_SUM
layout(binding = 3, LPV_FORMAT) uniform image3D sumRed;
layout(binding = 4, LPV_FORMAT) uniform image3D sumGreen;
layout(binding = 5, LPV_FORMAT) uniform image3D sumBlue;
#endif

void main() {
  ivec3 cell = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(cell, textureSize(sourceRed, 0)))) return;
  vec4 red = texelFetch(sourceRed, cell, 0), green = texelFetch(sourceGreen, cell, 0), blue = texelFetch(sourceBlue, cell, 0);
  imageStore(nextRed, cell, red);
  imageStore(nextGreen, cell, green);
  imageStore(nextBlue, cell, blue);
#if WITH_SUM
  imageStore(sumRed, cell, imageLoad(sumRed, cell) + red);
  imageStore(sumGreen, cell, imageLoad(sumGreen, cell) + green);
  imageStore(sumBlue, cell, imageLoad(sumBlue, cell) + blue);
#endif
}
