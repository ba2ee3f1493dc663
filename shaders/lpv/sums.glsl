// The sums of wavefronts, in 32 bits. FROM_BUFFER: from the buffers of the compute steps, else from the textures that
// the layered pass blends into. They cover all steps, or, with joined cascades, those before and those after the
// hand-over. Needs cascades/block.glsl.
#if FROM_BUFFER
layout(binding = 0) uniform samplerBuffer nearSums;  // cell by cell, all red, then green, then blue
layout(binding = 3) uniform samplerBuffer farSums;
#define SUM_AT(sums, cell, channel)                                                                         \
  texelFetch(sums, (((channel)*grids.shape.x * grids.shape.y + (cell).z) * grids.shape.x + (cell).y) * \
                           grids.shape.x + (cell).x)
#else
layout(binding = 0) uniform sampler3D nearSums[3];
layout(binding = 3) uniform sampler3D farSums[3];
#define SUM_AT(sums, cell, channel) texelFetch(sums[channel], cell, 0)
#endif
