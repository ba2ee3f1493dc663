// The sums of the layered pass as the lookup takes them; only where no join does so.
#include "lpv/common.glsl"
#include "lpv/storage.glsl"
layout(local_size_x = GROUP_X, local_size_y = GROUP_Y, local_size_z = 1) in;
layout(binding = 0) uniform sampler3D sumRed;
layout(binding = 1) uniform sampler3D sumGreen;
layout(binding = 2) uniform sampler3D sumBlue;
layout(binding = 0, LPV_FORMAT) writeonly uniform image3D resultRed;
layout(binding = 1, LPV_FORMAT) writeonly uniform image3D resultGreen;
layout(binding = 2, LPV_FORMAT) writeonly uniform image3D resultBlue;

void main() {
  ivec3 cell = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(cell, textureSize(sumRed, 0)))) return;
  imageStore(resultRed, cell, toTexel(texelFetch(sumRed, cell, 0)));
  imageStore(resultGreen, cell, toTexel(texelFetch(sumGreen, cell, 0)));
  imageStore(resultBlue, cell, toTexel(texelFetch(sumBlue, cell, 0)));
}
