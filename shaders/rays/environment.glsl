// Light from infinity in all directions: constant, or a latitude-longitude picture (lib/latitude_longitude.glsl)
// rotated about +y. The picture's texels are sampled in proportion to their power, row first, by alias tables
// [Vose1991]; uniformly over each texel's solid angle.
#if ENVIRONMENT_PICTURE
#include "lib/clamped_int.glsl"
#include "lib/latitude_longitude.glsl"
layout(binding = 1) uniform sampler2D environmentPicture;  // radiance without the factor
// per row: threshold of 2^32, alias (a column); bits of the density over solid angle, 1/sr
layout(binding = 2) uniform usampler2D environmentTable;
layout(binding = 4) uniform usampler2D environmentRows;    // threshold of 2^32, alias (a row)

// Texel coordinates of a direction, 0..size.
vec2 environmentTexel(vec3 direction, ivec2 size) {
  return latitudeLongitude(turnAboutY(direction, tracer.environmentTurn.xy * vec2(1.0, -1.0))) * vec2(size);
}

// Nearest texel, without filtering: sampling and evaluation agree.
vec3 environmentRadiance(vec3 direction) {
  ivec2 size = textureSize(environmentPicture, 0);
  ivec2 texel = clampedInt(environmentTexel(direction, size), ivec2(0), size - 1);
  return tracer.environment * texelFetch(environmentPicture, texel, 0).rgb;
}

// Density of environmentSample for a direction, 1/sr.
float environmentPdf(vec3 direction) {
  ivec2 size = textureSize(environmentPicture, 0);
  ivec2 texel = clampedInt(environmentTexel(direction, size), ivec2(0), size - 1);
  return uintBitsToFloat(texelFetch(environmentTable, texel, 0).z);
}

// words: select the texel; xi: the position in it. Returns radiance and density.
vec3 environmentSample(vec2 xi, uvec2 words, out vec3 radiance, out float pdf) {
  ivec2 size = textureSize(environmentPicture, 0);
  uvec4 choice = pcg4d(uvec4(words, 0u, 0u));
  ivec2 texel = ivec2(0, scaledWord(choice.x, uint(size.y)));
  uvec2 entry = texelFetch(environmentRows, texel, 0).xy;
  if (choice.y >= entry.x) texel.y = int(entry.y);
  texel.x = int(scaledWord(choice.z, uint(size.x)));
  entry = texelFetch(environmentTable, texel, 0).xy;
  if (choice.w >= entry.x) texel.x = int(entry.y);
  pdf = uintBitsToFloat(texelFetch(environmentTable, texel, 0).z);
  radiance = tracer.environment * texelFetch(environmentPicture, texel, 0).rgb;
  float azimuth = kTwoPi * ((float(texel.x) + xi.x) / float(size.x) - 0.5);
  float top = cos(0.5 * kTwoPi * float(texel.y) / float(size.y)),
        bottom = cos(0.5 * kTwoPi * float(texel.y + 1) / float(size.y));
  float y = mix(top, bottom, xi.y), r = sqrt(max(0.0, (1.0 - y) * (1.0 + y)));
  return turnAboutY(vec3(r * sin(azimuth), y, -r * cos(azimuth)), tracer.environmentTurn.xy);
}
#elif ENVIRONMENT
vec3 environmentRadiance(vec3 direction) { return tracer.environment; }
#endif
