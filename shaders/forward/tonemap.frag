// Radiance to display: exposure, then the curve and encoding of lib/tonemap.glsl.
#include "lib/frame.glsl"
#include "lib/tonemap.glsl"
in vec2 uv;
layout(binding = 0) uniform sampler2D radianceTexture;
layout(location = 0) out vec4 displayColor;

void main() {
  vec3 radiance = texelFetch(radianceTexture, ivec2(gl_FragCoord.xy), 0).rgb;
  displayColor = vec4(srgbFromLinear(filmic(frame.exposure * radiance)), 1.0);
}
