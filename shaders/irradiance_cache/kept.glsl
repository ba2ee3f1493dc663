// What paths of records have hit, kept while a scene moves (shared/irradiance_cache.h, CacheHit). Needs
// lib/clamped_int.glsl.

// Three floats of one exponent: 9 bits each, from 2^-24 to 65408, as GL_RGB9_E5.
uint packColour(vec3 colour) {
  vec3 c = clamp(colour, vec3(0.0), vec3(65408.0));
  float largest = max(c.x, max(c.y, c.z));
  int exponent = clamp(int(floatBitsToUint(largest) >> 23u) - 127, -16, 15) + 16;  // bounded: bits, 9 of them
  float step = uintBitsToFloat(uint(exponent + 103) << 23u);
  if (floor(largest / step + 0.5) >= 512.0) ++exponent, step *= 2.0;
  uvec3 steps = uvec3(clampedInt(c / step + 0.5, ivec3(0), ivec3(511)));
  return uint(exponent) << 27u | steps.z << 18u | steps.y << 9u | steps.x;
}

vec3 unpackColour(uint word) {
  float step = uintBitsToFloat(((word >> 27u) + 103u) << 23u);
  return step * vec3(word & 511u, word >> 9u & 511u, word >> 18u & 511u);
}
