// Next-event estimation at a surface: one shadow ray, to a light chosen by what it gives there. Of CANDIDATES samples
// of lights one is chosen in proportion to what it would bring if nothing blocked it, times the share of such light that
// reaches the cell, and now and then any of them: resampled importance sampling [Talbot2005]. It is unbiased for any
// shares above 0, and for candidates that depend on each other, so they are stratified.
//
// Flags: CANDIDATES; LIGHT_VISIBILITY: shares are known, else 1.
#if NEXT_EVENT
const float kByLight = 0.9;  // probability of a choice by light; else by number: a cell may have a corner that is lit
#if LIGHT_VISIBILITY
#include "pathtracer/light_cells.glsl"
layout(binding = 6) uniform usamplerBuffer lightCounts;  // light_visibility.comp

// Share of light of a kind that reaches a cell's surfaces.
float reachingShare(uint cell, uint kind) {
  int at = int(2u * (cell * kLightKinds + kindOfLight(kind)));
  float tried = float(texelFetch(lightCounts, at).x), reached = float(texelFetch(lightCounts, at + 1).x);
  return (reached + 0.05) / (tried + 0.1);
}
#endif

// What a light would bring if nothing blocked it; 0 behind the surface. side: cosine to the geometric normal.
vec3 unblockedLight(Path path, Bsdf bsdf, LightSample light, float side) {
  if (!(side * dot(light.direction, bsdf.normal) > 0.0)) return vec3(0.0);
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
  uint cell = lightCellAt(surface.position);
#endif

  // One of the candidates; the loop's last turn samples it again, so that only its number is kept.
  uvec4 words = randomWords(numbers, path.event, kPurposePick), draw = words;
  vec2 xi = randomPair(numbers, path.event, kPurposeLight);
  LightSample light;
  vec3 contribution = vec3(0.0);
  float side = 0.0, sum = 0.0, share = 1.0;
  uint count = 0u, chosen = 0u, byLight = 0u, byNumber = 0u;
  float weightByLight = 0.0, weightByNumber = 0.0;
  for (uint turn = CANDIDATES > 1 ? 0u : 1u; turn <= uint(CANDIDATES); ++turn) {
    bool isLast = turn == uint(CANDIDATES);
#if CANDIDATES > 1
    if (isLast) {
      if (count == 0u) return;
      bool isByLight = unitFloat(draw.z) < kByLight;
      chosen = isByLight ? byLight : byNumber;
      share = kByLight * (isByLight ? weightByLight : weightByNumber) / sum + (1.0 - kByLight) / float(count);
    }
#endif
    uint k = isLast ? chosen : turn;
    uvec4 pickWords = pcg4d(words + uvec4(0u, k, 0u, 0u));
    pickWords.x = stratifiedWord(words.x, k, uint(CANDIDATES));
    vec2 shift = vec2(float(k) / float(CANDIDATES), 0.618034 * float(k));
    bool reaches = sampleLight(surface.position, fract(xi + shift), pickWords, light);
    side = dot(light.direction, light.pdf == 0.0 ? towards : surface.geometricNormal);
    contribution = reaches ? unblockedLight(path, bsdf, light, side) : vec3(0.0);
#if CANDIDATES > 1
    float weight = dot(path.throughput, contribution);
#if LIGHT_VISIBILITY
    weight *= reachingShare(cell, lights[pickedLight].kind);
#endif
    if (isLast || !(weight > 0.0)) continue;
    ++count;
    sum += weight;
    draw = pcg4d(draw);
    if (unitFloat(draw.x) * sum < weight) byLight = k, weightByLight = weight;
    if (unitFloat(draw.y) * float(count) < 1.0) byNumber = k, weightByNumber = weight;
#endif
  }
  if (all(equal(contribution, vec3(0.0)))) return;
  contribution /= share * float(CANDIDATES);

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
