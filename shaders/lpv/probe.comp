// Irradiance from the light propagation volume at given points and normals, for measurements and tests.
#include "lpv/lookup.glsl"
layout(local_size_x = 64) in;
struct Probe {
  vec4 position;
  vec4 normal;
};
layout(std430, binding = 0) readonly buffer Probes { Probe probes[]; };
layout(std430, binding = 1) writeonly buffer Irradiances { vec4 irradiances[]; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= uint(probes.length())) return;
  irradiances[i] = vec4(lpvIrradiance(probes[i].position.xyz, probes[i].normal.xyz), 0.0);
}
