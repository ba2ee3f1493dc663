// Decides how much of each candidate a pixel takes: the shares, none negative and together at most 1, that minimise the
// squared error estimated over the window around it. Then the picture, and estimates of the pixel's squared error.
layout(local_size_x = 8, local_size_y = 8) in;
#include "pathtracer/denoise.glsl"
#include "pathtracer/denoise_candidates.glsl"
#include "pathtracer/denoise_window.glsl"
layout(binding = 8) uniform sampler2D rows0;
layout(binding = 9) uniform sampler2D rows1;
layout(binding = 10) uniform sampler2D rows2;
layout(binding = 11) uniform sampler2D rows3;
layout(binding = 12) uniform sampler2D terms0;
layout(binding = 13) uniform sampler2D terms1;
layout(binding = 14) uniform sampler2D terms2;
layout(binding = 15) uniform sampler2D terms3;
layout(rgba32f, binding = 0) writeonly restrict uniform image2D result;
// Estimates, summed over channels: of the pixel's squared error; the same with the shares that the window without the
// pixel would choose; of the raw picture's. w: 1 where there are two halves.
layout(rgba32f, binding = 1) writeonly restrict uniform image2D errors;
uniform ivec2 firstPixel;

const int kRounds = 32;

// Sums over a window, as denoise_terms.comp writes them.
struct Sums {
  vec4 t0, t1, t2, t3;
};

void addTo(inout Sums sums, float weight, Sums more) {
  sums.t0 += weight * more.t0;
  sums.t1 += weight * more.t1;
  sums.t2 += weight * more.t2;
  sums.t3 += weight * more.t3;
}

Sums rowsAt(ivec2 at) {
  return Sums(texelFetch(rows0, at, 0), texelFetch(rows1, at, 0), texelFetch(rows2, at, 0), texelFetch(rows3, at, 0));
}
Sums termsAt(ivec2 at) {
  return Sums(texelFetch(terms0, at, 0), texelFetch(terms1, at, 0), texelFetch(terms2, at, 0),
              texelFetch(terms3, at, 0));
}

// Moves to candidate i from the raw picture, whose share is `rest`, or from candidate j what minimises 2 c.l + l.G l.
void moveFromRaw(int i, vec4 c, mat4 g, inout vec4 l, inout float rest) {
  if (!(g[i][i] > 0.0)) return;
  float gradient = c[i] + dot(g[i], l), moved = clamp(-gradient / g[i][i], -l[i], rest);
  l[i] += moved;
  rest = max(rest - moved, 0.0);
}
void moveFrom(int j, int i, vec4 c, mat4 g, inout vec4 l) {
  float curvature = g[i][i] + g[j][j] - 2.0 * g[i][j];
  if (!(curvature > 1e-6 * (g[i][i] + g[j][j]))) return;
  float gradient = c[i] - c[j] + dot(g[i] - g[j], l), moved = clamp(-gradient / curvature, -l[i], l[j]);
  l[i] += moved;
  l[j] -= moved;
}

// The shares l that minimise 2 c.l + l.G l where l >= 0 and their sum is at most 1; the rest is the raw picture's.
// Shares are moved between two of these five at a time, by the exact minimum; as the function is convex, this ends at
// the minimum. Written out, as llvmpipe takes twice as long where components are found by a loop's variable.
vec4 sharesOf(Sums sums) {
  vec4 c = sums.t0, l = vec4(0.0);
  mat4 g = mat4(sums.t1, vec4(sums.t1.y, sums.t2.xyz), vec4(sums.t1.z, sums.t2.y, sums.t2.w, sums.t3.x),
                vec4(sums.t1.w, sums.t2.z, sums.t3.xy));
  float rest = 1.0;
  for (int round = 0; round < kRounds; ++round) {
    moveFromRaw(0, c, g, l, rest), moveFrom(1, 0, c, g, l), moveFrom(2, 0, c, g, l), moveFrom(3, 0, c, g, l);
    moveFromRaw(1, c, g, l, rest), moveFrom(2, 1, c, g, l), moveFrom(3, 1, c, g, l);
    moveFromRaw(2, c, g, l, rest), moveFrom(3, 2, c, g, l);
    moveFromRaw(3, c, g, l, rest);
  }
  return l;
}

float errorOf(Terms t, vec4 shares) { return t.variance + 2.0 * dot(shares, t.c) + dot(shares, t.g * shares); }

void main() {
  ivec2 pixel = firstPixel + ivec2(gl_GlobalInvocationID.xy);
  if (!isInPicture(pixel)) return;
  if (!hasBoth(pixel)) {  // a single sample says nothing about its error
    imageStore(result, pixel, vec4(halfAt(pixel, 0).mean, 1.0));
    imageStore(errors, pixel, vec4(0.0));
    return;
  }
  // The window's sums, but for this pixel.
  Sums sums = Sums(vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0));
  // ends: at most 2 kWindow + 1 steps each
  for (int y = max(pixel.y - kWindow, 0); y <= min(pixel.y + kWindow, picture.y - 1); ++y)
    if (y != pixel.y) addTo(sums, windowAt(y - pixel.y), rowsAt(ivec2(pixel.x, y)));
  // ends: likewise
  for (int x = max(pixel.x - kWindow, 0); x <= min(pixel.x + kWindow, picture.x - 1); ++x)
    if (x != pixel.x) addTo(sums, windowAt(x - pixel.x), termsAt(ivec2(x, pixel.y)));
  vec4 sharesOfOthers = sharesOf(sums);
  addTo(sums, 1.0, termsAt(pixel));
  vec4 shares = sharesOf(sums);

  Candidates candidates = candidatesAt(pixel);
  vec3 radiance = candidates.raw;
  for (int i = 0; i < kCandidates; ++i) radiance += shares[i] * candidates.change[i];
  imageStore(result, pixel, vec4(radiance, 1.0));
  Terms own = termsOf(candidates, vec3(1.0));
  imageStore(errors, pixel, vec4(errorOf(own, shares), errorOf(own, sharesOfOthers), own.variance, 1.0));
}
