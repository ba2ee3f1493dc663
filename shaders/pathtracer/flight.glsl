// A path's flight through a medium: how far it goes, what it gathers, and how it continues from its collisions. Include
// crossing.glsl before this file.
//
// Flags: HETEROGENEOUS, VOLUME_EMISSION, WALKS (dense media have clearance grids); deviations DISTANCE_WITHOUT_PDF,
// BOOSTED_INTERACTION.
#include "lib/angle.glsl"
#include "lib/clamped_int.glsl"
#if WALKS
#include "lib/packed_normal.glsl"
#endif
#include "pathtracer/collision.glsl"

const uint kPurposeFlight = kFreePurpose;

#if NEXT_EVENT
// Light from a point lamp, scattered once on a flight of length `s` from the path's origin. The scattering position is
// drawn in proportion to 1 / r^2 [KullaFajardo2012], on the flight rather than on the whole ray: the probability of
// flying that far is the transmittance, except for the channels' differences.
void addPointLight(inout Path path, MediumRecord medium, vec3 q, float s, PathNumbers numbers) {
  uvec4 words = randomWords(numbers, path.event, kPurposePick);
  if (!counts(path.scatterings + 1u) || all(equal(medium.albedo, vec3(0.0)))) return;
  LightPick picked = pickAt(words, path.origin, vec3(0.0));
  if (!isPointLike(picked)) return;
  pickedLight = picked.light;
  LightSample light = LightSample(vec3(0.0), 0.0, vec3(0.0), vec3(0.0), false);
  vec2 xi = randomPair(numbers, path.event, kPurposeLight);
  // A spot may not light the origin; its position is needed all the same.
  if (!samplePicked(picked, path.origin, xi, words, light)) light.end = lights[picked.light].a;
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
  if (!samplePicked(picked, place, xi, words, light)) return;
  vec3 contribution = medium.albedo * medium.extinction * passageWeight(medium, q, x) *
                      phaseValue(medium, path.direction, light.direction) * light.value / density;
  if (any(greaterThan(contribution, vec3(0.0))))
    queueShadowRay(path, contribution, place, light, kNoHit, 0.0, numbers);
}
#endif

#if SPLITS_FLIGHTS
const float kRarelyBelow = 0.125;  // a part with a smaller share of the light is followed now and then

float sumOf(vec3 v) { return v.x + v.y + v.z; }

// Whether both outcomes of a flight are followed, one after the other: forced collisions [SpanierGelbard1969], for
// camera rays alone. Nothing may have been added by then, since the path's way up to here is traced twice.
bool splitsFlight(Path path, MediumRecord medium) {
  bool isFirst = (path.part == kWhole && all(equal(radianceOf(path), vec3(0.0)))) || path.part == kSecond;
#if NEXT_EVENT && (POINTS || SPOTS)
  if (medium.grid < 0 && lampsReach(path)) return false;  // they are sampled along the flight
#endif
  return medium.splits != 0 && isFirst && path.scatterings == 0u;
}

// The part of its sample that a path follows, of light that passes or scatters, by the sums of their throughputs: true
// if that is what scatters. probability: of being followed, by which the part's throughput is divided.
bool followsScattered(inout Path path, float passing, float scattered, float u, out float probability) {
  probability = 1.0;
  if (!(scattered > 0.0)) return false;
  float unit = kRarelyBelow * (passing + scattered);
  float passes = min(passing / unit, 1.0), scatters = min(scattered / unit, 1.0);
  bool isSecond = path.part == kSecond ? u >= 1.0 - scatters : u >= passes;
  if (u < passes && u >= 1.0 - scatters) path.part = path.part == kSecond ? kLast : kFirst;
  probability = isSecond ? scatters : passes;
  return isSecond;
}

// Both outcomes of a flight in a homogeneous medium, up to a distance. True: it arrives; else the length of the flight.
bool splitFlight(inout Path path, MediumRecord medium, float distance, PathNumbers numbers, out float flown) {
  vec3 reach = vec3(oneMinusExp(medium.extinction.r * distance), oneMinusExp(medium.extinction.g * distance),
                    oneMinusExp(medium.extinction.b * distance));
  vec3 scattered = path.throughput * medium.albedo * reach, passing = path.throughput * (1.0 - reach);
  float probability, sum = sumOf(scattered);
  flown = distance;
  if (!followsScattered(path, sumOf(passing), sum, unitFloat(randomWords(numbers, path.event, kPurposeFlight).w),
                        probability)) {
    path.throughput = passing / probability;
    return true;
  }
  uvec2 words = randomWordPair(numbers, path.event, kPurposeFlight);
  vec3 q = scattered / sum;
  int channel = pickChannel(q, unitFloat(words.y));
  flown = negativeLog1m(unitFloat(words.x) * reach[channel]) / medium.extinction[channel];
  vec3 density = medium.extinction * exp(-medium.extinction * flown);
  vec3 given = mix(vec3(0.0), density / reach, greaterThan(q, vec3(0.0)));
  path.throughput *= medium.albedo * density / (dot(q, given) * probability);
  return false;
}
#endif

