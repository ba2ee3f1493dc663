// What a propagation step must at least do: read one set of grids and write the next, and add to the sum. As
// lpv/propagate.comp does it: texels of a buffer in 32 bits read, a storage block written, the fastest ways there are
// on llvmpipe. A yardstick of `lucerna bench tables`; no technique uses it.
layout(local_size_x = 64) in;
layout(binding = 0) uniform samplerBuffer source;
layout(std430, binding = 0) writeonly buffer Next { vec4 next[]; };
#if WITH_SUM
layout(binding = 1) uniform samplerBuffer sumBefore;
layout(std430, binding = 1) writeonly buffer Sums { vec4 sums[]; };
#endif
uniform int count;  // of texels of a channel

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
