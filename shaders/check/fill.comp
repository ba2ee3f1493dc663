// Writes value + index to each word. `groups`: also written, for an indirect dispatch.
layout(local_size_x = 64) in;
layout(std430, binding = 0) writeonly buffer Words { uint words[]; };
layout(std430, binding = 1) writeonly buffer Groups { uint groups[3]; };
uniform uint value, count;
uniform uint groupCount;

void main() {
  uint at = gl_GlobalInvocationID.x;
  if (at < count) words[at] = value + at;
  if (at < 3u) groups[at] = at == 0u ? groupCount : 1u;
}
