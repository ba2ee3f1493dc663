// The sum of the raw picture over its channels: of blocks of pixels; with ALL, of all blocks into one texel.
layout(local_size_x = 8, local_size_y = 8) in;
#include "pathtracer/denoise.glsl"
#if ALL
layout(binding = 2) uniform sampler2D blocks;
#endif
layout(rgba32f, binding = 0) writeonly restrict uniform image2D sums;

shared float sumOfLane[64];

void main() {
  int lane = int(gl_LocalInvocationIndex);
  float sum = 0.0;
#if ALL
  ivec2 size = textureSize(blocks, 0);
  for (int i = lane; i < size.x * size.y; i += 64) sum += texelFetch(blocks, ivec2(i % size.x, i / size.x), 0).x;
#else
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (isInPicture(pixel)) {
    vec3 raw = rawAt(pixel);
    sum = raw.x + raw.y + raw.z;
  }
#endif
  sumOfLane[lane] = sum;
  // ends: halved six times
  for (int step = 32; step > 0; step /= 2) {
    barrier();
    if (lane < step) sumOfLane[lane] += sumOfLane[lane + step];
  }
  if (lane == 0) imageStore(sums, ivec2(gl_WorkGroupID.xy), vec4(sumOfLane[0], 0.0, 0.0, 0.0));
}
