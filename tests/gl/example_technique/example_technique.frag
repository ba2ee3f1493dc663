// L = L_surface exp(-sigma d) [Chandrasekhar1960]; d is the distance from the camera, which stands at the origin.
layout(binding = 0) uniform sampler2D radianceTexture;
layout(binding = 1) uniform sampler2D depthTexture;
uniform mat4 viewFromClip;
uniform vec3 coefficient;  // 1 / scene unit
layout(location = 0) out vec4 radiance;

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec2 uv = gl_FragCoord.xy / vec2(textureSize(depthTexture, 0));
  vec4 surface = viewFromClip * vec4(2.0 * vec3(uv, texelFetch(depthTexture, pixel, 0).r) - 1.0, 1.0);
  vec3 seen = texelFetch(radianceTexture, pixel, 0).rgb;
  radiance = vec4(seen * exp(-coefficient * length(surface.xyz / surface.w)), 1.0);
}
