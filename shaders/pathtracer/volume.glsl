// A path through participating media: how far it flies, what it adds and where it goes on from a collision; and how
// much light a straight line lets through. The lights, path.glsl and shadow_ray.glsl stand before this file.
//
// Flags: INTERIORS (closed boundaries: paths count what they are inside of), MEDIA, HETEROGENEOUS, VOLUME_EMISSION,
// LAMPS_OUTSIDE (no lamp is within a dielectric), WALKS (dense media have clearance grids); deviations
// DISTANCE_WITHOUT_PDF, BOOSTED_INTERACTION, ROULETTE_WITHOUT_DIVISION, ROULETTE_AT_SURFACES, STRAIGHT_SHADOW_RAYS,
// UNATTENUATED_SHADOW_RAYS.
#include "pathtracer/boundary.glsl"
#if MEDIA
#include "pathtracer/media.glsl"
layout(std430, binding = 6) restrict readonly buffer MediumBlock { MediumRecord media[]; };
#endif
#if HETEROGENEOUS
#include "pathtracer/density.glsl"
#endif

const uint kPurposeFlight = kFreePurpose;
const uint kPurposePhase = kFreePurpose + 1u;
const uint kPurposeMediumChoice = kFreePurpose + 2u;
const uint kPurposeSeek = kFreePurpose + 4u;

// What becomes of a ray in a medium.
const int kFlightArrives = 0;    // at what the ray was traced to
const int kScattered = 1;  // or is in the midst of a long flight: goes on with a ray of its own
const int kEnded = 2;

int rankOf(uint triangle) { return int(materials[triangleData[triangle * TRIANGLE_WORDS].w].boundary); }

vec3 normalOf(uint triangle) {
  uint first = triangle * TRIANGLE_WORDS;
  return uintBitsToFloat(uvec3(triangleData[first + 1u].w, triangleData[first + 2u].w, triangleData[first + 3u].x));
}

// Whether a ray comes from the triangle's front.
bool facesAgainst(uint triangle, vec3 direction) { return dot(normalOf(triangle), direction) < 0.0; }

#if TOUCHING
// Crosses what lies within a gap of a surface, where rounding matters: `beyond` is what rays start in that go on behind
// the surface, `before` in front of it. Faces that coincide with the surface may be met in any order, up to half a gap
// before it too, so that the counts decide: a boundary can be entered where the path is outside of it and left where it
// is inside. A short ray looks for them, hit after hit.
struct Besides {
  uvec4 beyond, before;
  float tMin;
  uint skip;
  uint crossed;
};
const uint kMostBesides = 8u;

// ahead: a gap long, to behind the surface.
Ray besidesRay(Besides b, vec3 position, vec3 ahead) { return Ray(position - ahead, b.tMin, 2.0 * ahead, 1.0); }

// What the short ray has hit. False: there is nothing more, but perhaps the first surface there that bounds nothing,
// then in `hit`, else kNoHit.
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

#if MEDIA
const uint kMostTries = 256u;  // tentative collisions of a straight line through a grid

vec3 mediumTransmittance(MediumRecord medium, vec3 origin, vec3 direction, float distance, inout uvec4 words) {
#if HETEROGENEOUS
  if (medium.grid >= 0) {
    // Ratio tracking [Novak2014]: at each tentative collision what is null of it. Roulette from a tenth on. Where a
    // bound lies far above the density there is no end of null collisions: after some the rest of the way is
    // integrated, cell by cell. That leaves the mean as it is, as what is found up to a collision, times the
    // transmittance from there on, has the whole way's for its mean at every collision.
    DensityRecord g = densityRecords[medium.grid];
    DensityMarch march;
    vec3 through = vec3(1.0);
    float bound;
    uint tries = 0u;
    if (!densityMarchStart(g, origin, direction, distance, march)) return through;
    while (densityMarchNext(g, march, bound)) {
      ++loopTurns;
      float rate = medium.majorant * bound;
      if (!(rate > 0.0)) continue;
      float t = march.near;
      for (;;) {
        ++loopTurns;
        if (++tries > kMostTries)
          return through * exp(-medium.extinction * densityIntegral(g, march.origin, march.direction, t, march.last));
        words = pcg4d(words);
        t += exponentialSample(words.x) / rate;
        if (t >= march.far) break;
        float d = densityAt(g, march.origin + t * march.direction);
        through *= max(1.0 - medium.extinction * (d / rate), vec3(0.0));
        float largest = max(through.r, max(through.g, through.b));
        if (largest < 0.1) {
          if (unitFloat(words.y) >= 10.0 * largest) return vec3(0.0);
          through /= 10.0 * largest;
        }
      }
    }
    return through;
  }
#endif
  return exp(-medium.extinction * min(distance, kFar));
}
#endif

