// A collision in a medium: light from a lamp, a new direction, and roulette. Include crossing.glsl before this file.
//
// Flags: LAMPS_OUTSIDE (no lamp is inside a dielectric); deviations DISTANCE_WITHOUT_PDF, BOOSTED_INTERACTION,
// ROULETTE_WITHOUT_DIVISION, ROULETTE_AT_SURFACES.
const uint kPurposePhase = kFreePurpose + 1u;
const uint kPurposeMediumChoice = kFreePurpose + 2u;
const uint kPurposeSeek = kFreePurpose + 4u;

// Outcome of a ray in a medium.
const int kFlightArrives = 0;    // it reaches the target of the traced ray
const int kScattered = 1;  // it scatters, or is amid a long flight: continues with its own ray
const int kEnded = 2;

// The largest coordinate of any triangle, stored in the header of the ray caster's triangles.
float sceneMagnitude() { return uintBitsToFloat(texelFetch(bvhTriangles, 0).x); }

// A path that left a closed boundary through a crack would stay in its medium forever: detected by a position outside
// all of the scene's coordinates.
bool leaked(Path path) {
  vec3 a = abs(path.origin);
  return any(greaterThan(path.inside, uvec4(0u))) && max(a.x, max(a.y, a.z)) > sceneMagnitude() * 1.001;
}

#if ROULETTE_AT_SURFACES
// Roulette once per iteration of the published loop [VPT2024, algorithm 3]. The text does not say at which iteration it
// starts (rrStart), so it is played in all. False: the path ends.
bool survivesIteration(inout Path path, float u) {
  float largest = max(path.throughput.r, max(path.throughput.g, path.throughput.b));
#if ROULETTE_WITHOUT_DIVISION
  return u < min(largest, 0.95);
#else
  float survival = path.event > 1024u ? min(largest / kRouletteBelow, 0.999) : min(largest / kRouletteBelow, 1.0);
  if (!(u < survival)) return false;
  path.throughput /= survival;
  return true;
#endif
}
#endif

// Roulette by the throughput alone: a depth limit would darken milk. False: the path ends.
bool survives(inout Path path, float u) {
  float largest = max(path.throughput.r, max(path.throughput.g, path.throughput.b));
#if ROULETTE_WITHOUT_DIVISION && !ROULETTE_AT_SURFACES
  return u < min(largest, 0.95);
#else
#if ROULETTE_AT_SURFACES
  float survival = 1.0;  // [VPT2024, algorithm 3] plays it once, after traceMedium as a whole
#else
  float survival = min(largest / kRouletteBelow, 1.0);
#endif
  // In an endless medium without absorption nothing else ends a path. The probability is so small that a path across a
  // slab of optical depth 1000 (slowest mode: 3.3e-6 per collision) is rarely lost: if weights grew faster than half of
  // that, late arrivals would have infinite variance.
  if (path.event > (1u << 20)) survival = min(survival, 1.0 - exp2(-20.0));
  if (!(u < survival)) return false;
  path.throughput /= survival;
  return true;
#endif
}

#if NEXT_EVENT
// Whether that is a point light: its 1/r^2 sampled at collisions alone would have infinite variance.
bool isPointLike(LightPick picked) {
  uint kind = lights[picked.light].kind;
  return kind == PATH_LIGHT_POINT || kind == PATH_LIGHT_SPOT;
}

// A new direction, drawn from the phase function or, occasionally, towards the lamp that the next flight samples. A
// flight that passes the lamp at a distance h finds light in proportion to 1/h; with directions from the phase function
// alone this has infinite variance. Drawing the angle to the lamp uniformly gives a density proportional to 1/h. The
// farther the lamp, the less often: the flight would rarely get there, and each such choice makes the path's weight a
// little more uneven.
void seekLamp(inout Path path, MediumRecord medium, LightPick picked, vec3 before, vec3 q, PathNumbers numbers,
              inout vec3 weight) {
  uvec4 choice = randomWords(numbers, path.event, kPurposeSeek);
  vec3 to = lights[picked.light].a - path.origin;
  float r = length(to),
        share = 0.25 * exp(-r * min(medium.extinction.r, min(medium.extinction.g, medium.extinction.b)));
  if (!(r > 0.0)) return;
  to /= r;
  if (unitFloat(choice.x) < share) {
    float angle = 3.14159265358979324 * unitFloat(choice.y);
    path.direction = phaseDirection(to, sin(angle), cos(angle), unitFloat(choice.z));
  }
  vec3 p = phaseValue(medium, before, path.direction);
  path.pdf = (1.0 - share) * dot(q, p) + share / (19.7392088 * max(length(cross(path.direction, to)), 1e-6));  // 2 pi^2
  weight = p / path.pdf;
}
#endif

