// The injected grid as the first front and the start of the sum: from the textures that blending fills into the buffers of the steps.
#include "lpv/common.glsl"
#include "lpv/stored_units.glsl"
layout(local_size_x = GROUP_X, local_size_y = GROUP_Y, local_size_z = 1) in;
layout(binding = 0) uniform sampler3D injectedRed;
layout(binding = 1) uniform sampler3D injectedGreen;
layout(binding = 2) uniform sampler3D injectedBlue;
layout(std430, binding = 0) writeonly buffer Front { vec4 front[]; };
layout(std430, binding = 2) writeonly buffer Sums { vec4 sums[]; };

void main() {
  ivec3 cell = ivec3(gl_GlobalInvocationID);
  int cells = lpv.shape.x, layers = cells * lpv.shape.y;
  if (any(greaterThanEqual(cell, ivec3(cells, cells, layers)))) return;
  int at = (cell.z * cells + cell.y) * cells + cell.x, channel = cells * cells * layers;
  vec4 injected[3] = vec4[3](texelFetch(injectedRed, cell, 0), texelFetch(injectedGreen, cell, 0), texelFetch(injectedBlue, cell, 0));
  for (int i = 0; i < 3; ++i) {
    front[at + i * channel] = kStoredUnits * injected[i];
    sums[at + i * channel] = WITH_INJECTED == 1 ? injected[i] : vec4(0.0);
  }
}
