// Turns atomic counters into coefficients. FILL_FIXED: converts integers to floats in place, for lights or surfels.
// FILL_HALF: copies images into the first wavefront. FILL_FLOAT needs no such pass.
#include "cascades/block.glsl"
#include "lpv/fixed.glsl"
layout(local_size_x = GROUP_X, local_size_y = GROUP_Y, local_size_z = 1) in;
uniform float fixedScale;
#if FILL_FIXED
layout(std430, binding = 0) buffer Counts { uvec4 counts[]; };
uniform ivec3 size;    // of a stack of cascades
uniform int channels;  // number of stacks, one after the other
#else
layout(std430, binding = 0) writeonly buffer Wavefront { vec4 wavefront[]; };
layout(binding = 0) uniform sampler3D countRed;
layout(binding = 1) uniform sampler3D countGreen;
layout(binding = 2) uniform sampler3D countBlue;
#endif

void main() {
  ivec3 cell = ivec3(gl_GlobalInvocationID);
#if FILL_FIXED
  if (any(greaterThanEqual(cell, size))) return;
  float inverse = 1.0 / stepsOfCascade(cell.z * grids.shape.y / size.z, fixedScale);
  int at = (cell.z * size.y + cell.y) * size.x + cell.x;
  for (int i = 0; i < channels; ++i) {
    int word = at + i * size.x * size.y * size.z;
    counts[word] = floatBitsToUint(vec4(ivec4(counts[word])) * inverse);
  }
#else
  int cells = grids.shape.x, layers = cells * grids.shape.y;
  if (any(greaterThanEqual(cell, ivec3(cells, cells, layers)))) return;
  int at = (cell.z * cells + cell.y) * cells + cell.x, channel = cells * cells * layers;
  wavefront[at] = texelFetch(countRed, cell, 0);
  wavefront[at + channel] = texelFetch(countGreen, cell, 0);
  wavefront[at + 2 * channel] = texelFetch(countBlue, cell, 0);
#endif
}
