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
#include "lpv/radiance.glsl"
#endif
#if SUN
#include "forward/shadow_filter.glsl"
#include "forward/sun_shadow.glsl"
#endif
layout(local_size_x = 8, local_size_y = 8) in;
// unordered radiance: each dispatch writes its own pixels
#if FULL_FLOAT
layout(rgba32f, binding = 0) uniform image2D radiance;
#else
layout(rgba16f, binding = 0) uniform image2D radiance;
#endif
layout(binding = 0) uniform sampler2D depth;
uniform mat4 worldFromClip;
uniform int steps;
uniform ivec2 firstPixel;  // of a part of the picture
const int kVolumeEvery = 4;  // segments that share a lookup of the volume, which has no shadow edges

#if PROPAGATED
// Light of the volume scattered at a point into a direction: W per square scene unit and sr, over sigma_s. Scattering
// multiplies band 1 by g, the phase function's mean cosine [HenyeyGreenstein1941].
vec3 volumeScattered(vec3 position, vec3 towardsEye) {
  mat3x4 light = lpvRadiance(position);
  vec3 first = kY1 * towardsEye, g = haze.anisotropy;
  vec3 found = vec3(dot(light[0], vec4(kY00, g.r * first)), dot(light[1], vec4(kY00, g.g * first)),
                    dot(light[2], vec4(kY00, g.b * first)));
  return max(found, 0.0) * grids.referenceIrradiance;
}
#endif

#if SUN
vec3 sunScattered(vec3 position, vec3 towardsEye) {
  return frame.sunIrradiance * sunVisibility(position, vec3(0.0)) * hazeTransmittance(position, -frame.sunDirection) *
         hazePhase(dot(frame.sunDirection, towardsEye));
}
#endif

void main() {
  ivec2 pixel = firstPixel + ivec2(gl_GlobalInvocationID.xy), size = imageSize(radiance);
  if (any(greaterThanEqual(pixel, size))) return;
  vec3 clip = vec3((vec2(pixel) + 0.5) / vec2(size), texelFetch(depth, pixel, 0).r) * 2.0 - 1.0;
  vec4 seen = worldFromClip * vec4(clip, 1.0);
  vec3 eye = eyeOf(seen.xyz / seen.w), ray = seen.xyz / seen.w - eye;
  float far = length(ray);
  ray /= far;
  vec2 range = hazeRange(eye, ray);
  range.y = min(range.y, far);
  if (range.y <= range.x) return;

  float piece = (range.y - range.x) / float(steps);
  float part = fract(52.9829189 * fract(dot(vec2(pixel), vec2(0.06711056, 0.00583715))));
  vec3 passes = exp(-haze.extinction * piece);  // transmittance of a segment
  // (1 - exp(-x)) / x; the quotient cancels for small x
  vec3 x = haze.extinction * piece;
  vec3 taken = piece * mix((1.0 - passes) / max(x, vec3(1e-20)), 1.0 - 0.5 * x, lessThan(x, vec3(1e-3)));
  vec3 sum = vec3(0.0), through = vec3(1.0);
  for (int first = 0; first < steps; first += kVolumeEvery) {
    vec3 volume = vec3(0.0);
#if PROPAGATED
    float at = min(float(first) + float(kVolumeEvery) * part, float(steps));
    volume = volumeScattered(eye + (range.x + at * piece) * ray, -ray);
#endif
    for (int i = first; i < steps && i < first + kVolumeEvery; ++i) {
      vec3 light = volume;
#if SUN
      light += sunScattered(eye + (range.x + (float(i) + part) * piece) * ray, -ray);
#endif
      sum += through * taken * haze.scattering * light;
      through *= passes;
    }
  }
  vec4 before = imageLoad(radiance, pixel);
  imageStore(radiance, pixel, vec4(before.rgb * through + sum, before.a));
}
