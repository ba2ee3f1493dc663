// Light shafts: single scattering in a homogeneous medium along the view ray, of light from the sun (flag SUN) and the
// light propagation volume (flag PROPAGATED), added to the surface radiance seen through the medium.
//
// L = T(0, D) L_surface + integral from 0 to D of T(0, t) sigma_s S(t) dt [Chandrasekhar1960], T(0, t) = exp(-sigma_t
// t). The ray is divided into `steps` segments. S is sampled at one point per segment and T is integrated exactly: a
// segment of length d has the weight (1 - exp(-sigma_t d)) / sigma_t. The points have the same relative position in
// every segment of a ray, which differs between pixels [Jimenez2014]: shadow edges become noise instead of bands.
// S of the sun: its irradiance, times the transmittance of the medium and the visibility, times the phase function.
// Input: depth, shadow map, volume. In place: radiance, linear, scene units.
#include "lib/frame.glsl"
#include "lib/haze.glsl"
#include "lib/sh.glsl"
#if PROPAGATED
#include "lpv/lookup.glsl"
#endif
#if SUN
#include "forward/sun_shadow.glsl"
#endif
layout(local_size_x = 8, local_size_y = 8) in;
#if FULL_FLOAT
layout(rgba32f, binding = 0) uniform image2D radiance;
#else
layout(rgba16f, binding = 0) uniform image2D radiance;
#endif
layout(binding = 0) uniform sampler2D depth;
uniform mat4 worldFromClip;
uniform int steps;
uniform ivec2 firstPixel;  // of a part of the picture

#if PROPAGATED
// Light of the volume scattered at a point into a direction: W per square scene unit and sr, over sigma_s.
//
// The radiance is chosen to carry the flux of the kernel and the lookup. Radiance Y00 l0 + Y1 <l1, w> gives a plane the
// irradiance pi Y00 l0 + 2 pi / 3 Y1 <l1, -n>, and coefficients c give it a0 c0 + a1 <c1, -n> (lpv/lookup.glsl). So l0
// = 2/3 c0 and l1 = 3 / (2 pi) (Omega_f + 8 Omega_s / sqrt 5) c1. Scattering multiplies band 1 by g, the phase
// function's mean cosine [HenyeyGreenstein1941].
vec3 volumeScattered(vec3 position, vec3 towardsEye) {
  const float kBand0 = 2.0 / 3.0, kBand1 = 0.91461886;
  vec3 sum = vec3(0.0);
  float left = 1.0;
  for (int k = 0; k < lpv.shape.y && left > 0.0; ++k) {
    float weight = left * lpvCascadeWeight(k, position);
    left -= weight;
    if (weight <= 0.0) continue;
    float border;
    float cells = float(lpv.shape.x);
    vec3 place = lpvPlace(k, position, vec3(0.0), border) / vec3(cells, cells, cells * float(lpv.shape.y));
    vec3 first = kY1 * kBand1 * towardsEye;
    vec3 found = vec3(dot(textureLod(lpvRed, place, 0.0), vec4(kY00 * kBand0, haze.anisotropy.r * first)),
                      dot(textureLod(lpvGreen, place, 0.0), vec4(kY00 * kBand0, haze.anisotropy.g * first)),
                      dot(textureLod(lpvBlue, place, 0.0), vec4(kY00 * kBand0, haze.anisotropy.b * first)));
    sum += weight * border * max(found, 0.0);
  }
  return sum * lpv.referenceIrradiance;
}
#endif

vec3 scattered(vec3 position, vec3 towardsEye) {
  vec3 light = vec3(0.0);
#if SUN
  light += frame.sunIrradiance * sunVisibility(position, vec3(0.0)) * hazeTransmittance(position, -frame.sunDirection) *
           hazePhase(dot(frame.sunDirection, towardsEye));
#endif
#if PROPAGATED
  light += volumeScattered(position, towardsEye);
#endif
  return haze.scattering * light;
}

void main() {
  ivec2 pixel = firstPixel + ivec2(gl_GlobalInvocationID.xy), size = imageSize(radiance);
  if (any(greaterThanEqual(pixel, size))) return;
  vec3 clip = vec3((vec2(pixel) + 0.5) / vec2(size), texelFetch(depth, pixel, 0).r) * 2.0 - 1.0;
  vec4 seen = worldFromClip * vec4(clip, 1.0);
  vec3 ray = seen.xyz / seen.w - frame.cameraPosition;
  float far = length(ray);
  ray /= far;
  vec2 range = hazeRange(frame.cameraPosition, ray);
  range.y = min(range.y, far);
  if (range.y <= range.x) return;

  float piece = (range.y - range.x) / float(steps);
  float part = fract(52.9829189 * fract(dot(vec2(pixel), vec2(0.06711056, 0.00583715))));
  vec3 passes = exp(-haze.extinction * piece);  // transmittance of a segment
  // (1 - exp(-x)) / x; the quotient cancels for small x
  vec3 x = haze.extinction * piece;
  vec3 taken = piece * mix((1.0 - passes) / max(x, vec3(1e-20)), 1.0 - 0.5 * x, lessThan(x, vec3(1e-3)));
  vec3 sum = vec3(0.0), through = vec3(1.0);
  for (int i = 0; i < steps; ++i) {
    sum += through * taken * scattered(frame.cameraPosition + (range.x + (float(i) + part) * piece) * ray, -ray);
    through *= passes;
  }
  vec4 before = imageLoad(radiance, pixel);
  imageStore(radiance, pixel, vec4(before.rgb * through + sum, before.a));
}
