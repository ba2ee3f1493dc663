// Next-event estimation at a surface: one shadow ray, to a light chosen by what it gives there. Of CANDIDATES samples
// of lights one is chosen in proportion to what it would bring if nothing blocked it, times the share of such light
// that reaches the cell, and now and then any of them: resampled importance sampling [Talbot2005]. It is unbiased for
// any shares above 0, and for candidates that depend on each other, so they are stratified. With SUN_APART one of them
// is the sun: where it shines, a number of candidates of the sun that differs from path to path would be noise.
//
// Flags: CANDIDATES; LIGHT_VISIBILITY: shares are known, else 1.
#if NEXT_EVENT
const uint kDrawn = uint(CANDIDATES - SUN_APART);  // candidates from the alias table
const float kByLight = 0.9;  // probability of a choice by light; else by number: a cell may have a corner that is lit
#if LIGHT_VISIBILITY
#include "pathtracer/light_cells.glsl"
layout(binding = 6) uniform usamplerBuffer lightCounts;  // light_visibility.comp

// Share of light of a kind that reaches a cell's surfaces.
float reachingShare(uint cell, uint kind) {
  int at = int(2u * (cell * kLightKinds + kindOfLight(kind)));
  float tried = float(texelFetch(lightCounts, at).x), reached = float(texelFetch(lightCounts, at + 1).x);
  return (reached + 0.01) / (tried + 0.02);
}
#endif

// What a light would bring if nothing blocked it; 0 behind the surface, and in its plane, where rounding would decide
// whether there is a choice. side: cosine to the geometric normal.
vec3 unblockedLight(Path path, Bsdf bsdf, LightSample light, float side) {
  const float kInPlane = 1e-6;
  if (!(side * dot(light.direction, bsdf.normal) > 0.0) || abs(side) < kInPlane) return vec3(0.0);
#if ROUGH_DIELECTRICS
  if (bsdf.kind != PATH_DIELECTRIC && side < 0.0) return vec3(0.0);
#else
  if (side < 0.0) return vec3(0.0);
#endif
  float pdf;
  vec3 contribution = evaluate(bsdf, -path.direction, light.direction, pdf) * light.value;
#if MIS
  if (light.pdf > 0.0) contribution *= powerHeuristic(light.pdf, pdf);
#endif
  return contribution;
}

// iorBeyond, beyond: refractive index behind the surface, and the closed boundaries that contain that side.
void addNextEvent(Path path, Surface surface, uint triangle, Bsdf bsdf, float iorBeyond, uvec4 beyond,
                  PathNumbers numbers) {
  vec3 towards = surface.geometricNormal;  // the side that lamps without a size light
#if SMOOTH_NORMALS && !FIXED_EPSILON
  ShadowStart bulging = shadowStart(surface, triangle);
  bool bulges = bulging.skip == kNoHit && bsdf.kind != PATH_DIELECTRIC;
  if (bulges) towards = bulging.normal;
#endif
#if LIGHT_VISIBILITY
  uint cell = lightCellBefore(surface);
#endif

  // One of the candidates.
  vec3 receiver = bsdf.kind == PATH_DIELECTRIC ? vec3(0.0) : bsdf.normal;
  uvec4 words = randomWords(numbers, path.event, kPurposePick), draw = pcg4d(words);
  vec2 xi = randomPair(numbers, path.event, kPurposeLight);
  bool isByLight = unitFloat(pcg4d(draw).x) < kByLight;
  LightSample light = LightSample(vec3(0.0), 0.0, vec3(0.0), vec3(0.0), false), candidate = light;
  vec3 contribution = vec3(0.0);
  float side = 0.0, chosenWeight = 1.0, sum = 0.0;
  uint count = 0u, chosen = 0u;
  for (uint k = 0u; k < uint(CANDIDATES); ++k) {
    uvec4 pickWords = uvec4(stratifiedWord(words.x, k % kDrawn, kDrawn), words.yzw + k * 0x9e3779b9u);
    vec2 shift = vec2(float(k) / float(CANDIDATES), 0.618034 * float(k));
    LightPick picked = LightPick(0u, 1.0, 1.0);  // the sun last
    if (k < kDrawn) picked = pickAt(pickWords, surface.position, receiver);
    if (!samplePicked(picked, surface.position, fract(xi + shift), pickWords, candidate)) continue;
    float candidateSide = dot(candidate.direction, candidate.pdf == 0.0 ? towards : surface.geometricNormal);
    vec3 brought = unblockedLight(path, bsdf, candidate, candidateSide);
    if (all(equal(brought, vec3(0.0)))) continue;
    if (k < kDrawn) brought /= float(kDrawn);
    float weight = clamp(dot(path.throughput, brought), 1e-30, 1e30);  // sums and quotients stay finite
#if LIGHT_VISIBILITY
    weight *= reachingShare(cell, lights[picked.light].kind);
#endif
    ++count;
    sum += weight;
    if (unitFloat(draw[k & 3u]) * (isByLight ? sum : float(count)) >= (isByLight ? weight : 1.0)) continue;
    contribution = brought;
    light = candidate;
    side = candidateSide;
    chosenWeight = weight;
    chosen = picked.light;
  }
  if (count == 0u) return;
  contribution /= kByLight * chosenWeight / sum + (1.0 - kByLight) / float(count);
  pickedLight = chosen;

  // Its ray.
  vec3 start = beside(surface, side > 0.0 ? surface.geometricNormal : -surface.geometricNormal);
#if SMOOTH_NORMALS && !FIXED_EPSILON
  if (bulges && light.pdf == 0.0) {
    start = bulging.origin;
    triangle = kNoHit;
  }
#endif
#if ROUGH_DIELECTRICS
  if (side < 0.0) {
    path.ior = iorBeyond;
    path.inside = beyond;
  }
#endif
#if LAMPS_OUTSIDE
  if (path.ior != 1.0) return;  // a straight line across a refracting boundary does not reach a lamp
#endif
#if MEDIA && !FIXED_EPSILON
  float head = gapAt(surface) / max(abs(side), 1e-4);
#else
  const float head = 0.0;
#endif
  queueShadowRay(path, contribution, start, light, triangle, head, numbers);
}
#endif
