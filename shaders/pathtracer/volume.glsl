// A path in participating media: how far it flies, what it gathers, and how it continues from a collision; and the
// transmittance of straight lines. Include the lights, path.glsl and shadow_ray.glsl before this file.
//
// Flags: INTERIORS (closed boundaries: paths count those that contain them), MEDIA, HETEROGENEOUS, VOLUME_EMISSION,
// LAMPS_OUTSIDE (no lamp is inside a dielectric), WALKS (dense media have clearance grids); deviations
// DISTANCE_WITHOUT_PDF, BOOSTED_INTERACTION, ROULETTE_WITHOUT_DIVISION, ROULETTE_AT_SURFACES, STRAIGHT_SHADOW_RAYS,
// UNATTENUATED_SHADOW_RAYS.
#include "lib/clamped_int.glsl"
#include "pathtracer/boundary.glsl"
#if MEDIA
#include "lib/angle.glsl"
#include "pathtracer/media.glsl"
layout(std430, binding = 6) restrict readonly buffer MediumBlock { MediumRecord media[]; };
// NVIDIA's compiler refuses a structure of such a block as an argument (C1317), where OpenGL allows it.
MediumRecord mediumOf(int index) { return media[index]; }
#endif
#if HETEROGENEOUS
#include "pathtracer/density.glsl"
#endif

const uint kPurposeFlight = kFreePurpose;
const uint kPurposePhase = kFreePurpose + 1u;
const uint kPurposeMediumChoice = kFreePurpose + 2u;
const uint kPurposeSeek = kFreePurpose + 4u;

// Outcome of a ray in a medium.
const int kFlightArrives = 0;    // it reaches the target of the traced ray
const int kScattered = 1;  // it scatters, or is amid a long flight: continues with its own ray
const int kEnded = 2;

int rankOf(uint triangle) { return int(materials[triangleData[triangle * TRIANGLE_WORDS].w].boundary); }

// Whether a ray comes from the triangle's front side.
bool facesAgainst(uint triangle, vec3 direction) { return dot(normalOf(triangle), direction) < 0.0; }

#if TOUCHING
// Crosses all boundaries within a gap of a surface, where rounding decides. Rays that continue behind the surface start
// inside `beyond`, rays in front of it inside `before`. Coinciding faces may be hit in any order, up to half a gap
// before the surface too, so the counts decide: a boundary can be entered if the path is outside it and left if it is
// inside. A short ray finds the faces, hit after hit.
struct Besides {
  uvec4 beyond, before;
  float tMin;
  uint skip;
  uint crossed;
  float gap;  // of the surface
};
Besides besides;
const uint kMostBesides = 8u;
#if PARKED
void takeBesides() {
  uvec4 w = state[wordAt(kBesidesWord + 2u)];
  besides = Besides(state[wordAt(kBesidesWord)], state[wordAt(kBesidesWord + 1u)], uintBitsToFloat(w.x), w.y, w.z,
                    uintBitsToFloat(w.w));
}
void parkBesides() {
  state[wordAt(kBesidesWord)] = besides.beyond;
  state[wordAt(kBesidesWord + 1u)] = besides.before;
  state[wordAt(kBesidesWord + 2u)] =
      uvec4(floatBitsToUint(besides.tMin), besides.skip, besides.crossed, floatBitsToUint(besides.gap));
}
#else
void takeBesides() {}
void parkBesides() {}
#endif

// ahead: one gap long, through to the far side of the surface.
Ray besidesRay(Besides b, vec3 position, vec3 ahead) { return Ray(position - ahead, b.tMin, 2.0 * ahead, 1.0); }

// Handles a hit of the short ray. False: the search is over, and `hit` is the first surface found that bounds nothing,
// or kNoHit.
bool crossBesides(inout Besides b, inout Hit hit, vec3 ahead) {
  if (hit.triangle == kNoHit) return false;
  int rank = rankOf(hit.triangle);
  bool front = facesAgainst(hit.triangle, ahead);
  if (hit.t < 0.25) {
    if (rank >= 0 && isInsideOf(b.before, rank) == front) crossBoundary(b.before, rank, !front);
  } else {
    if (rank < 0) return false;
    if (isInsideOf(b.beyond, rank) != front) crossBoundary(b.beyond, rank, front);
  }
  b.tMin = hit.t;
  b.skip = hit.triangle;
  if (++b.crossed < kMostBesides) return true;
  hit.triangle = kNoHit;
  return false;
}
#endif

