// For tests: clampedInt of numbers, with the bounds that come with them.
layout(local_size_x = 64) in;
#include "lib/clamped_int.glsl"
struct Probe {
  vec4 value;
  ivec4 low, high;
};
layout(std430, binding = 0) readonly restrict buffer Probes { Probe probes[]; };
layout(std430, binding = 1) writeonly restrict buffer Answers { ivec4 answers[]; };  // of four, three, two and one

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= uint(probes.length())) return;
  Probe p = probes[i];
  answers[4u * i] = clampedInt(p.value, p.low, p.high);
  answers[4u * i + 1u] = ivec4(clampedInt(p.value.xyz, p.low.xyz, p.high.xyz), 0);
  answers[4u * i + 2u] = ivec4(clampedInt(p.value.xy, p.low.xy, p.high.xy), 0, 0);
  answers[4u * i + 3u] = ivec4(clampedInt(p.value.x, p.low.x, p.high.x), 0, 0, 0);
}
