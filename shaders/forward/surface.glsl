// Forward shading of surfaces: direct light of the sun, spot and omnidirectional lights with filtered shadow maps;
// emission; what the frame's technique adds.
// Output: radiance, linear, scene units. A Lambertian base, L = albedo / pi * E, under a coat (lib/coat.glsl).
//
// A technique's own fragment shader (shaders/NAME/surface.frag) includes this file last. It defines before:
//   #define INDIRECT 1   or 0, and then not the function
//   vec3 indirectIrradiance(vec3 position, vec3 normal, vec3 meshNormal)   W per square scene unit; all light but that
//     of sun, spot and omnidirectional lights: the irradiance cache includes the sky and emissive surfaces
// normal: for shading, possibly normal-mapped; meshNormal: the mesh's own; both on the viewer's side. And with a flag:
//   INDIRECT_SPECULAR: vec3 indirectSpecular(position, normal, toCamera, coat)   radiance that the coat reflects of it
//   BEHIND_MEDIA: vec4 mediaInFront()   what media before the surface show, what the surface reflects included, and the
//     share of its other light that passes them
//   SHOW_REFUSED: bool indirectIsRefused()   whether to paint the pixel red
#include "lib/frame.glsl"
#include "lib/sh.glsl"
#include "lib/material.glsl"
#include "shared/inspected.h"
#if INSPECTED
#include "forward/inspected.glsl"
#endif

centroid in vec3 vPosition;
centroid in vec3 vNormal;
centroid in vec2 vTexCoord;
centroid in float vTangentPlane;
layout(location = 0) out vec4 radiance;

#if RAY_LAMPS || SUN_BY_RAYS
#include "forward/ray_shadows.glsl"
#endif
#if (SUN && !SUN_BY_RAYS) || SOFT_SPOTS || SOFT_POINTS
#include "forward/shadow_filter.glsl"
#endif
#if SUN && !SUN_BY_RAYS
#include "forward/sun_shadow.glsl"
#endif
#if SPOTS || POINTS || PLAIN_LAMPS
#include "forward/lights.glsl"
#endif

#if SPECULAR
#include "lib/material_coat.glsl"
#include "lib/coat_reflection.glsl"
Coat coat, highlight;  // highlight: for lamps
bool isCoated;

// The lobe of all that a sample covers, whose normals differ: a highlight smaller than a pixel flickers in motion
// [TokuyoshiKaplanyan2019]. The sample's variance is that of a Gaussian as wide as what it covers.
Coat coatOfArea(Coat coat, vec3 normal) {
  const float kVariance = 0.25, kMost = 0.18;
  vec3 across = dFdx(normal), up = dFdy(normal);
  float spread = 2.0 * kVariance * frame.sampleArea * (dot(across, across) + dot(up, up));
  if (coat.alpha > 0.0) coat.alpha = min(sqrt(coat.alpha * coat.alpha + min(spread, kMost)), 1.0);
  return coat;
}
#endif
#if EMISSION
#include "lib/emission.glsl"
#endif
#if HAZE
#include "lib/haze.glsl"
#endif

// BRDF value: reflected radiance per irradiance.
vec3 reflection(vec3 albedo, vec3 normal, vec3 toCamera, vec3 toLight) {
#if SPECULAR
  return coatedReflection(highlight, albedo, normal, toCamera, toLight);
#else
  return albedo / kPi;
#endif
}

// Adds one term of the radiance; the inspected pixel also records it.
void add(inout vec3 result, vec3 radiance, int term) {
  result += radiance;
#if INSPECTED
  record(term, vec4(radiance, 0.0));
#endif
}

// How high the surface bulges over its triangle along the mesh's normal, on the viewer's side: the mean of the planes
// through the corners that are perpendicular to their normals [Hanika2021], as in rays/materials.glsl.
float bulgeHeight() {
  vec3 place = abs(vPosition);
  float height = (vTangentPlane - dot(vNormal, vPosition)) * (gl_FrontFacing ? 1.0 : -1.0);
  return height > 7.62939453125e-6 * max(place.x, max(place.y, place.z)) ? height : 0.0;
}

