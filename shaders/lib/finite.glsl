// Whether no component is NaN or infinite, by the bits of the exponent: comparisons do not tell, since compilers may
// take !(x >= 0) for x < 0 (Mesa does), which a NaN passes.
bool allFinite(vec3 v) { return all(notEqual(floatBitsToUint(v) & 0x7f800000u, uvec3(0x7f800000u))); }
