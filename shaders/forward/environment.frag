// The environment behind all surfaces: constant, or a latitude-longitude picture (lib/latitude_longitude.glsl),
// filtered bilinearly.
uniform vec3 environmentRadiance;  // or a factor that scales the picture
layout(location = 0) out vec4 radiance;

#if ENVIRONMENT_PICTURE
#include "lib/clamped_int.glsl"
#include "lib/latitude_longitude.glsl"
layout(binding = 0) uniform sampler2D environmentTexture;
uniform vec2 environmentTurn;  // cosine and sine of its rotation
in vec3 vDirection;

// Filtered by hand: the picture wraps around from left to right, but not from top to bottom.
vec3 pictureRadiance(vec3 direction) {
  ivec2 size = textureSize(environmentTexture, 0);
  vec2 uv = latitudeLongitude(turnAboutY(direction, environmentTurn * vec2(1.0, -1.0)));
  float x = uv.x * float(size.x) - 0.5, left = floor(x);
  int first = (clampedInt(left, -1, size.x - 1) + size.x) % size.x, second = (first + 1) % size.x;
  float y = clamp(uv.y * float(size.y) - 0.5, 0.0, float(size.y - 1));
  int top = clampedInt(y, 0, size.y - 1), bottom = min(top + 1, size.y - 1);
  vec3 upper = mix(texelFetch(environmentTexture, ivec2(first, top), 0).rgb,
                   texelFetch(environmentTexture, ivec2(second, top), 0).rgb, x - left);
  vec3 lower = mix(texelFetch(environmentTexture, ivec2(first, bottom), 0).rgb,
                   texelFetch(environmentTexture, ivec2(second, bottom), 0).rgb, x - left);
  return mix(upper, lower, y - float(top));
}
#endif

void main() {
  vec3 result = environmentRadiance;
#if ENVIRONMENT_PICTURE
  result *= pictureRadiance(vDirection);
#endif
  radiance = vec4(result, 1.0);
}
