// Brings what atomics counted into the injected grid, one texel a cell.
#include "lpv/common.glsl"
layout(local_size_x = GROUP_X, local_size_y = GROUP_Y, local_size_z = 1) in;
#if FILL_FIXED
layout(binding = 0) uniform isampler3D countRed;
layout(binding = 1) uniform isampler3D countGreen;
layout(binding = 2) uniform isampler3D countBlue;
#else
layout(binding = 0) uniform sampler3D countRed;
layout(binding = 1) uniform sampler3D countGreen;
layout(binding = 2) uniform sampler3D countBlue;
#endif
layout(binding = 0, rgba32f) writeonly uniform image3D injectedRed;
layout(binding = 1, rgba32f) writeonly uniform image3D injectedGreen;
layout(binding = 2, rgba32f) writeonly uniform image3D injectedBlue;
uniform float fixedScale;

#if FILL_HALF
#define RESOLVED(count) texelFetch(count, cell, 0)
#else
#define RESOLVED(count)                                                                                               \
  vec4(texelFetch(count, first, 0).x, texelFetch(count, first + ivec3(1, 0, 0), 0).x,                                 \
       texelFetch(count, first + ivec3(2, 0, 0), 0).x, texelFetch(count, first + ivec3(3, 0, 0), 0).x) / fixedScale
#endif

void main() {
  ivec3 cell = ivec3(gl_GlobalInvocationID);
  int cells = lpv.shape.x;
  if (any(greaterThanEqual(cell, ivec3(cells, cells, cells * lpv.shape.y)))) return;
  ivec3 first = ivec3(4 * cell.x, cell.yz);
  imageStore(injectedRed, cell, RESOLVED(countRed));
  imageStore(injectedGreen, cell, RESOLVED(countGreen));
  imageStore(injectedBlue, cell, RESOLVED(countBlue));
}
