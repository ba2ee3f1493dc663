// The least work a propagation step must do: read one set of grids, write the next, and add to the sum. It does so as
// lpv/propagate.comp does, reading texels of a 32-bit buffer and writing a storage block, the fastest accesses on
// llvmpipe. A baseline for `lucerna bench tables`; no technique uses it.
layout(local_size_x = 64) in;
layout(binding = 0) uniform samplerBuffer source;
layout(std430, binding = 0) writeonly buffer Next { vec4 next[]; };
#if WITH_SUM
layout(binding = 1) uniform samplerBuffer sumBefore;
// aliased Sums: an invocation reads its own texels before it writes them
layout(std430, binding = 1) writeonly buffer Sums { vec4 sums[]; };
#endif
uniform int count;  // texels per channel

void main() {
  int at = int(gl_GlobalInvocationID.x);
  if (at >= count) return;
  for (int i = 0; i < 3; ++i) {
    vec4 light = texelFetch(source, at + i * count);
    next[at + i * count] = light;
#if WITH_SUM
    sums[at + i * count] = texelFetch(sumBefore, at + i * count) + light;
#endif
  }
}
