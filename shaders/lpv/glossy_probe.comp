// Glossy reflection of the light propagation volume at given points, for tests.
#include "lpv/glossy.glsl"
layout(local_size_x = 64) in;
struct Probe {
  vec4 position;
  vec4 normal;
  vec4 toCamera;
  vec4 specular;  // w: alpha
};
layout(std430, binding = 0) readonly buffer Probes { Probe probes[]; };
layout(std430, binding = 1) writeonly buffer Radiances { vec4 radiances[]; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= uint(probes.length())) return;
  Probe p = probes[i];
  Coat coat = Coat(p.specular.rgb, p.specular.w);
  radiances[i] = vec4(lpvGlossy(p.position.xyz, p.normal.xyz, p.toCamera.xyz, coat), 0.0);
}
