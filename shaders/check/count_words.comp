// Counts the words of a storage block that are not value + slope * index.
layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Words { uint words[]; };
layout(std430, binding = 1) buffer Wrong { uint wrong; };
uniform uint value, slope, count;

void main() {
  uint at = gl_GlobalInvocationID.x;
  if (at < count && words[at] != value + slope * at) atomicAdd(wrong, 1u);
}
