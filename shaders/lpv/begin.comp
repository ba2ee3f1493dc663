// Copies the light to propagate, as coefficients, from the textures filled by blending into a buffer of the propagation
// steps: the first wavefront.
#include "cascades/block.glsl"
layout(local_size_x = GROUP_X, local_size_y = GROUP_Y, local_size_z = 1) in;
layout(binding = 0) uniform sampler3D injectedRed;
layout(binding = 1) uniform sampler3D injectedGreen;
layout(binding = 2) uniform sampler3D injectedBlue;
layout(std430, binding = 0) writeonly buffer Wavefront { vec4 wavefront[]; };

void main() {
  ivec3 cell = ivec3(gl_GlobalInvocationID);
  int cells = grids.shape.x, layers = cells * grids.shape.y;
  if (any(greaterThanEqual(cell, ivec3(cells, cells, layers)))) return;
  int at = (cell.z * cells + cell.y) * cells + cell.x, channel = cells * cells * layers;
  wavefront[at] = texelFetch(injectedRed, cell, 0);
  wavefront[at + channel] = texelFetch(injectedGreen, cell, 0);
  wavefront[at + 2 * channel] = texelFetch(injectedBlue, cell, 0);
}
