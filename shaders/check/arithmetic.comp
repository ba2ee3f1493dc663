// What OpenGL leaves open: values that drivers compute differently.
#include "lib/angle.glsl"
layout(local_size_x = 1) in;
layout(std430, binding = 0) writeonly buffer Values { int values[]; };
uniform float zero, one, big;  // 0, 1, 1e20: not known to the compiler

void main() {
  float nan = zero / zero;
  values[0] = int(big);  // bounded: not, which is what the probe asks; so are the next three
  values[1] = int(-big);  // bounded: not
  values[2] = int(nan);  // bounded: not
  values[3] = int(uint(big));  // bounded: not
  values[4] = floatBitsToInt(min(nan, one));
  values[5] = floatBitsToInt(max(one, nan));
  values[6] = isnan(nan) ? 1 : 0;
  values[7] = isinf(one / zero) ? 1 : 0;
  float worstAtan = 0.0, worstAngle = 0.0;
  for (int i = 0; i < 1000; ++i) {
    // Against the angle itself, from its sine and cosine, which are more exact than an arctangent.
    float angle = 3.14159265 * (float(i) + 0.5) / 1000.0 * one, s = sin(angle), c = cos(angle);
    worstAtan = max(worstAtan, abs(atan(s, c) - angle));
    worstAngle = max(worstAngle, abs(angleOf(s, c) - angle));
  }
  values[8] = floatBitsToInt(worstAtan);
  values[9] = floatBitsToInt(worstAngle);
}