// Whether a straight line from the path's position can reach any lamp. If all lamps are outside, it cannot from within
// a refracting boundary.
bool lampsReach(Path path) {
#if LAMPS_OUTSIDE
  return path.ior == 1.0;
#else
  return true;
#endif
}

// How much longer the way along a direction is than from the path's origin. inward: by how much, along a face's normal,
// the origin was moved away from the face.
float headOf(vec3 inward, vec3 direction) {
  float shift = length(inward);
  if (!(shift > 0.0)) return 0.0;
  float cosine = dot(inward, direction) / shift;
  return shift / (abs(cosine) > 1e-4 ? cosine : cosine < 0.0 ? -1e-4 : 1e-4);
}

// At a collision: light from a lamp if `queuesLight`, then a new direction from the phase function. seeks: with which
// probability lamps are sought by way of boundaries and mirrors.
int scatterInMedium(inout Path path, MediumRecord medium, vec3 inward, PathNumbers numbers, bool queuesLight,
                    float seeks) {
  path.skip = kNoHit;
  path.head = 0.0;
  path.chain = 0u;
  path.travelled = 0.0;
  ++path.event;
  ++collisionCount;
  if (leaked(path)) {
    atomicAdd(leakedPaths, 1u);
    return kEnded;
  }
  if (path.scatterings >= tracer.maxScatterings || all(equal(path.throughput, vec3(0.0)))) return kEnded;
  ++path.scatterings;
#if NEXT_EVENT
  LightSample light = LightSample(vec3(0.0), 0.0, vec3(0.0), vec3(0.0), false);
  uvec4 words = randomWords(numbers, path.event, kPurposePick);
  LightPick picked = LightPick(0u, 1.0, 1.0);
  if (queuesLight) picked = pickAt(words, path.origin, vec3(0.0));
#if DISTANCE_WITHOUT_PDF || BOOSTED_INTERACTION
  const bool asked = false;
#else
  bool asked = queuesLight && medium.grid < 0 && isPointLike(picked);  // flights sample point lights
#endif
  pickedLight = picked.light;
  if (counts(path.scatterings) && queuesLight && !asked &&
      samplePicked(picked, path.origin, randomPair(numbers, path.event, kPurposeLight), words, light)) {
    vec3 phase = phaseValue(medium, path.direction, light.direction);
    vec3 contribution = phase * light.value;
#if MIS
    if (light.pdf > 0.0) contribution *= powerHeuristic(light.pdf, dot(channelProbabilities(path.throughput), phase));
#endif
    if (any(greaterThan(contribution, vec3(0.0))))
      queueShadowRay(path, contribution, path.origin, light, kNoHit, headOf(inward, light.direction), numbers);
  }
#endif
#if !SCATTERED_LIGHT && !NEXT_EVENT
  return kEnded;
#endif
#if MANIFOLDS
  requestManifold(path, kNoHit, vec2(0.0), seeks, numbers);
#endif
  uvec2 choice = randomWordPair(numbers, path.event, kPurposeMediumChoice);
  vec3 weight, before = path.direction, q = channelProbabilities(path.throughput);
  path.direction = phaseSample(medium, before, q, unitFloat(choice.x), randomPair(numbers, path.event, kPurposePhase),
                               weight, path.pdf);
#if NEXT_EVENT && (POINTS || SPOTS)
  if (asked) seekLamp(path, medium, picked, before, q, numbers, weight);
#endif
  // Roulette by the path's value, not by the weight of a direction towards a lamp: that weight is small where the
  // flight finds much light.
  if (!survives(path, unitFloat(choice.y))) return kEnded;
  path.throughput *= weight;
  return kScattered;
}