// What a shadow ray has hit. Index-matched boundaries are crossed; one that refracts stops the light, since the
// straight line is no path of light then. True: it goes on behind. Else what is left of shadow.light arrives.
bool crossShadow(Hit hit) {
  int rank = -1;
  bool front = false;
  if (hit.triangle != kNoHit) {
    rank = rankOf(hit.triangle);
    front = facesAgainst(hit.triangle, shadow.direction);
    if (rank < 0 || ++shadow.crossed >= 256u) {
      shadow.light = vec3(0.0);
      return false;
    }
  }
#if MEDIA && !UNATTENUATED_SHADOW_RAYS  // [VPT2024, 4.1] decides only whether a point is in shadow
  int medium = mediumInside(shadow.inside);
  if (medium >= 0) {
    float unit = shadow.infinite ? 1.0 : length(shadow.direction),
          far = hit.triangle == kNoHit ? (shadow.infinite ? kFar : 1.0) : hit.t;
    shadow.light *= mediumTransmittance(media[medium], shadow.origin + shadow.from * shadow.direction,
                                        shadow.direction / unit, (far - shadow.from) * unit, shadow.words);
  }
#endif
  if (hit.triangle == kNoHit || all(equal(shadow.light, vec3(0.0)))) return false;
  crossBoundary(shadow.inside, rank, front);
  shadow.tMin = shadow.from = hit.t;
  shadow.skip = hit.triangle;
  return true;
}

// Whether a shadow ray that has crossed a boundary still is in the index that it began in.
bool shadowGoesOn() {
#if !STRAIGHT_SHADOW_RAYS
  if (iorInside(shadow.inside) != shadow.ior) shadow.light = vec3(0.0);
#endif
  return any(greaterThan(shadow.light, vec3(0.0)));
}

#if MEDIA
// The largest coordinate of any triangle: in the header of the ray caster's triangles.
float sceneMagnitude() { return uintBitsToFloat(texelFetch(bvhTriangles, 0).x); }

// A path that left a closed boundary through a crack would be in its medium for ever: outside of all coordinates it
// has.
bool leaked(Path path) {
  vec3 a = abs(path.origin);
  return any(greaterThan(path.inside, uvec4(0u))) && max(a.x, max(a.y, a.z)) > sceneMagnitude() * 1.001;
}

#if ROULETTE_AT_SURFACES
// Roulette once a turn of the published loop [VPT2024, algorithm 3]; which turn is the first (rrStart) the text does
// not say: all are. False: the path ends.
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

// Roulette by the throughput alone: a limit by depth would darken milk. False: the path ends.
bool survives(inout Path path, float u) {
  float largest = max(path.throughput.r, max(path.throughput.g, path.throughput.b));
#if ROULETTE_WITHOUT_DIVISION && !ROULETTE_AT_SURFACES
  return u < min(largest, 0.95);
#else
#if ROULETTE_AT_SURFACES
  float survival = 1.0;  // [VPT2024, algorithm 3] plays it once traceMedium as a whole is done
#else
  float survival = min(largest / kRouletteBelow, 1.0);
#endif
  // In an endless medium without absorption nothing else ends a path. Rare enough that a path across a slab of optical
  // depth 1000 (slowest mode: 3.3e-6 per collision) is seldom lost: if weights grew faster than half of that, late
  // arrivals would have infinite variance.
  if (path.event > (1u << 20)) survival = min(survival, 1.0 - exp2(-20.0));
  if (!(u < survival)) return false;
  path.throughput /= survival;
  return true;
#endif
}

