// Counts the texels of a volume that are not value + slope * index, x first.
layout(local_size_x = 64) in;
layout(binding = 0) uniform usampler3D texels;
layout(std430, binding = 1) buffer Wrong { uint wrong; };
uniform uint value, slope, count;

void main() {
  uint at = gl_GlobalInvocationID.x;
  if (at >= count) return;
  uvec3 size = uvec3(textureSize(texels, 0));
  ivec3 place = ivec3(at % size.x, at / size.x % size.y, at / (size.x * size.y));
  if (texelFetch(texels, place, 0).x != value + slope * at) atomicAdd(wrong, 1u);
}
