// A candidate of the denoiser: in each half of the film by itself, a pixel becomes what a linear function of position
// and features, fitted to the pixels around it by weighted least squares, has there [Moon2014; Bitterli2016].
//
// With x_q the regressors of pixel q, y_q its value, v_q the variance of that and w_q its weight, M the sum of
// w_q x_q x_q^T, and z = M^-1 e_0, the fit's value is the sum of w_q (z . x_q) y_q: linear in the pixels y. That is
// z . (sum of w_q x_q y_q), and its variance z . (sum of w_q^2 v_q x_q x_q^T) z, so one pass over the window makes all
// sums.
//
// FIT 0, narrow, and 1, wide: the weights w know only features, so that both halves share them. 2, coloured: weights
// also fall with the distance between values of the narrow fit in the same half, in units of its standard error
// [Rousselle2012]. 3, far: the same of the coloured fit, among pixels that are STRIDE apart.
layout(local_size_x = 8, local_size_y = 8) in;
#include "pathtracer/denoise.glsl"
// Images, not textures: llvmpipe reads them in half the time.
layout(rgba32f, binding = 1) readonly restrict uniform image2D surfaceColours;
layout(rgba32f, binding = 2) readonly restrict uniform image2D surfacePlaces;
layout(rgba32f, binding = 3) readonly restrict uniform image2D film;  // denoise_film.comp
#if FIT >= 2
layout(rgba32f, binding = 4) readonly restrict uniform image2D guide;  // the narrow fit, or the coloured one
#endif
// Value; w: of the narrow and the coloured fit the sum of its variances over the channels, of the wide one the share
// with which despeckling takes the narrow value.
layout(rgba32f, binding = 0) writeonly restrict uniform image2D candidate;
uniform ivec2 firstPixel;

const int kAtOnce = FIT >= 2 ? 1 : kHalves;  // halves of an invocation; where that is one, each has a layer
#define HAS_VARIANCE (FIT == 0 || FIT == 2)

const float kRidge = 1e-3;  // of the sum of weights, on all slopes: regressors that do not vary get none
// Widths of the features' weights, and of the distance's in radii.
const float kOfPosition = 0.5, kOfAlbedo = 0.5, kOfShining = 0.3, kOfNormal = 0.4, kOfDistance = 0.15;
const float kOfColour = 0.7;         // of colours, in standard errors of their difference
const float kEqualColours = 0.02;    // relative difference that never counts

// Eleven in three vectors, or their coefficients.
struct Regressors {
  vec4 a;  // 1, position (2), inverse distance
  vec4 b;  // albedo (3), shining
  vec4 c;  // normal (3), 0
};

// A symmetric matrix in blocks, named by rows and columns. The upper triangles of those on its diagonal are not read,
// so that compilers leave them out.
struct Symmetric {
  mat4 aa, ba, bb, ca, cb, cc;
};

void addSquare(inout Symmetric m, float weight, Regressors x) {
  m.aa += outerProduct(weight * x.a, x.a);
  m.ba += outerProduct(weight * x.b, x.a);
  m.bb += outerProduct(weight * x.b, x.b);
  m.ca += outerProduct(weight * x.c, x.a);
  m.cb += outerProduct(weight * x.c, x.b);
  m.cc += outerProduct(weight * x.c, x.c);
}

// z . M z, of a block and of the whole.
float quadratic(mat4 m, vec4 z) {
  vec4 below = vec4(dot(m[0].yzw, z.yzw), dot(m[1].zw, z.zw), m[2].w * z.w, 0.0);
  return dot(z, vec4(m[0].x, m[1].y, m[2].z, m[3].w) * z + 2.0 * below);
}

float quadratic(Symmetric m, Regressors z) {
  return quadratic(m.aa, z.a) + quadratic(m.bb, z.b) + quadratic(m.cc, z.c) +
         2.0 * (dot(z.b, m.ba * z.a) + dot(z.c, m.ca * z.a + m.cb * z.b));
}

// L^-T of the Cholesky factor L of a block on the diagonal, which is L L^T.
mat4 inverseFactor(mat4 m) {
  mat4 inverse = mat4(1.0);
  for (int i = 0; i < 4; ++i) {
    float scale = inversesqrt(max(m[i][i], 1e-12));
    vec4 below = scale * m[i] * vec4(greaterThan(ivec4(0, 1, 2, 3), ivec4(i)));
    inverse[i] *= scale;
    inverse -= outerProduct(inverse[i], below);
    m -= outerProduct(below, below);
  }
  return inverse;
}

// M^-1 e_0, by the Cholesky factor of M in blocks: first L y = e_0, then L^T z = y.
Regressors solve(Symmetric m) {
  mat4 a = inverseFactor(m.aa), ba = m.ba * a, ca = m.ca * a;
  mat4 b = inverseFactor(m.bb - ba * transpose(ba)), cb = (m.cb - ca * transpose(ba)) * b;
  mat4 c = inverseFactor(m.cc - ca * transpose(ca) - cb * transpose(cb));
  Regressors y, z;
  y.a = vec4(1.0, 0.0, 0.0, 0.0) * a;
  y.b = -(ba * y.a) * b;
  y.c = -(ca * y.a + cb * y.b) * c;
  z.c = c * y.c;
  z.b = b * (y.b - z.c * cb);
  z.a = a * (y.a - z.b * ba - z.c * ca);
  return z;
}