#if NEXT_EVENT
// Whether the lamp that `words` pick has a place, but no size: one whose 1/r^2 collisions alone would sample with
// infinite variance.
bool isPointLike(uvec4 words) {
  uint i = scaledWord(words.x, uint(lights.length()));
  if (unitFloat(words.y) >= lights[i].threshold) i = lights[i].alias;
  return lights[i].kind == PATH_LIGHT_POINT || lights[i].kind == PATH_LIGHT_SPOT;
}

// Light from such a lamp, scattered once on a flight of length `s` from the path's origin. The place is drawn in
// proportion to 1 / r^2 [KullaFajardo2012], on the flight rather than on the whole ray: that it comes so far is the
// transmittance, but for the channels' differences.
void addPointLight(inout Path path, MediumRecord medium, vec3 q, float s, PathNumbers numbers) {
  uvec4 words = randomWords(numbers, path.event, kPurposePick);
  if (!counts(path.scatterings + 1u) || all(equal(medium.albedo, vec3(0.0))) || !isPointLike(words)) return;
  LightSample light;
  vec2 xi = randomPair(numbers, path.event, kPurposeLight);
  if (!sampleLight(path.origin, xi, words, light)) {
    // A spot may not light the origin: its place is asked for all the same.
    uint i = scaledWord(words.x, uint(lights.length()));
    if (unitFloat(words.y) >= lights[i].threshold) i = lights[i].alias;
    light.end = lights[i].a;
  }
  vec3 to = light.end - path.origin;
  float a = -dot(to, path.direction);
  vec3 beside = to + a * path.direction;
  float h = max(length(beside), max(1e-4 * min(s, length(to)), 1e-30)), b = a + s;
  float angle = atan((b - a) * h, h * h + a * b);
  if (!(angle > 0.0)) return;
  float sine = sin(xi.x * angle), cosine = cos(xi.x * angle);
  float x = clamp(sine * (h * h + a * a) / (h * cosine - a * sine), 0.0, s);
  float density = h / (angle * (h * h + (x + a) * (x + a)));
  vec3 place = path.origin + x * path.direction;
  if (!sampleLight(place, xi, words, light)) return;
  vec3 contribution = medium.albedo * medium.extinction * passageWeight(medium, q, x) *
                      phaseValue(medium, path.direction, light.direction) * light.value / density;
  if (any(greaterThan(contribution, vec3(0.0))))
    askLight(path, contribution, place, light, kNoHit, numbers);
}
#endif

#if NEXT_EVENT
// A new direction, drawn from the phase function, and now and then instead towards the lamp that the next flight asks.
// A flight that passes the lamp at a distance h finds light in proportion to 1/h; by directions of the phase function
// alone that has an infinite variance. Angles to the lamp drawn uniformly have a density in proportion to 1/h
// themselves. The farther the lamp the more seldom, as the flight would hardly get there, and since each such choice
// makes the path's weight a little more uneven.
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

// Whether a straight line from where the path is may reach a lamp at all: with all lamps outside, not from within
// anything that refracts.
bool lampsReach(Path path) {
#if LAMPS_OUTSIDE
  return path.ior == 1.0;
#else
  return true;
#endif
}

// At a collision: light from a lamp where `asks`, then on in a direction of the phase function.
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
  LightSample light;
#if DISTANCE_WITHOUT_PDF || BOOSTED_INTERACTION
  const bool asked = false;
