// A candidate of the denoiser: in each half of the film by itself, a pixel becomes what a linear function of position
// and features, fitted to the pixels around it by weighted least squares, has there [Moon2014; Bitterli2016].
//
// With the normal matrix M of the fit, z = M^-1 e_0, and x_q the regressors of pixel q, the fit's value is the sum of
// w_q (z . x_q) y_q: linear in the pixels y. FIT 0, narrow, and 1, wide: the weights w know only features, so that both
// halves share them. 2, coloured: weights also fall with the distance between values of the narrow fit in the same
// half, in units of its standard error [Rousselle2012]. 3, far: the same of the coloured fit, among pixels that are
// STRIDE apart.
layout(local_size_x = 8, local_size_y = 8) in;
#include "pathtracer/denoise.glsl"
layout(binding = 2) uniform sampler2D surfaceColours;
layout(binding = 3) uniform sampler2D surfacePlaces;
#if FIT >= 2
layout(binding = 4) uniform sampler2D guide;  // the narrow fit, or the coloured one
#endif
// Value; w: of the narrow and the coloured fit the sum of its variances over the channels, of the wide one the share
// with which despeckling takes the narrow value.
layout(rgba32f, binding = 0) writeonly restrict uniform image2D candidate;
uniform ivec2 firstPixel;

const int kRegressors = 11;  // 1, position (2), albedo (3), shining, normal (3), inverse distance
const float kRidge = 1e-3;   // of the sum of weights, on all slopes: regressors that do not vary get none
// Widths of the features' weights, and of the distance's in radii.
const float kOfPosition = 0.5, kOfAlbedo = 0.5, kOfShining = 0.3, kOfNormal = 0.4, kOfDistance = 0.15;
const float kOfColour = 0.7;         // of colours, in standard errors of their difference
const float kEqualColours = 0.02;    // relative difference that never counts

struct Regressors {
  vec3 position;  // 1, x, y
  vec4 colour, place;
};

float distance2(Regressors r) {
  return dot(r.position.yz, r.position.yz) / (2.0 * kOfPosition * kOfPosition) +
         dot(r.colour.xyz, r.colour.xyz) / (2.0 * kOfAlbedo * kOfAlbedo) +
         r.colour.w * r.colour.w / (2.0 * kOfShining * kOfShining) +
         dot(r.place.xyz, r.place.xyz) / (2.0 * kOfNormal * kOfNormal) +
         r.place.w * r.place.w / (2.0 * kOfDistance * kOfDistance);
}

// Of a pixel, relative to that at `offset` from it.
Regressors regressorsAt(ivec2 pixel, ivec2 offset, vec4 colour, vec4 place) {
  Regressors r;
  r.position = vec3(1.0, vec2(offset) / float(RADIUS * STRIDE));
  r.colour = texelFetch(surfaceColours, pixel + offset, 0) - colour;
  vec4 other = texelFetch(surfacePlaces, pixel + offset, 0);
  r.place = other - place;
  r.place.w /= other.w + place.w + 1e-30;
  return r;
}

float weightOf(Regressors r, ivec2 pixel, ivec2 offset, int which) {
  float far = distance2(r);
#if FIT >= 2
  vec4 own = texelFetch(guide, inHalf(pixel, which), 0), other = texelFetch(guide, inHalf(pixel + offset, which), 0);
  vec3 difference = other.xyz - own.xyz, equal = 0.5 * kEqualColours * (abs(own.xyz) + abs(other.xyz));
  float noise = kOfColour * kOfColour * (own.w + other.w);
  // Of single samples no variance is known: then colours say nothing.
  if (halfAt(pixel, 1).samples < 2.0) return exp(-far);
  far += max(0.0, (dot(difference, difference) - own.w - min(own.w, other.w)) / (dot(equal, equal) + noise + 1e-30));
#endif
  return exp(-far);
}

float regressor(Regressors r, int i) {
  return i < 3 ? r.position[i] : i < 7 ? r.colour[i - 3] : r.place[i - 7];
}

