// Irradiance at a point from the reflective shadow map, sampled around the point's projection (s,t) at
// (s + r xi1 sin 2 pi xi2, t + r xi1 cos 2 pi xi2) [Dachsbacher2005 sec 4.1].
// The sampling density per texel is 1 / (2 pi R^2 xi1), R = r in texels, so the unbiased estimate of the sum over all
// texels within R is sum_i E_i xi1_i 2 pi R^2 / N. The published weight has xi1^2 in place of xi1. With WHOLE_MAP xi1^p
// replaces xi1, and the weight is p xi1^(2p-1) (engine/rsm/rsm_gather.cpp). Lights are gathered one after the other,
// one dispatch each: `adds` is 1 from the second on.
#include "rsm/transfer.glsl"
layout(std430, binding = 0) readonly buffer Pattern { vec4 pattern[]; };  // sine and cosine times distance; weight; 0
uniform int adds;
uniform float gatherRadius;  // r, of the farthest sample, as a fraction of the map's width
#if INSPECTED
// For the inspected pixel (rsm/inspect.comp): receives sample i's contribution to the irradiance, and its surfel.
void tell(int i, RsmSurfel surfel, ivec3 texel, vec3 irradiance);
#endif

#if MAP_LIGHT == MAP_POINT
// The map covers the whole sphere about the lamp: samples lie at the angle pi r xi1 from the point's direction, rotated
// by 2 pi xi2. Their density per texel is dOmega / (2 pi^2 r sin(pi r xi1)), so sin / dOmega replaces the plane's xi1.
vec3 gatherIrradiance(vec3 position, vec3 normal, float rotation) {
  vec3 away = position - lightPlace;
  if (!(dot(away, away) > 0.0)) return vec3(0.0);
  vec3 axis = normalize(away),
       right = normalize(cross(axis, abs(axis.y) < 0.9 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0))),
       up = cross(right, axis);
  float most = kPi * min(gatherRadius, 1.0), c = cos(rotation), s = sin(rotation);
  vec3 sum = vec3(0.0);
  for (int i = 0; i < pattern.length(); ++i) {
    vec3 p = pattern[i].xyz;
    float xi1 = length(p.xy);
    if (!(xi1 > 0.0)) continue;
    vec2 turned = vec2(c * p.x + s * p.y, c * p.y - s * p.x) / xi1;
    float sine = sin(most * xi1), solidAngle;
    ivec3 texel = rsmTexel(cos(most * xi1) * axis + sine * (turned.x * right + turned.y * up), solidAngle);
    RsmSurfel surfel = rsmSurfel(texel);
    if (!surfel.lit) continue;
    vec3 part = p.z * (sine / (xi1 * solidAngle)) * surfelIrradiance(surfel, position, normal);
    sum += part;
#if INSPECTED
    tell(i, surfel, texel, part * (2.0 * kPi * most / float(pattern.length())));
#endif
  }
  return sum * (2.0 * kPi * most / float(pattern.length()));
}
#else
vec3 gatherIrradiance(vec3 position, vec3 normal, float rotation) {
  ivec2 size = rsmSize();
  vec2 centre = rsmProject(position) * vec2(size);
#if WHOLE_MAP
  centre = clamp(centre, vec2(0.0), vec2(size));  // so that the samples reach all of it
#endif
  vec2 radius = gatherRadius * vec2(size);
  float c = cos(rotation), s = sin(rotation);
  vec3 sum = vec3(0.0);
  for (int i = 0; i < pattern.length(); ++i) {
    vec3 p = pattern[i].xyz;
    // There is no light beyond the map.
    ivec2 at = clampedInt(floor(centre + radius * vec2(c * p.x + s * p.y, c * p.y - s * p.x)), ivec2(-1), size);
    if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, size))) continue;
    RsmSurfel surfel = rsmSurfel(ivec3(at, 0));
    if (!surfel.lit) continue;
    vec3 part = p.z * surfelIrradiance(surfel, position, normal);
    sum += part;
#if INSPECTED
    tell(i, surfel, ivec3(at, 0), part * (2.0 * kPi * radius.x * radius.y / float(pattern.length())));
#endif
  }
  return sum * (2.0 * kPi * radius.x * radius.y / float(pattern.length()));
}
#endif

// The angle by which a pixel rotates the pattern, chosen so that neighbours differ most: the interleaved gradient noise
// of J. Jimenez, "Next generation post processing in Call of Duty: Advanced Warfare", SIGGRAPH course 2014.
float pixelRotation(ivec2 pixel) {
#if ROTATION
  return 2.0 * kPi * fract(52.9829189 * fract(dot(vec2(pixel), vec2(0.06711056, 0.00583715))));
#else
  return 0.0;
#endif
}