// Read wherever they are used on GPUs, rather than kept in registers.
#if MEDIA
MediumRecord mediumAt(int index) { return media[index + int(hiddenZero())]; }
#endif
#if HETEROGENEOUS
DensityRecord gridOf(MediumRecord medium) { return densityRecords[medium.grid + int(hiddenZero())]; }
#endif

#if MEDIA
const uint kMostTries = 256u;  // tentative collisions of a straight line through a grid

vec3 mediumTransmittance(MediumRecord medium, vec3 origin, vec3 direction, float distance, inout uvec4 words) {
  vec3 through = vec3(1.0);
#if HETEROGENEOUS
  if (medium.grid >= 0) {
    // Ratio tracking [Novak2014]: each tentative collision multiplies by the probability of a null collision. Roulette
    // starts below a tenth. A bound far above the density causes endless null collisions, so after a maximum number the
    // rest of the way is integrated cell by cell. That keeps the mean unbiased: at every collision, the estimate so far
    // times the transmittance of the rest has the transmittance of the whole way as its mean.
    DensityMarch march;
    float bound = 0.0, t = 0.0;
    uint tries = 0u;
    bool goesOn = densityMarchStart(gridOf(medium), origin, direction, distance, march);
    int left = densityMostBlocks(gridOf(medium));
    for (; left > 0 && goesOn && densityMarchNext(gridOf(medium), march, bound); --left) {  // ends: as many as blocks
      ++loopIterations;
      float rate = medium.majorant * bound;
      if (!(rate > 0.0)) continue;
      t = march.near;
      for (uint step = 0u; step <= kMostTries; ++step) {
        ++loopIterations;
        goesOn = ++tries <= kMostTries;
        if (!goesOn) break;
        words = pcg4d(words);
        t += exponentialSample(words.x) / rate;
        if (t >= march.far) break;
        float d = densityAt(gridOf(medium), march.origin + t * march.direction);
        through *= max(1.0 - medium.extinction * (d / rate), vec3(0.0));
        float largest = max(through.r, max(through.g, through.b));
        if (largest < 0.1) {
          goesOn = unitFloat(words.y) < 10.0 * largest;
          if (!goesOn) break;
          through /= 10.0 * largest;
        }
      }
    }
    if (tries > kMostTries) {
      float rest = densityIntegral(gridOf(medium), march.origin, march.direction, t, march.last);
      through *= exp(-medium.extinction * rest);
    } else if (!goesOn && tries > 0u) {
      through = vec3(0.0);
    }
  } else
#endif
  {
    through = exp(-medium.extinction * min(distance, kFar));
  }
  return through;
}
#endif

// Handles a shadow ray's hit. Index-matched boundaries are crossed; a refracting one blocks the light, since the
// straight line is no light path then. True: the ray continues behind it. Otherwise the remaining shadow.light arrives.
bool crossShadow(Hit hit) {
  int rank = -1;
  bool front = false;
  if (hit.triangle != kNoHit) {
    rank = rankOf(hit.triangle);
    front = facesAgainst(hit.triangle, shadow.direction);
    if (rank < 0 || shadow.crossed >= 255u) {
      shadow.light = vec3(0.0);
      return false;
    }
  }
#if MEDIA && !UNATTENUATED_SHADOW_RAYS  // [VPT2024, 4.1] only tests whether a point is in shadow
  int medium = mediumInside(shadow.inside);
  if (medium >= 0) {
    float unit = shadow.infinite ? 1.0 : length(shadow.direction),
          far = hit.triangle == kNoHit ? (shadow.infinite ? kFar : 1.0) : hit.t;
    uvec4 words = shadow.words;
    vec3 through = mediumTransmittance(mediumOf(medium), shadow.origin + shadow.from * shadow.direction,
                                       shadow.direction / unit, (far - shadow.from) * unit, words);
#if HETEROGENEOUS
    forgetAddresses();
    takeShadow();
#endif
    shadow.words = words;
    shadow.light *= through;
  }
#endif
  if (hit.triangle == kNoHit || all(equal(shadow.light, vec3(0.0)))) return false;
  crossBoundary(shadow.inside, rank, front);
  ++shadow.crossed;
  shadow.tMin = shadow.from = hit.t;
  shadow.skip = hit.triangle;
  return true;
}

