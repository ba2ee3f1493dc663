// How bright every cascade but the coarsest is, at half its resolution: what the next coarser grid can tell of it. Band 0 of the
// whole sum, red, green and blue together, mean of 2x2x2 cells. Stored as c / (E_ref s^2), means are comparable between cascades.
#include "lpv/common.glsl"
layout(local_size_x = GROUP_X, local_size_y = GROUP_Y, local_size_z = 1) in;
layout(binding = 0) uniform sampler3D nearRed;
layout(binding = 1) uniform sampler3D nearGreen;
layout(binding = 2) uniform sampler3D nearBlue;
layout(binding = 3) uniform sampler3D farRed;
layout(binding = 4) uniform sampler3D farGreen;
layout(binding = 5) uniform sampler3D farBlue;
layout(binding = 0, r32f) writeonly uniform image3D brightness;

float band0(ivec3 cell) {
  return texelFetch(nearRed, cell, 0).x + texelFetch(nearGreen, cell, 0).x + texelFetch(nearBlue, cell, 0).x +
         texelFetch(farRed, cell, 0).x + texelFetch(farGreen, cell, 0).x + texelFetch(farBlue, cell, 0).x;
}

void main() {
  ivec3 at = ivec3(gl_GlobalInvocationID);
  int pairs = (lpv.shape.x + 1) / 2;
  if (any(greaterThanEqual(at, ivec3(pairs, pairs, pairs * (lpv.shape.y - 1))))) return;
  ivec3 first = ivec3(2 * at.xy, at.z / pairs * lpv.shape.x + 2 * (at.z % pairs));
  float sum = 0.0;
  for (int i = 0; i < 8; ++i) {
    ivec3 cell = first + ivec3(i & 1, i >> 1 & 1, i >> 2);
    // With an odd number of cells the last pair reaches beyond the cascade.
    if (cell.x < lpv.shape.x && cell.y < lpv.shape.x && cell.z / lpv.shape.x == first.z / lpv.shape.x) sum += band0(cell);
  }
  imageStore(brightness, at, vec4(0.125 * sum));
}