#else
  // it has been, on the way here
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
      askLight(path, contribution, path.origin, light, kNoHit, numbers);
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
  // Roulette by what the path is worth, not by the weight of a direction that seeks a lamp: that is small where the
  // flight finds much.
  if (!survives(path, unitFloat(choice.y))) return kEnded;
  path.throughput *= weight;
  return kScattered;
}

#if HETEROGENEOUS
// Delta tracking over the part of the ray that is free. After some tentative collisions the flight is broken off where
// it is and goes on with the next ray: exponential flights have no memory, and no submission is held up.
int trackDensity(inout Path path, MediumRecord medium, float distance, PathNumbers numbers, out bool collided) {
  collided = false;
  DensityRecord g = densityRecords[medium.grid];
  DensityMarch march;
  if (!densityMarchStart(g, path.origin, path.direction, distance, march)) return kFlightArrives;
  uvec4 words = randomWords(numbers, path.event, kPurposeFlight);
  float bound;
  uint tries = 0u;
  while (densityMarchNext(g, march, bound)) {
    ++loopTurns;
    float rate = medium.majorant * bound;
    if (!(rate > 0.0)) continue;
    float t = march.near;
    for (;;) {
      ++loopTurns;
      words = pcg4d(words);
      t += exponentialSample(words.x) / rate;
      if (t >= march.far) break;
      vec3 share = min(medium.extinction * (densityAt(g, march.origin + t * march.direction) / rate), vec3(1.0));
      vec3 q = channelProbabilities(path.throughput);
      float real = dot(q, share);
#if VOLUME_EMISSION
      if (counts(path.scatterings)) {
        vec3 emitted = medium.emission * (densityAt(g, march.origin + t * march.direction) / rate);
        addLight(path, emitted);
#if ASKED
        noteLight(path, numbers, lightOf(path, emitted), PATH_ASKED_MEDIUM, 0u, path.origin,
                  path.origin + t * path.direction, false);
#endif
      }
#endif
      bool collides = unitFloat(words.y) < real;
      if (medium.greyExtinction != 0)
        path.throughput *= collides ? medium.albedo : vec3(1.0);
      else
        path.throughput *= collides ? medium.albedo * share / real : (1.0 - share) / (1.0 - real);
      if (collides || ++tries == 64u) {
        path.origin += t * path.direction;
        if (collides) {
          collided = true;
          return kScattered;
        }
        path.travelled += t;
        path.head = 0.0;
        ++path.event;
        return kScattered;
      }
    }
  }
  return kFlightArrives;
}
#endif

#if DISTANCE_WITHOUT_PDF || BOOSTED_INTERACTION
// Probability of an interaction [VPT2024, algorithm 4]: the largest albedo, of which the published text makes a half at
// least.
float interactionProbability(MediumRecord medium) {
  float w = max(medium.albedo.r, max(medium.albedo.g, medium.albedo.b));
#if BOOSTED_INTERACTION
  if (w > 0.0) w = max(w, 0.5);
#endif
  return w;
}
#endif

// How far the ray may go before it collides, negative where that is before its origin; with a density grid that is told
// once it is known where the ray ends.
float beginFlight(Path path, MediumRecord medium, PathNumbers numbers) {
  if (medium.grid >= 0) return kFar;
  uvec2 words = randomWordPair(numbers, path.event, kPurposeFlight);
#if DISTANCE_WITHOUT_PDF
  // [VPT2024, algorithm 4]: from the least of the extinctions, and only with the probability of an interaction.
  float least = min(medium.extinction.r, min(medium.extinction.g, medium.extinction.b));
  if (unitFloat(words.y) >= interactionProbability(medium) || !(least > 0.0)) return kFar;
  return max(min(exponentialSample(words.x) / least, kFar) - path.head, 0.0);
#endif
  return flightDistance(medium, pickChannel(channelProbabilities(path.throughput), unitFloat(words.y)), words.x) -
         path.head;
}