// Whether a shadow ray that has crossed a boundary is still in the refractive index it started in.
bool shadowGoesOn() {
#if !STRAIGHT_SHADOW_RAYS
  if (iorInside(shadow.inside) != shadow.ior) shadow.light = vec3(0.0);
#endif
  return any(greaterThan(shadow.light, vec3(0.0)));
}

#if MEDIA
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
bool survivesTurn(inout Path path, float u) {
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
// Whether the lamp selected by `words` is a point light: its 1/r^2 sampled at collisions alone would have infinite
// variance.
bool isPointLike(uvec4 words) {
  uint i = scaledWord(words.x, uint(lights.length()));
  if (unitFloat(words.y) >= lights[i].threshold) i = lights[i].alias;
  return lights[i].kind == PATH_LIGHT_POINT || lights[i].kind == PATH_LIGHT_SPOT;
}

// Light from a point lamp, scattered once on a flight of length `s` from the path's origin. The scattering position is
// drawn in proportion to 1 / r^2 [KullaFajardo2012], on the flight rather than on the whole ray: the probability of
// flying that far is the transmittance, except for the channels' differences.
void addPointLight(inout Path path, MediumRecord medium, vec3 q, float s, PathNumbers numbers) {
  uvec4 words = randomWords(numbers, path.event, kPurposePick);
  if (!counts(path.scatterings + 1u) || all(equal(medium.albedo, vec3(0.0))) || !isPointLike(words)) return;
  LightSample light = LightSample(vec3(0.0), 0.0, vec3(0.0), vec3(0.0), false);
  vec2 xi = randomPair(numbers, path.event, kPurposeLight);
  if (!sampleLight(path.origin, xi, words, light)) {
    // A spot may not light the origin; its position is needed all the same.
    uint i = scaledWord(words.x, uint(lights.length()));
    if (unitFloat(words.y) >= lights[i].threshold) i = lights[i].alias;
    light.end = lights[i].a;
  }
  vec3 to = light.end - path.origin;
  float a = -dot(to, path.direction);
  vec3 beside = to + a * path.direction;
  float h = max(length(beside), max(1e-4 * min(s, length(to)), 1e-30)), b = a + s;
  float angle = angleOf((b - a) * h, h * h + a * b);
  if (!(angle > 0.0)) return;
  float sine = sin(xi.x * angle), cosine = cos(xi.x * angle);
  float x = clamp(sine * (h * h + a * a) / (h * cosine - a * sine), 0.0, s);
  float density = h / (angle * (h * h + (x + a) * (x + a)));
  vec3 place = path.origin + x * path.direction;
  if (!sampleLight(place, xi, words, light)) return;
  vec3 contribution = medium.albedo * medium.extinction * passageWeight(medium, q, x) *
                      phaseValue(medium, path.direction, light.direction) * light.value / density;
  if (any(greaterThan(contribution, vec3(0.0))))
    queueShadowRay(path, contribution, place, light, kNoHit, numbers);
}
#endif

#if NEXT_EVENT
// A new direction, drawn from the phase function or, occasionally, towards the lamp that the next flight samples. A
// flight that passes the lamp at a distance h finds light in proportion to 1/h; with directions from the phase function
// alone this has infinite variance. Drawing the angle to the lamp uniformly gives a density proportional to 1/h. The
// farther the lamp, the less often: the flight would rarely get there, and each such choice makes the path's weight a
// little more uneven.
void seekLamp(inout Path path, MediumRecord medium, vec3 before, vec3 q, PathNumbers numbers, inout vec3 weight) {
  uvec4 words = randomWords(numbers, path.event, kPurposePick), choice = randomWords(numbers, path.event, kPurposeSeek);
  uint i = scaledWord(words.x, uint(lights.length()));
  if (unitFloat(words.y) >= lights[i].threshold) i = lights[i].alias;
  vec3 to = lights[i].a - path.origin;
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

// At a collision: light from a lamp if `asks`, then a new direction from the phase function.
int scatterInMedium(inout Path path, MediumRecord medium, PathNumbers numbers, bool asks) {
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
#if DISTANCE_WITHOUT_PDF || BOOSTED_INTERACTION
  const bool asked = false;
#else
  // a point light was already sampled on the way here
  bool asked = asks && medium.grid < 0 && isPointLike(randomWords(numbers, path.event, kPurposePick));
#endif
  if (counts(path.scatterings) && asks && !asked &&
      sampleLight(path.origin, randomPair(numbers, path.event, kPurposeLight),
                  randomWords(numbers, path.event, kPurposePick), light)) {
    vec3 phase = phaseValue(medium, path.direction, light.direction);
    vec3 contribution = phase * light.value;
#if MIS
    if (light.pdf > 0.0) contribution *= powerHeuristic(light.pdf, dot(channelProbabilities(path.throughput), phase));
#endif
    if (any(greaterThan(contribution, vec3(0.0))))
      queueShadowRay(path, contribution, path.origin, light, kNoHit, numbers);
  }
#endif
#if !SCATTERED_LIGHT && !NEXT_EVENT
  return kEnded;
#endif
  uvec2 choice = randomWordPair(numbers, path.event, kPurposeMediumChoice);
  vec3 weight, before = path.direction, q = channelProbabilities(path.throughput);
  path.direction = phaseSample(medium, before, q, unitFloat(choice.x), randomPair(numbers, path.event, kPurposePhase),
                               weight, path.pdf);
#if NEXT_EVENT && (POINTS || SPOTS)
  if (asked) seekLamp(path, medium, before, q, numbers, weight);
#endif
  // Roulette by the path's value, not by the weight of a direction towards a lamp: that weight is small where the
  // flight finds much light.
  if (!survives(path, unitFloat(choice.y))) return kEnded;
  path.throughput *= weight;
  return kScattered;
}

#if HETEROGENEOUS
const uint kMostTracked = 64u;  // tentative collisions of a flight before it is interrupted

// Delta tracking over the free part of the ray. After a number of tentative collisions the flight is interrupted and
// continues with the next ray: exponential flights have no memory, and no submission is held up.
int trackDensity(inout Path path, MediumRecord medium, float distance, PathNumbers numbers, out bool collided) {
  collided = false;
  DensityMarch march;
  uvec4 words = randomWords(numbers, path.event, kPurposeFlight);
  float bound = 0.0, t = 0.0;
  uint tries = 0u;
  bool goesOn = densityMarchStart(gridOf(medium), path.origin, path.direction, distance, march);
  int left = densityMostBlocks(gridOf(medium));
  for (; left > 0 && goesOn && densityMarchNext(gridOf(medium), march, bound); --left) {  // ends: as many as blocks
    ++loopIterations;
    float rate = medium.majorant * bound;
    if (!(rate > 0.0)) continue;
    t = march.near;
    for (uint step = 0u; step < kMostTracked; ++step) {
      ++loopIterations;
      words = pcg4d(words);
      t += exponentialSample(words.x) / rate;
      if (t >= march.far) break;
      float density = densityAt(gridOf(medium), march.origin + t * march.direction);
      vec3 share = min(medium.extinction * (density / rate), vec3(1.0));
      vec3 q = channelProbabilities(path.throughput);
      float real = dot(q, share);
#if VOLUME_EMISSION
      if (counts(path.scatterings)) {
        vec3 emitted = medium.emission * (density / rate);
        addLight(path, emitted);
#if ASKED
        noteLight(path, numbers, lightOf(path, emitted), PATH_ASKED_MEDIUM, 0u, path.origin,
                  path.origin + t * path.direction, false);
#endif
      }
#endif
      collided = unitFloat(words.y) < real;
      if (medium.greyExtinction != 0)
        path.throughput *= collided ? medium.albedo : vec3(1.0);
      else
        path.throughput *= collided ? medium.albedo * share / real : (1.0 - share) / (1.0 - real);
      goesOn = !collided && ++tries < kMostTracked;
      if (!goesOn) break;
    }
  }
  vec3 throughput = path.throughput;
  forgetAddresses();
  take(path);
  path.throughput = throughput;
  bool arrives = !collided && tries < kMostTracked;
  if (!arrives) path.origin += t * path.direction;
  if (!arrives && !collided) {
    path.travelled += t;
    path.head = 0.0;
    ++path.event;
  }
  return arrives ? kFlightArrives : kScattered;
}
#endif

#if DISTANCE_WITHOUT_PDF || BOOSTED_INTERACTION
// Probability of an interaction [VPT2024, algorithm 4]: the largest albedo, which the published text raises to at least
// a half.
float interactionProbability(MediumRecord medium) {
  float w = max(medium.albedo.r, max(medium.albedo.g, medium.albedo.b));
#if BOOSTED_INTERACTION
  if (w > 0.0) w = max(w, 0.5);
#endif
  return w;
}
#endif

// How far the ray may go before it collides; negative if the collision lies before its origin. With a density grid the
// distance is found once the ray's end is known.
float beginFlight(Path path, MediumRecord medium, PathNumbers numbers) {
  if (medium.grid >= 0) return kFar;
  uvec2 words = randomWordPair(numbers, path.event, kPurposeFlight);
#if DISTANCE_WITHOUT_PDF
  // [VPT2024, algorithm 4]: with the smallest extinction, and only with the probability of an interaction.
  float least = min(medium.extinction.r, min(medium.extinction.g, medium.extinction.b));
  if (unitFloat(words.y) >= interactionProbability(medium) || !(least > 0.0)) return kFar;
  return max(min(exponentialSample(words.x) / least, kFar) - path.head, 0.0);
#endif
  return flightDistance(medium, pickChannel(channelProbabilities(path.throughput), unitFloat(words.y)), words.x) -
         path.head;
}

// How far beyond a collision to look for a surface. If one is this near, the next ray might miss it by the rounding
// error of its distance, which is that of the triangles' coordinates. Collisions keep this distance from surfaces, also
// at grazing angles.
float flightMargin() { return sceneMagnitude() * kBeside * 64.0; }

// Contribution of a flight of the given length, and its effect on the throughput.
void weighFlight(inout Path path, MediumRecord medium, vec3 q, float distance, bool arrives, PathNumbers numbers) {
#if VOLUME_EMISSION
  if (counts(path.scatterings) && distance < 0.5 * kFar) {
    // Emission along the flight, estimated at one point of it. Where collisions are rare this has hardly any noise.
    float x = distance * unitFloat(randomWords(numbers, path.event, kPurposeFlight).z);
    vec3 emitted = distance * medium.emission * passageWeight(medium, q, x);
    addLight(path, emitted);
#if ASKED
    noteLight(path, numbers, lightOf(path, emitted), PATH_ASKED_MEDIUM, 0u, path.origin,
              path.origin + x * path.direction, false);
#endif
  }
#endif
#if DISTANCE_WITHOUT_PDF
  path.throughput *= exp(-medium.extinction * distance);  // neither the scattering coefficient nor a density
#else
  path.throughput *= arrives ? passageWeight(medium, q, distance) : scatteringWeight(medium, q, distance);
#if BOOSTED_INTERACTION
  float albedo = max(medium.albedo.r, max(medium.albedo.g, medium.albedo.b));
  if (!arrives) path.throughput *= interactionProbability(medium) / max(albedo, 1e-30);  // raised, and not divided out
#endif
#endif
}

#if WALKS
// distances from cell centres to the scene's nearest triangle
layout(binding = 3) uniform samplerBuffer clearances;
const uint kWalkSteps = 64u;

// Moves from collision to collision as long as `flight`, the last one drawn, ends before it could meet any triangle; no
// ray is traced for these. Every random number and every sum is that of a path that traces them all. There is no walk
// where a lamp might be sampled. False: the path ends.
bool walk(inout Path path, MediumRecord medium, inout float flight, PathNumbers numbers) {
  int rank = topRank(path.inside);
  if (rank < 0 || (NEXT_EVENT != 0 && lampsReach(path))) return true;
  InteriorRecord interior = interiors[rank];
  if (interior.clearance < 0) return true;
  ivec3 last = interior.size.xyz - 1;
  float margin = 2.0 * flightMargin();
  if (flight < 0.0) return true;
  for (uint step = 0u; step < kWalkSteps; ++step) {
    ivec3 cell = clampedInt((path.origin - interior.min) / interior.cell, ivec3(0), last);
    float radius =
        texelFetch(clearances, interior.clearance + cell.x + interior.size.x * (cell.y + interior.size.y * cell.z)).x;
    if (!(flight + margin < radius - length(path.origin - interior.min - (vec3(cell) + 0.5) * interior.cell)))
      return true;
    ++loopIterations;
    numbers.pixel += hiddenZero();
    numbers.sampleIndex += hiddenZero();
    weighFlight(path, medium, channelProbabilities(path.throughput), path.head + flight, false, numbers);
    path.origin += flight * path.direction;
    if (scatterInMedium(path, medium, numbers, false) != kScattered) return false;
    flight = beginFlight(path, medium, numbers);
  }
  return true;
}
#endif

bool arrivesAt(Hit hit, float flight) { return hit.triangle != kNoHit ? hit.t <= flight : flight > 0.5 * kFar; }

// Length of the flight before the hit; it includes the gap behind the ray's start.
float flownDistance(Path path, Hit hit, float flight) {
  return max(path.head + (hit.triangle != kNoHit && arrivesAt(hit, flight) ? hit.t : flight), 0.0);
}

// Handles what happens on the way to `hit`, the first hit within `flight`.
int crossMedium(inout Path path, int index, float flight, Hit hit, PathNumbers numbers) {
  vec3 inward = vec3(0.0);
#if HETEROGENEOUS
  if (mediumAt(index).grid >= 0) {
    bool collided;
    int became = trackDensity(path, mediumAt(index), hit.triangle != kNoHit ? hit.t : kFar, numbers, collided);
    if (!collided) return became;
  } else
#endif
  {
    bool arrives = arrivesAt(hit, flight);
    weighFlight(path, mediumAt(index), channelProbabilities(path.throughput), flownDistance(path, hit, flight), arrives,
                numbers);
    if (arrives) return kFlightArrives;
    // Nearer to a face than a gap, the path continues from a gap beside it. The piece of flight along the face's normal
    // that is thereby skipped or repeated is made up for in the next flight, as if it had begun where it should have.
    // This matters where a gap is a sizeable part of a mean free path.
    if (flight < 0.0) {
      vec3 normal = normalOf(path.face);
      inward = -flight * abs(dot(normal, path.direction)) * (dot(normal, path.direction) < 0.0 ? -normal : normal);
    } else {
      path.origin += flight * path.direction;
      if (hit.triangle != kNoHit) {
        Surface near = surfaceAt(hit.triangle, hit.barycentrics, path.direction);
        float depth = (hit.t - flight) * -dot(near.geometricNormal, path.direction);
        if (depth < gapAt(near)) {
          path.origin = beside(near, near.geometricNormal);
          path.face = hit.triangle;
          inward = (gapAt(near) - depth) * near.geometricNormal;
        }
      }
    }
  }
  int became = scatterInMedium(path, mediumAt(index), numbers, lampsReach(path));
#if !FIXED_EPSILON  // published rays have no such correction
  float shift = length(inward);
  if (shift > 0.0) {
    float cosine = dot(inward, path.direction) / shift;
    path.head = shift / (abs(cosine) > 0.01 ? cosine : cosine < 0.0 ? -0.01 : 0.01);
  }
#endif
  return became;
}
#endif
