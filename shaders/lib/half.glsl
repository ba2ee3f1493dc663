// Rounding to 16-bit floats before they are stored. OpenGL leaves open how imageStore and packHalf2x16 round; a driver
// that cuts off (llvmpipe) loses half a unit in the last place a store, always downwards. What is rounded here is
// stored as it is by every driver.

// To the nearest half, ties to even; below 2^-14, where halves are 2^-24 apart, to that raster.
vec4 roundToHalf(vec4 value) {
  uvec4 bits = floatBitsToUint(value);
  vec4 normal = uintBitsToFloat((bits + 0xFFFu + ((bits >> 13) & 1u)) & ~0x1FFFu);
  return mix(normal, roundEven(value * 16777216.0) / 16777216.0, lessThan(abs(value), vec4(6.103515625e-5)));
}