// How far beyond a collision to look for a surface. Where one is so near, the next ray might miss it by the rounding of
// its distance, which is that of the triangles' coordinates: collisions keep a distance from it, and a ray may meet it
// at a grazing angle.
float flightMargin() { return sceneMagnitude() * kBeside * 64.0; }

// What a flight of that length adds, and leaves of the throughput.
void weighFlight(inout Path path, MediumRecord medium, vec3 q, float distance, bool arrives, PathNumbers numbers) {
#if VOLUME_EMISSION
  if (counts(path.scatterings) && distance < 0.5 * kFar) {
    // By the length of the flight: one point of it stands for all. Where little collides that has hardly any noise.
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
// distances from cells' centres to the nearest triangle of the scene
layout(binding = 3) uniform samplerBuffer clearances;
const uint kWalkSteps = 64u;

// From collision to collision as long as `flight`, the one drawn last, ends before it could meet any triangle: no ray
// is traced for such. Every number drawn and every sum is that of a path that traces them all. Where a lamp might be
// asked there is no walk. False: the path ends.
bool walk(inout Path path, MediumRecord medium, inout float flight, PathNumbers numbers) {
  int rank = topRank(path.inside);
  if (rank < 0 || (NEXT_EVENT != 0 && lampsReach(path))) return true;
  InteriorRecord interior = interiors[rank];
  if (interior.clearance < 0) return true;
  ivec3 last = interior.size.xyz - 1;
  float margin = 2.0 * flightMargin();
  if (flight < 0.0) return true;
  for (uint step = 0u; step < kWalkSteps; ++step) {
    ivec3 cell = clamp(ivec3((path.origin - interior.min) / interior.cell), ivec3(0), last);
    float radius =
        texelFetch(clearances, interior.clearance + cell.x + interior.size.x * (cell.y + interior.size.y * cell.z)).x;
    if (!(flight + margin < radius - length(path.origin - interior.min - (vec3(cell) + 0.5) * interior.cell)))
      return true;
    ++loopTurns;
    weighFlight(path, medium, channelProbabilities(path.throughput), path.head + flight, false, numbers);
    path.origin += flight * path.direction;
    if (scatterInMedium(path, medium, numbers, false) != kScattered) return false;
    flight = beginFlight(path, medium, numbers);
  }
  return true;
}
#endif

bool arrivesAt(Hit hit, float flight) { return hit.triangle != kNoHit ? hit.t <= flight : flight > 0.5 * kFar; }

// Of the flight before what it meets: that through the gap behind the ray's start counts too.
float flownDistance(Path path, Hit hit, float flight) {
  return max(path.head + (hit.triangle != kNoHit && arrivesAt(hit, flight) ? hit.t : flight), 0.0);
}

// What happens on the way to `hit`, the first hit within `flight`.
int crossMedium(inout Path path, MediumRecord medium, float flight, Hit hit, PathNumbers numbers) {
  vec3 inward = vec3(0.0);
#if HETEROGENEOUS
  if (medium.grid >= 0) {
    bool collided;
    int became = trackDensity(path, medium, hit.triangle != kNoHit ? hit.t : kFar, numbers, collided);
    if (!collided) return became;
  } else
#endif
  {
    bool arrives = arrivesAt(hit, flight);
    weighFlight(path, medium, channelProbabilities(path.throughput), flownDistance(path, hit, flight), arrives,
                numbers);
    if (arrives) return kFlightArrives;
    // Nearer to a face than a gap the path goes on from a gap beside it, and the flight that it does not make or makes
    // twice, along the face's normal, is made good in the next: as if it had begun where it should have. Where a gap is
    // no small part of a mean free path that is much.
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
  int became = scatterInMedium(path, medium, numbers, lampsReach(path));
#if !FIXED_EPSILON  // published rays have no such thing
  float shift = length(inward);
  if (shift > 0.0) {
    float cosine = dot(inward, path.direction) / shift;
    path.head = shift / (abs(cosine) > 0.01 ? cosine : cosine < 0.0 ? -0.01 : 0.01);
  }
#endif
  return became;
}
#endif