#if HETEROGENEOUS
const uint kMostTracked = 64u;  // tentative collisions of a flight before it is interrupted

#if SPLITS_FLIGHTS
// After so many tentative collisions, or once a tenth of the light is left, chance decides.
const uint kMostSplit = 48u;
const float kLeastSplit = 0.3;  // of the three channels together
const float kSplitPlaces = 4.0;  // tentative collisions on a way through the whole grid, at least

// Both outcomes of a flight in a grid: every tentative collision scatters its share of the light that still passes. One
// of them is kept, in proportion to the light that it scatters, by a random number that each choice uses up in part.
struct Split {
  vec3 scattered;  // throughput of what is scattered, for a sum of 1
  float sum;       // of that throughput
  float place;     // where, along the ray
  float random;
};

void considerCollision(inout Split split, vec3 scattered, float t) {
  float sum = sumOf(scattered);
  if (!(sum > 0.0)) return;
  split.sum += sum;
  float share = sum / split.sum;
  bool isKept = split.random < share;
  split.random = isKept ? split.random / share : (split.random - share) / (1.0 - share);
  if (isKept) {
    split.scattered = scattered / sum;
    split.place = t;
  }
}

// The part that the path follows: true if that is what scatters, at t. collided: by chance, at t, in the end.
bool choosePart(inout Path path, inout Split split, bool collided, float u, inout float t) {
  if (collided) {
    considerCollision(split, path.throughput, t);
    path.throughput = vec3(0.0);
  }
  float probability;
  bool scatters = followsScattered(path, sumOf(path.throughput), split.sum, u, probability);
  path.throughput = (scatters ? split.sum * split.scattered : path.throughput) / probability;
  if (scatters) t = split.place;
  return scatters;
}
#endif

