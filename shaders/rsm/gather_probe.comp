// Gathered irradiance at given points and normals, for measurements and tests.
#include "rsm/gather.glsl"
layout(local_size_x = 64) in;
struct Probe {
  vec4 position;  // w: the pattern's rotation, radians
  vec4 normal;
};
layout(std430, binding = 1) readonly buffer Probes { Probe probes[]; };
layout(std430, binding = 2) writeonly buffer Irradiances { vec4 irradiances[]; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= uint(probes.length())) return;
  irradiances[i] = vec4(gatherIrradiance(probes[i].position.xyz, probes[i].normal.xyz, probes[i].position.w), 0.0);
}
