// Log luminance of the picture, for automatic exposure: each texel of the small target samples 16 texels of its region.
#include "lib/clamped_int.glsl"
layout(binding = 0) uniform sampler2D radianceTexture;
uniform vec2 pixels;  // of the target
layout(location = 0) out vec4 result;  // sum of log2, count

void main() {
  ivec2 size = textureSize(radianceTexture, 0);
  vec2 part = vec2(size) / pixels, corner = floor(gl_FragCoord.xy) / pixels * vec2(size);
  vec2 sum = vec2(0.0);
  for (int i = 0; i < 16; ++i) {
    ivec2 texel = clampedInt(corner + part * (vec2(i & 3, i >> 2) + 0.5) / 4.0, ivec2(0), size - 1);
    float luminance = dot(texelFetch(radianceTexture, texel, 0).rgb, vec3(0.2126, 0.7152, 0.0722));  // IEC 61966-2-1
    if (luminance > 1e-12 && !isinf(luminance)) sum += vec2(log2(luminance), 1.0);
  }
  result = vec4(sum, 0.0, 1.0);
}
