// The same from the texels of a row into the image of another.
layout(local_size_x = 64) in;
layout(binding = 0) uniform usampler3D before;
layout(r32ui, binding = 0) writeonly uniform uimage3D after;

void main() {
  ivec3 at = ivec3(gl_GlobalInvocationID), size = imageSize(after);
  if (any(greaterThanEqual(at, size))) return;
  ivec3 next = ivec3((at.x + 1) % size.x, at.yz);
  imageStore(after, at, uvec4(texelFetch(before, next, 0).x + 1u));
}
