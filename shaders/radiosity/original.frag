// A triangle's radiosity as a number, encoded as a colour: its three bytes as red, green and blue [RAD2008 section
// 3.7.2], or unencoded (BITS_24 0).
#include "lib/clamped_int.glsl"
flat in float number;
layout(location = 0) out vec4 color;

void main() {
#if BITS_24
  uint n = uint(clampedInt(number, 0, 0xffffff));
  color = vec4((n >> 16u) & 255u, (n >> 8u) & 255u, n & 255u, 255u) / 255.0;
#else
  color = vec4(number);
#endif
}
