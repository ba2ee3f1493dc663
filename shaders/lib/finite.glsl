// Whether no component is NaN or infinite. Tests the exponent bits, because compilers may rewrite !(x >= 0) as x < 0
// (Mesa does), which lets NaN pass.
bool allFinite(vec3 v) { return all(notEqual(floatBitsToUint(v) & 0x7f800000u, uvec3(0x7f800000u))); }
