// Real spherical harmonics of bands 0 and 1 as a vec4 (c0, c1x, c1y, c1z).
// The published packing (Y00, -Y1 y, Y1 z, -Y1 x) [LPV2015, 5.1] differs only in order and sign. These differences
// cancel, since evaluation and projection use the same packing.
// evaluation and projection share it.
const float kPi = 3.14159265358979;
const float kY00 = 0.28209479177387814;  // 1 / (2 sqrt(pi))
const float kY1 = 0.48860251190291992;   // sqrt(3) / (2 sqrt(pi))
const float kLobe0 = 0.88622692545275801;  // sqrt(pi) / 2
const float kLobe1 = 1.02332670794648848;  // sqrt(pi / 3)

vec4 shBasis(vec3 direction) { return vec4(kY00, kY1 * direction); }

// Clamped cosine about a unit normal: 0.25 + 0.5 cos(angle), integral pi [Ramamoorthi2001].
vec4 shCosineLobe(vec3 normal) { return vec4(kLobe0, kLobe1 * normal); }
