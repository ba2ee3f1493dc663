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
#else
float reachingShare(uint cell, uint kind) { return 1.0; }
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

struct Choice {
  vec3 contribution;
  LightSample light;
  float side, weight, sum;  // sum: of all candidates' weights so far
  uint count, number;       // of candidates so far; of the chosen light
};

// Takes a candidate in place of the one chosen so far, in proportion to what they would bring, or by number. side: of
// the surface; among: how many candidates of its kind there are; share: of such light that reaches the surface.
void consider(inout Choice choice, Path path, Bsdf bsdf, LightSample candidate, uint number, float side, float among,
              float share, float u, bool isByLight) {
  vec3 brought = unblockedLight(path, bsdf, candidate, side) / among;
  if (all(equal(brought, vec3(0.0)))) return;
  float weight = share * clamp(dot(path.throughput, brought), 1e-30, 1e30);  // sums and quotients stay finite
  ++choice.count;
  choice.sum += weight;
  if (u * (isByLight ? choice.sum : float(choice.count)) >= (isByLight ? weight : 1.0)) return;
  choice = Choice(brought, candidate, side, weight, choice.sum, choice.count, number);
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
#else
  const uint cell = 0u;
#endif

  // One of the candidates.
  vec3 receiver = bsdf.kind == PATH_DIELECTRIC ? vec3(0.0) : bsdf.normal;
  uvec4 words = randomWords(numbers, path.event, kPurposePick), draw = pcg4d(words);
  vec2 xi = randomPair(numbers, path.event, kPurposeLight);
  bool isByLight = unitFloat(pcg4d(draw).x) < kByLight;
  Choice choice = Choice(vec3(0.0), LightSample(vec3(0.0), 0.0, vec3(0.0), vec3(0.0), false), 0.0, 1.0, 0.0, 0u, 0u);
  for (uint k = 0u; k < kDrawn; ++k) {
    uvec4 pickWords = uvec4(stratifiedWord(words.x, k, kDrawn), words.yzw + k * 0x9e3779b9u);
    vec2 shift = vec2(float(k) / float(CANDIDATES), 0.618034 * float(k));
    LightPick picked = pickAt(pickWords, surface.position, receiver);
    LightSample candidate;
    if (!samplePicked(picked, surface.position, fract(xi + shift), pickWords, candidate)) continue;
    float side = dot(candidate.direction, candidate.pdf == 0.0 ? towards : surface.geometricNormal);
    consider(choice, path, bsdf, candidate, picked.light, side, float(kDrawn),
             reachingShare(cell, lights[picked.light].kind), unitFloat(draw[k & 3u]), isByLight);
  }
#if SUN_APART
  PathLight sun = lights[0];
  LightSample candidate;
  sampleSun(sun, fract(xi + vec2(float(kDrawn) / float(CANDIDATES), 0.618034 * float(kDrawn))), candidate);
  consider(choice, path, bsdf, candidate, 0u, dot(candidate.direction, towards), 1.0,
           reachingShare(cell, PATH_LIGHT_SUN), unitFloat(draw[kDrawn & 3u]), isByLight);
#endif
  if (choice.count == 0u) return;
  float probability = kByLight * choice.weight / choice.sum + (1.0 - kByLight) / float(choice.count);
  vec3 contribution = choice.contribution / probability;
  LightSample light = choice.light;
  float side = choice.side;
  pickedLight = choice.number;

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
