// The denoiser's inputs: the film of two independent halves, one above the other, and what pixels show (features.comp).
// engine/pathtracer/denoiser.hpp explains the method.
layout(binding = 0) uniform usampler2D filmMean;  // bits of three floats, and the number of samples
uniform ivec2 picture;  // size

const int kHalves = 2;

ivec2 inHalf(ivec2 pixel, int which) { return ivec2(pixel.x, pixel.y + which * picture.y); }
bool isInPicture(ivec2 pixel) {
  return all(greaterThanEqual(pixel, ivec2(0))) && all(lessThan(pixel, picture));
}

struct Half {
  vec3 mean;
  float samples;
};

Half halfAt(ivec2 pixel, int which) {
  uvec4 words = texelFetch(filmMean, inHalf(pixel, which), 0);
  return Half(uintBitsToFloat(words.xyz), float(words.w));
}
// The second half never has more samples.
bool hasBoth(ivec2 pixel) { return texelFetch(filmMean, inHalf(pixel, 1), 0).w > 0u; }

// Share of the first half in the mean of both.
float shareOf(float first, float second) { return first / max(first + second, 1.0); }

vec3 rawAt(ivec2 pixel) {
  Half a = halfAt(pixel, 0), b = halfAt(pixel, 1);
  return mix(b.mean, a.mean, shareOf(a.samples, b.samples));
}