// z of the fit; lower triangle of M, row by row, replaced by its Cholesky factor. Its loops run over triangles.
void solve(inout float m[kRegressors * (kRegressors + 1) / 2], out float z[kRegressors]) {
  for (int i = 0; i < kRegressors; ++i) {
    int row = i * (i + 1) / 2;
    for (int j = 0; j < i; ++j) {  // ends: below i
      int other = j * (j + 1) / 2;
      float sum = m[row + j];
      for (int k = 0; k < j; ++k) sum -= m[row + k] * m[other + k];  // ends: below j
      m[row + j] = sum / m[other + j];
    }
    float diagonal = m[row + i];
    for (int k = 0; k < i; ++k) diagonal -= m[row + k] * m[row + k];  // ends: below i
    m[row + i] = sqrt(max(diagonal, 1e-12));
  }
  for (int i = 0; i < kRegressors; ++i) {
    float sum = i == 0 ? 1.0 : 0.0;
    for (int k = 0; k < i; ++k) sum -= m[i * (i + 1) / 2 + k] * z[k];  // ends: below i
    z[i] = sum / m[i * (i + 1) / 2 + i];
  }
  for (int i = kRegressors - 1; i >= 0; --i) {  // ends: at 0
    float sum = z[i];
    for (int k = i + 1; k < kRegressors; ++k) sum -= m[k * (k + 1) / 2 + i] * z[k];
    z[i] = sum / m[i * (i + 1) / 2 + i];
  }
}

void fit(ivec2 pixel, int which, vec4 colour, vec4 place, out float z[kRegressors]) {
  float m[kRegressors * (kRegressors + 1) / 2];
  for (int i = 0; i < kRegressors * (kRegressors + 1) / 2; ++i) m[i] = 0.0;
  for (int y = -RADIUS; y <= RADIUS; ++y)
    for (int x = -RADIUS; x <= RADIUS; ++x) {
      ivec2 offset = STRIDE * ivec2(x, y);
      if (!isInPicture(pixel + offset) || !hasBoth(pixel + offset)) continue;
      Regressors r = regressorsAt(pixel, offset, colour, place);
      float w = weightOf(r, pixel, offset, which);
      for (int i = 0; i < kRegressors; ++i) {
        float wi = w * regressor(r, i);
        for (int j = 0; j <= i; ++j) m[i * (i + 1) / 2 + j] += wi * regressor(r, j);  // ends: at i
      }
    }
  for (int i = 1; i < kRegressors; ++i) m[i * (i + 1) / 2 + i] += kRidge * m[0];
  solve(m, z);
}

void main() {
  ivec2 pixel = firstPixel + ivec2(gl_GlobalInvocationID.xy);
  if (!isInPicture(pixel)) return;
  if (!hasBoth(pixel)) {
    for (int which = 0; which < kHalves; ++which)
      imageStore(candidate, inHalf(pixel, which), vec4(halfAt(pixel, 0).mean, 0.0));
    return;
  }
  vec4 colour = texelFetch(surfaceColours, pixel, 0), place = texelFetch(surfacePlaces, pixel, 0);
  vec4 value[kHalves];
  float around[kHalves];  // sums of variances
  float z[kRegressors], neighbours = 0.0;
  for (int which = 0; which < kHalves; ++which) value[which] = vec4(0.0), around[which] = 0.0;
  for (int turn = 0; turn < (FIT >= 2 ? kHalves : 1); ++turn) {
    fit(pixel, turn, colour, place, z);
    for (int y = -RADIUS; y <= RADIUS; ++y)
      for (int x = -RADIUS; x <= RADIUS; ++x) {
        ivec2 offset = STRIDE * ivec2(x, y);
        if (!isInPicture(pixel + offset) || !hasBoth(pixel + offset)) continue;
        Regressors r = regressorsAt(pixel, offset, colour, place);
        float share = 0.0;
        for (int i = 0; i < kRegressors; ++i) share += z[i] * regressor(r, i);
        share *= weightOf(r, pixel, offset, turn);
#if FIT == 3
        value[turn].xyz += share * texelFetch(guide, inHalf(pixel + offset, turn), 0).xyz;
#elif FIT == 2
        float variance = varianceAt(pixel + offset, turn);
        value[turn] += vec4(share * halfAt(pixel + offset, turn).mean, share * share * variance);
#else
        if (offset != ivec2(0)) ++neighbours;
        for (int which = 0; which < kHalves; ++which) {
          value[which].xyz += share * halfAt(pixel + offset, which).mean;
          float variance = varianceAt(pixel + offset, which);
#if FIT == 0
          value[which].w += share * share * variance;
#endif
          if (offset != ivec2(0)) around[which] += variance;
        }
#endif
      }
  }
  for (int which = 0; which < kHalves; ++which) {
#if FIT == 1
    // Despeckling: the square of the pixel's own variance over that and the square of its neighbours'.
    float own = varianceAt(pixel, which), others = around[which] / max(neighbours, 1.0);
    value[which].w = halfAt(pixel, which).samples < 2.0 ? 1.0 : own * own / (own * own + others * others + 1e-30);
#endif
    imageStore(candidate, inHalf(pixel, which), value[which]);
  }
}