// Of a pixel, relative to that at `offset` from it.
Regressors regressorsAt(ivec2 pixel, ivec2 offset, vec4 colour, vec4 place) {
  vec4 other = imageLoad(surfacePlaces, pixel + offset);
  Regressors x;
  x.a = vec4(1.0, vec2(offset) / float(RADIUS * STRIDE), (other.w - place.w) / (other.w + place.w + 1e-30));
  x.b = imageLoad(surfaceColours, pixel + offset) - colour;
  x.c = vec4(other.xyz - place.xyz, 0.0);
  return x;
}

float distance2(Regressors x) {
  return dot(x.a.yz, x.a.yz) / (2.0 * kOfPosition * kOfPosition) + x.a.w * x.a.w / (2.0 * kOfDistance * kOfDistance) +
         dot(x.b.xyz, x.b.xyz) / (2.0 * kOfAlbedo * kOfAlbedo) + x.b.w * x.b.w / (2.0 * kOfShining * kOfShining) +
         dot(x.c.xyz, x.c.xyz) / (2.0 * kOfNormal * kOfNormal);
}

#if FIT >= 2
// Of two values and their variances.
float distance2(vec4 own, vec4 other) {
  vec3 difference = other.xyz - own.xyz, equal = 0.5 * kEqualColours * (abs(own.xyz) + abs(other.xyz));
  float noise = kOfColour * kOfColour * (own.w + other.w);
  return max(0.0, (dot(difference, difference) - own.w - min(own.w, other.w)) / (dot(equal, equal) + noise + 1e-30));
}
#endif

#if FIT == 1
// Share of despeckling: the square of the pixel's own variance over that and the square of its neighbours' mean one.
float speckOf(ivec2 pixel, int which, float sumAround, int pixelsAround) {
  if (halfAt(pixel, which).samples < 2.0) return 1.0;
  float own = imageLoad(film, inHalf(pixel, which)).w, others = (sumAround - own) / max(float(pixelsAround - 1), 1.0);
  return own * own / (own * own + others * others + 1e-30);
}
#endif

void main() {
  ivec2 pixel = firstPixel + ivec2(gl_GlobalInvocationID.xy);
  int which = int(gl_GlobalInvocationID.z);
  if (!isInPicture(pixel)) return;
  vec4 colour = imageLoad(surfaceColours, pixel), place = imageLoad(surfacePlaces, pixel);
#if FIT >= 2
  vec4 own = imageLoad(guide, inHalf(pixel, which));
  bool knowsVariance = halfAt(pixel, 1).samples >= 2.0;  // else colours say nothing
#endif

  // Sums over the window: the normal matrix, those of w x y^T, w^2 v x x^T and v
  Symmetric m = Symmetric(mat4(0.0), mat4(0.0), mat4(0.0), mat4(0.0), mat4(0.0), mat4(0.0));
  mat3x4 a[kAtOnce], b[kAtOnce], c[kAtOnce];
  Symmetric squares[kAtOnce];
  float around[kAtOnce];
  for (int k = 0; k < kAtOnce; ++k)
    a[k] = mat3x4(0.0), b[k] = mat3x4(0.0), c[k] = mat3x4(0.0), squares[k] = m, around[k] = 0.0;
  ivec2 first = max(ivec2(-RADIUS), -(pixel / STRIDE)), last = min(ivec2(RADIUS), (picture - 1 - pixel) / STRIDE);
  for (int row = first.y; row <= last.y; ++row)  // ends: at most 2 RADIUS + 1 steps
    for (int column = first.x; column <= last.x; ++column) {  // ends: likewise
      ivec2 offset = STRIDE * ivec2(column, row);
      Regressors x = regressorsAt(pixel, offset, colour, place);
      float far = distance2(x);
#if FIT >= 2
      vec4 other = imageLoad(guide, inHalf(pixel + offset, which));
      if (knowsVariance) far += distance2(own, other);
#endif
      float weight = exp(-far);
      addSquare(m, weight, x);
      for (int k = 0; k < kAtOnce; ++k) {
#if FIT == 3
        vec4 value = other;
#else
        vec4 value = imageLoad(film, inHalf(pixel + offset, which + k));
#endif
        a[k] += outerProduct(weight * x.a, value.xyz);
        b[k] += outerProduct(weight * x.b, value.xyz);
        c[k] += outerProduct(weight * x.c, value.xyz);
#if HAS_VARIANCE
        addSquare(squares[k], weight * weight * value.w, x);
#endif
        around[k] += value.w;
      }
    }

  // The fit in each half
  float ridge = kRidge * m.aa[0].x;
  m.aa[1].y += ridge, m.aa[2].z += ridge, m.aa[3].w += ridge;
  m.bb += mat4(ridge), m.cc += mat4(ridge);
  Regressors z = solve(m);
  for (int k = 0; k < kAtOnce; ++k) {
    vec4 value = vec4(z.a * a[k] + z.b * b[k] + z.c * c[k], 0.0);
#if HAS_VARIANCE
    value.w = quadratic(squares[k], z);
#elif FIT == 1
    ivec2 window = last - first + 1;
    value.w = speckOf(pixel, k, around[k], window.x * window.y);
#endif
    imageStore(candidate, inHalf(pixel, which + k), value);
  }
}