// Delta tracking over the free part of the ray. After a number of tentative collisions the flight is interrupted and
// continues with the next ray: exponential flights have no memory, and no submission is held up.
int trackDensity(inout Path path, MediumRecord medium, float distance, PathNumbers numbers, out bool collided) {
  collided = false;
  DensityMarch march;
  uvec4 words = randomWords(numbers, path.event, kPurposeFlight);
  float bound = 0.0, t = 0.0;
  uint tries = 0u;
  // from the surface that the ray left
  float head = path.head;
  bool goesOn = densityMarchStart(gridOf(medium), path.origin - head * path.direction, path.direction,
                                  distance + head, march);
#if SPLITS_FLIGHTS
  bool splits = splitsFlight(path, medium);
  Split split = Split(vec3(0.0), 0.0, 0.0, unitFloat(words.z));
  float leastRate = splits ? kSplitPlaces / max(march.last - march.near, 1e-30) : 0.0;
#endif
  int left = densityMostBlocks(gridOf(medium));
  for (; left > 0 && goesOn && densityMarchNext(gridOf(medium), march, bound); --left) {  // ends: as many as blocks
    ++loopIterations;
    float rate = medium.majorant * bound;
    if (!(rate > 0.0)) continue;
#if SPLITS_FLIGHTS
    rate = max(rate, leastRate);
#endif
    t = march.near;
    for (uint step = 0u; step < kMostTracked; ++step) {
      ++loopIterations;
      words = pcg4d(words);
      t += exponentialSample(words.x) / rate;
      if (t >= march.far) break;
      float density = densityAt(gridOf(medium), march.origin + t * march.direction);
      vec3 share = min(medium.extinction * (density / rate), vec3(1.0));
      vec3 q = channelProbabilities(path.throughput);
      float real = dot(q, min(medium.rate * (density / rate), vec3(1.0)));
#if VOLUME_EMISSION
      if (counts(path.scatterings)) {
        vec3 emitted = medium.emission * (density / rate);
        addLight(path, emitted);
#if INSPECTED
        noteLight(path, numbers, lightOf(path, emitted), PATH_INSPECTED_MEDIUM, 0u, path.origin,
                  path.origin + (t - head) * path.direction, false);
#endif
      }
#endif
#if SPLITS_FLIGHTS
      if (splits && tries < kMostSplit && sumOf(path.throughput) > kLeastSplit) {
        considerCollision(split, path.throughput * medium.albedo * share, t);
        path.throughput *= 1.0 - share;
        ++tries;
        continue;
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
#if SPLITS_FLIGHTS
  if (splits) collided = choosePart(path, split, collided, unitFloat(words.w), t);
  uint part = path.part;
#endif
  vec3 throughput = path.throughput;
  forgetAddresses();
  reload(path);
  path.throughput = throughput;
#if SPLITS_FLIGHTS
  path.part = part;
#endif
  bool arrives = !collided && tries < kMostTracked;
  if (!arrives) path.origin += (t - head) * path.direction;
  if (!arrives && !collided) {
    path.travelled += t - head;
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
#if SPLITS_FLIGHTS
  if (splitsFlight(path, medium)) return kFar;
#endif
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
#if INSPECTED
    noteLight(path, numbers, lightOf(path, emitted), PATH_INSPECTED_MEDIUM, 0u, path.origin,
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
// Per cell: a packed normal, and bits of the floats depth, reach and radius (clearance.hpp).
layout(binding = 3) uniform usamplerBuffer clearances;

uvec4 clearanceAt(InteriorRecord interior, vec3 position, out vec3 fromCentre) {
  ivec3 cell = clampedInt((position - interior.min) / interior.cell, ivec3(0), interior.size.xyz - 1);
  fromCentre = position - interior.min - (vec3(cell) + 0.5) * interior.cell;
  return texelFetch(clearances, interior.clearance + cell.x + interior.size.x * (cell.y + interior.size.y * cell.z));
}

// A distance within which no triangle is near a position.
float clearanceRadius(InteriorRecord interior, vec3 position) {
  vec3 fromCentre;
  uvec4 clearance = clearanceAt(interior, position, fromCentre);
  return uintBitsToFloat(clearance.w) - length(fromCentre);
}

// Whether a flight can meet no triangle, and ends where none is near.
bool isFree(InteriorRecord interior, vec3 position, vec3 direction, float flight) {
  vec3 from;
  uvec4 clearance = clearanceAt(interior, position, from);
  float margin = 2.0 * flightMargin(), distance = flight + margin, way = length(from) + distance;
  if (way < uintBitsToFloat(clearance.w)) return true;
  vec3 normal = unpackNormal(clearance.x);
  float height = dot(normal, from);
  return way < uintBitsToFloat(clearance.z) &&
         max(height, height + distance * dot(normal, direction)) + margin < uintBitsToFloat(clearance.y);
}
#endif

// The probability with which lamps are sought by manifold.comp from a collision: deep inside of a dense body hardly any
// of their light is left, and the search costs far more than a collision. Optical depths up to kShallow are certain.
float seekingProbability(Path path, MediumRecord medium) {
#if MANIFOLDS && WALKS
  const float kShallow = 2.0;
  int rank = topRank(path.inside);
  if (rank >= 0 && interiors[rank].clearance >= 0) {
    InteriorRecord interior = interiors[rank];
    float least = max(clearanceRadius(interior, path.origin), 0.0);
    return min(exp(kShallow - least * min(medium.extinction.r, min(medium.extinction.g, medium.extinction.b))), 1.0);
  }
#endif
  return 1.0;
}

#if WALKING
// Whether a path may walk (walk.comp): only where its flight can meet no triangle, and not where a lamp might be
// sampled, or is sought at the flight's end. A flight that begins behind its origin is traced.
bool mayWalk(InteriorRecord interior, MediumRecord medium, Path path, float flight, PathNumbers numbers) {
  if (flight < 0.0 || !isFree(interior, path.origin, path.direction, flight)) return false;
#if MANIFOLDS
  path.origin += flight * path.direction;
  ++path.event;
  ++path.scatterings;
  return !seeksWay(path, seekingProbability(path, medium), numbers);
#else
  return true;
#endif
}

// From path.comp.
bool mayWalk(Path path, float flight, PathNumbers numbers) {
  int rank = topRank(path.inside);
  if (rank < 0 || interiors[rank].clearance < 0 || (NEXT_EVENT != 0 && lampsReach(path))) return false;
  InteriorRecord interior = interiors[rank];
  return mayWalk(interior, mediumOf(interior.medium), path, flight, numbers);
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
    float flown = flownDistance(path, hit, flight);
#if SPLITS_FLIGHTS
    if (splitsFlight(path, mediumAt(index))) {
      arrives = splitFlight(path, mediumAt(index), flown, numbers, flown);
      flight = flown - path.head;
    } else
#endif
      weighFlight(path, mediumAt(index), channelProbabilities(path.throughput), flown, arrives, numbers);
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
#if FIXED_EPSILON
  inward = vec3(0.0);  // published rays have no such correction
#endif
  int became = scatterInMedium(path, mediumAt(index), inward, numbers, lampsReach(path),
                                seekingProbability(path, mediumAt(index)));
  path.head = headOf(inward, path.direction);
  return became;
}
