// A step from one buffer to another: each word is its neighbour's word before, plus 1.
layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Before { uint before[]; };
layout(std430, binding = 1) writeonly buffer After { uint after[]; };
uniform uint count;

void main() {
  uint at = gl_GlobalInvocationID.x;
  if (at < count) after[at] = before[(at + 1u) % count] + 1u;
}
