// Writes each pixel's terms (denoise_candidates.glsl) of the relative squared error, measure::ImageErrors::relmse: c in
// the first image, the upper triangle of G in the others. What they are relative to is not known. The median of the raw
// picture and the candidates stands for it, which neither a bright speck nor what candidates make of one can move.
layout(local_size_x = 8, local_size_y = 8) in;
#include "pathtracer/denoise.glsl"
#include "pathtracer/denoise_candidates.glsl"
layout(binding = 8) uniform sampler2D pictureSum;  // one texel; x: sum of pixels and channels
layout(rgba32f, binding = 0) writeonly restrict uniform image2D terms0;
layout(rgba32f, binding = 1) writeonly restrict uniform image2D terms1;
layout(rgba32f, binding = 2) writeonly restrict uniform image2D terms2;
layout(rgba32f, binding = 3) writeonly restrict uniform image2D terms3;
uniform ivec2 firstPixel;

const float kRelativeEpsilon = 0.01;  // measure::kRelativeEpsilon

// Of five, by channel: the third is the median of the fifth, of the larger of the two least of two pairs, and of the
// smaller of their greatest.
vec3 medianOf(vec3 a, vec3 b, vec3 c, vec3 d, vec3 e) {
  vec3 low = max(min(a, b), min(c, d)), high = min(max(a, b), max(c, d));
  return max(min(low, high), min(max(low, high), e));
}

void main() {
  ivec2 pixel = firstPixel + ivec2(gl_GlobalInvocationID.xy);
  if (!isInPicture(pixel)) return;
  Candidates candidates = candidatesAt(pixel);
  vec3 raw = candidates.raw,
       about = medianOf(raw, raw + candidates.change[0], raw + candidates.change[1], raw + candidates.change[2],
                        raw + candidates.change[3]);
  float mean = texelFetch(pictureSum, ivec2(0), 0).x / (3.0 * float(picture.x) * float(picture.y));
  Terms t = termsOf(candidates, 1.0 / (about * about + kRelativeEpsilon * mean * mean + 1e-30));
  imageStore(terms0, pixel, t.c);
  imageStore(terms1, pixel, t.g[0]);
  imageStore(terms2, pixel, vec4(t.g[1].yzw, t.g[2].z));
  imageStore(terms3, pixel, vec4(t.g[2].w, t.g[3].w, 0.0, 0.0));
}