void main() {
  // The material, and the surface's normals.
  vec3 albedo = materialAlbedo(vTexCoord), mapped = materialNormal(vNormal, vPosition, vTexCoord);
#if SPECULAR
  coat = materialCoat(vTexCoord);
  isCoated = any(greaterThan(coat.specular, vec3(0.0))) || coat.alpha == 0.0;
#endif
#if EMISSION
  vec3 emitted = materialEmitted(vTexCoord);
#endif
#if SHADOW_MAPS
  vec3 face = cross(normalize(dFdx(vPosition)), normalize(dFdy(vPosition)));  // the triangle's own normal
#endif
  bool isCutOut = materialCutOut(vTexCoord);  // discarded last: lights take derivatives
#if INSPECTED
  isVisible = !isCutOut;
#endif
  vec3 toCamera = normalize(eyeOf(vPosition) - vPosition);
  // Surfaces are two-sided. The geometric side of the face, not the interpolated normal, decides whether to flip the
  // normal towards the viewer.
  vec3 meshNormal = normalize(gl_FrontFacing ? vNormal : -vNormal);
  vec3 normal = meshNormal;
#if SHADOW_MAPS
  vec3 lifted = vPosition + bulgeHeight() * meshNormal;  // where shadows are looked up
  face = dot(face, face) > 1e-12 ? normalize(dot(face, toCamera) > 0.0 ? face : -face) : meshNormal;
#endif
#if NORMAL_MAPS
  normal = normalize(gl_FrontFacing ? mapped : -mapped);
#endif
#if SPECULAR
  highlight = coatOfArea(coat, normal);
#endif

  // Sun and lamps.
  vec3 result = vec3(0.0);
#if SUN
  float cosine = dot(normal, -frame.sunDirection);
  if (cosine > 0.0) {
#if SUN_BY_RAYS
    float visible = lightVisibility(0);
#else
    // A face turned away from the sun that is lit since it bulges has no plane in the sun's map.
    bool isTurnedAway = lifted != vPosition && dot(face, frame.sunDirection) >= 0.0;
    float visible = sunVisibility(lifted, isTurnedAway ? meshNormal : face);
#endif
    vec3 irradiance = frame.sunIrradiance * (cosine * visible);
#if HAZE
    irradiance *= hazeTransmittance(vPosition, -frame.sunDirection);
#endif
    add(result, reflection(albedo, normal, toCamera, -frame.sunDirection) * irradiance, INSPECTED_SUN);
  }
#endif
#if SPOTS
  for (int i = 0; i < SPOTS; ++i) {
    Arriving light = spotLight(i, vPosition, normal, lifted, SOFT_SPOTS > 0 ? face : meshNormal);
    if (light.cosine > 0.0)
      add(result, reflection(albedo, normal, toCamera, light.toLight) * light.irradiance, INSPECTED_SPOTS + i);
  }
#endif
#if POINTS
  for (int i = 0; i < POINTS; ++i) {
    Arriving light = pointLight(i, vPosition, normal, lifted, SOFT_POINTS > 0 ? face : meshNormal);
    if (light.cosine > 0.0)
      add(result, reflection(albedo, normal, toCamera, light.toLight) * light.irradiance, INSPECTED_POINTS + i);
  }
#endif
#if PLAIN_LAMPS
  vec3 plain = vec3(0.0);
  for (int i = 0; i < plainLamps.length(); ++i) {
    Arriving light = plainLamp(i, vPosition, normal);
    if (!(light.cosine > 0.0)) continue;
    vec3 reflected = reflection(albedo, normal, toCamera, light.toLight) * light.irradiance;
#if RAY_LAMPS
    if (i < RAY_LAMPS) reflected *= lightVisibility(SUN_BY_RAYS + i);
#if INSPECTED
    if (i < INSPECTED_LAMPS) {
      record(i < SPOT_LAMPS ? INSPECTED_SPOTS + i : INSPECTED_POINTS + i - SPOT_LAMPS, vec4(reflected, 0.0));
      result += reflected;
      continue;
    }
#endif
#endif
    plain += reflected;
  }
  add(result, plain, INSPECTED_PLAIN_LAMPS);
#endif

  // What the technique adds, and emission.
#if INDIRECT
  vec3 indirect = indirectIrradiance(vPosition, normal, meshNormal);
#if SPECULAR
  // as of light that is the same from all sides
  if (isCoated && coat.alpha > 0.0) albedo *= 1.0 - coatAlbedo(coat, dot(normal, toCamera));
#endif
  result += albedo / kPi * indirect;
#endif
#if INDIRECT_SPECULAR
  if (coat.alpha == 0.0) result = vec3(0.0);  // mirrors and glass have no base
#if !BEHIND_MEDIA
  if (isCoated) add(result, indirectSpecular(vPosition, normal, toCamera, coat), INSPECTED_GLOSSY);
#endif
#endif
#if EMISSION
  add(result, emitted, INSPECTED_EMISSION);
#endif
#if BEHIND_MEDIA
  vec4 media = mediaInFront();
  result = media.a * result + media.rgb;
#endif
#if INSPECTED
  record(INSPECTED_POSITION, vec4(vPosition, 1.0));
  record(INSPECTED_NORMAL, vec4(normal, 0.0));
  record(INSPECTED_MESH_NORMAL, vec4(meshNormal, 0.0));
  record(INSPECTED_ALBEDO, vec4(albedo, 0.0));
  record(INSPECTED_RADIANCE, vec4(result, 0.0));
#if INDIRECT
  record(INSPECTED_INDIRECT, vec4(indirect, 0.0));
#endif
#endif
#if SHOW_REFUSED
  if (indirectIsRefused()) result = vec3(1.0, 0.0, 0.0) / frame.exposure;
#endif
  radiance = vec4(result, 1.0);
  if (isCutOut) discard;
}
