// Display mappings of radiosity besides the engine's tone mapping. MAPPING 1: linear, scaled by the exposure and
// clamped at 1. 2: logarithmic, as in the original [RAD2008 section 3.6]: a range of decades below 1 / exposure. 3:
// false colours over the same decades, by luminance.
#include "lib/frame.glsl"
#include "lib/tonemap.glsl"
layout(binding = 0) uniform sampler2D hdr;
uniform float decades;
out vec4 color;

// Position of v in the decades below 1: 0..1.
vec3 logarithmic(vec3 v) { return clamp(1.0 + log2(max(v, vec3(1e-30))) / (decades * 3.321928), 0.0, 1.0); }

void main() {
  vec3 value = max(texelFetch(hdr, ivec2(gl_FragCoord.xy), 0).rgb * frame.exposure, vec3(0.0));
#if MAPPING == 1
  color = vec4(srgbFromLinear(min(value, vec3(1.0))), 1.0);
#elif MAPPING == 2
  color = vec4(logarithmic(value), 1.0);
#else
  // Black, blue, cyan, green, yellow, red, white: each step a sixth of the range.
  float t = 6.0 * logarithmic(vec3(dot(value, vec3(0.2126, 0.7152, 0.0722)))).x;
  float red = t < 5.0 ? t - 3.0 : 1.0;
  float green = t < 4.0 ? t - 1.0 : t < 5.0 ? 5.0 - t : t - 5.0;
  float blue = t < 2.0 ? t : t < 3.0 ? 3.0 - t : t - 5.0;
  color = vec4(clamp(vec3(red, green, blue), 0.0, 1.0), 1.0);
#endif
}
