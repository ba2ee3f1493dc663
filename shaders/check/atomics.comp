// Each invocation counts itself: in one word, in a word of its residue, and in a texel of an image.
layout(local_size_x = 64) in;
layout(std430, binding = 0) buffer Words { uint words[]; };  // the total, the largest index, then residues
layout(r32ui, binding = 0) uniform uimage3D image;
uniform uint count, residues;

void main() {
  uint at = gl_GlobalInvocationID.x;
  if (at >= count) return;
  atomicAdd(words[0], 1u);
  atomicMax(words[1], at);
  uint residue = at % residues;
  atomicAdd(words[2u + residue], 1u);
  uint width = uint(imageSize(image).x);
  imageAtomicAdd(image, ivec3(residue % width, residue / width, 0), 1u);
}
