// The sums of fronts, in 32 bits: from the buffers of the compute steps, or from the textures that the layered pass
// blends into. All steps, or, where cascades are joined, those before and those after the hand-over. FROM_BUFFER
// chooses. Needs lpv/common.glsl.
#if FROM_BUFFER
layout(binding = 0) uniform samplerBuffer nearSums;  // cell by cell, all of red before green before blue
layout(binding = 3) uniform samplerBuffer farSums;
#define SUM_AT(sums, cell, channel) \
  texelFetch(sums, (((channel)*lpv.shape.x * lpv.shape.y + (cell).z) * lpv.shape.x + (cell).y) * lpv.shape.x + (cell).x)
#else
layout(binding = 0) uniform sampler3D nearSums[3];
layout(binding = 3) uniform sampler3D farSums[3];
#define SUM_AT(sums, cell, channel) texelFetch(sums[channel], cell, 0)
#endif
