// A unit vector on an octahedron unfolded to a square [Cigolle2014]: base/packed_normal.hpp.
vec3 unpackNormal(uint word) {
  vec2 square = unpackSnorm2x16(word);
  vec3 n = vec3(square, 1.0 - abs(square.x) - abs(square.y));
  float below = max(-n.z, 0.0);
  n.xy += mix(vec2(-below), vec2(below), lessThan(n.xy, vec2(0.0)));
  return normalize(n);
}
