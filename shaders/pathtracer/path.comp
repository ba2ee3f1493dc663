// Path tracing: one invocation a pixel follows its paths one after the other, segment by segment, and starts the next
// as soon as one has ended, until the pixel has its samples or this submission's turns of loops are used up; the
// unfinished path then waits in the state buffer. So every submission is bounded however long paths get, and no path is
// dropped: dropping the long ones would bias the picture.
//
// A path: camera ray, then at each surface next-event estimation towards one light and a new direction drawn from the
// surface, weighted against each other [Veach1997], and Russian roulette. `throughput` is without the squares of
// refractive indices, as L / n^2 is what a boundary conserves; what a light adds is multiplied by (n_camera / n_here)^2
// instead.
// Film: three images of 32-bit words that hold floats' bits: mean and number of samples; sum of squared deviations
// [Welford1962]; the mean's rest below a float's last place, so that it does not stall however many samples there are.
layout(local_size_x = 8, local_size_y = 8) in;
#include "shared/path_tracer.h"
layout(std140, binding = 0) uniform PathBlock { PathConstants tracer; };

#include "rays/random.glsl"
#include "rays/bsdf.glsl"
#include "pathtracer/fresnel.glsl"
#include "rays/materials.glsl"
#include "rays/bvh.glsl"
#include "rays/environment.glsl"
#include "rays/lights.glsl"

layout(rgba32ui, binding = 0) uniform uimage2D filmMean;    // xyz and, as an integer, the number of samples
layout(rgba32ui, binding = 1) uniform uimage2D filmSpread;  // sum of squared deviations; w unused
layout(rgba32ui, binding = 2) uniform uimage2D filmRest;
#include "pathtracer/path.glsl"
#if MEDIA
uint collisionCount = 0u;  // of this lane, in this submission
#endif
#if ASKED
#include "pathtracer/asked.glsl"
#endif
#include "pathtracer/shadow_ray.glsl"
#if INTERIORS
#include "pathtracer/volume.glsl"
#endif
#include "pathtracer/facet.glsl"

#if NEXT_EVENT
// iorBeyond, beyond: refractive index behind the surface, and the boundaries around that side.
void addNextEvent(Path path, Surface surface, uint triangle, Facet facet, float iorBeyond, uvec4 beyond,
                  PathNumbers numbers) {
  LightSample light;
  if (!sampleLight(surface.position, randomPair(numbers, path.event, kPurposeLight),
                   randomWords(numbers, path.event, kPurposePick), light))
    return;
  float side = dot(light.direction, surface.geometricNormal), pdf;
  if (!(side * dot(light.direction, facet.normal) > 0.0)) return;
#if ROUGH_DIELECTRICS
  if (facet.kind != PATH_DIELECTRIC && side < 0.0) return;
  if (side < 0.0) {
    path.ior = iorBeyond;
    path.inside = beyond;
  }
#else
  if (side < 0.0) return;
#endif
  vec3 contribution = evaluate(facet, -path.direction, light.direction, pdf) * light.value;
#if MIS
  if (light.pdf > 0.0) contribution *= powerHeuristic(light.pdf, pdf);
#endif
#if LAMPS_OUTSIDE
  if (path.ior != 1.0) return;  // a lamp beyond a boundary that refracts lies on no straight line
#endif
  if (all(equal(contribution, vec3(0.0)))) return;
  askLight(path, contribution, beside(surface, side > 0.0 ? surface.geometricNormal : -surface.geometricNormal), light,
           triangle, numbers);
}
#endif

// Light from beyond all surfaces.
void addFromAfar(inout Path path, PathNumbers numbers) {
#if ENVIRONMENT
  if (counts(path.scatterings)) {
    vec3 radiance = environmentRadiance(path.direction);
#if ENVIRONMENT_PICTURE && NEXT_EVENT
    if (path.pdf > 0.0) radiance *= powerHeuristic(path.pdf, tracer.environmentPick * environmentPdf(path.direction));
#endif
    addLight(path, radiance);
#if ASKED
    noteLight(path, numbers, lightOf(path, radiance), PATH_LIGHT_ENVIRONMENT, 0u, path.origin, path.direction, true);
#endif
  }
#elif BACKGROUND
  if (path.scatterings == 0u && counts(0u)) {
    addLight(path, tracer.background);  // is seen, but lights nothing
#if ASKED
    noteLight(path, numbers, tracer.background, PATH_ASKED_BACKGROUND, 0u, path.origin, path.direction, true);
#endif
  }
#endif
}

#if EMISSION
void addEmission(inout Path path, Hit hit, Surface surface, PathNumbers numbers) {
  vec3 emission = emissionAt(surface.material, hit.triangle, hit.barycentrics);
#if NEXT_EVENT
  if (path.pdf > 0.0) {
    float pdf =
        pickDensity(hit.triangle) * path.travelled * path.travelled / -dot(surface.geometricNormal, path.direction);
    emission *= powerHeuristic(path.pdf, pdf);
  }
#endif
  addLight(path, emission);
#if ASKED
  noteLight(path, numbers, lightOf(path, emission), PATH_LIGHT_TRIANGLE, hit.triangle, path.origin, surface.position,
            false);
#endif
}
#endif

// iorBeyond: refractive index behind the surface.
Facet facetOf(Path path, Surface surface, PathMaterial material, float iorBeyond) {
  Facet facet = Facet(material.kind, material.specular, material.roughness, 1.0, surface.normal);
  // Mirrors and glass are not there for a path that sees the shading normal's back.
  if (facet.kind != PATH_DIFFUSE && !(dot(surface.normal, path.direction) < 0.0))
    facet.normal = surface.geometricNormal;
  if (facet.kind == PATH_DIFFUSE) facet.albedo = albedoAt(surface);
#if DIELECTRICS
  if (facet.kind == PATH_DIELECTRIC) facet.eta = path.ior / iorBeyond;
#endif
  return facet;
}

// Roulette [Arvo1990]. From a throughput of 1 or more nothing dies for long; then a little does, so that every path
// ends. Total reflection may catch paths in glass for ever, which hold next to no light: after many smooth
// scatterings in a row more of them die. False: the path ends.
bool survivesSurface(inout Path path, float random) {
  float most = path.chain > 32u ? 0.99 : path.event < 1024u ? 1.0 : 0.999;
  float largest = max(path.throughput.x, max(path.throughput.y, path.throughput.z));
#if MEDIA && ROULETTE_AT_SURFACES
  return mediumInside(path.inside) >= 0 || survivesTurn(path, random);
#elif ROULETTE_WITHOUT_DIVISION
  return random < min(largest, min(most, 0.95));  // [VPT2024, algorithm 3]
#else
  float survival = min(largest / kRouletteBelow, most);
  if (path.scatterings < 2u) survival = survival > 0.0 ? 1.0 : 0.0;
  if (!(random < survival)) return false;
  path.throughput /= survival;
  return true;
#endif
}

// What the path's ray has met, and on from there; false where the path has ended.
#if TOUCHING
bool meet(inout Path path, Hit hit, uvec4 beyond, uvec4 before, PathNumbers numbers) {
#else
bool meet(inout Path path, Hit hit, PathNumbers numbers) {
#endif
  // Nothing: the light from afar.
  if (hit.triangle == kNoHit) {
    addFromAfar(path, numbers);
    return false;
  }
  // A surface, what is behind it, and its material.
  Surface surface = surfaceAt(hit.triangle, hit.barycentrics, path.direction);
#if INTERIORS
  int rank = int(materials[surface.material].boundary);
#endif
#if !TOUCHING
  uvec4 beyond = uvec4(0u);  // of which closed boundaries the other side is
#if INTERIORS
  beyond = path.inside;
  if (rank >= 0 && !crossBoundary(beyond, rank, surface.front)) atomicAdd(wrongCrossings, 1u);
#endif
#endif
  PathMaterial material = materials[surface.material];
#if METAL_MAPS && GLOSSY
  applyMetalMap(surface, material);
#endif
#if NORMAL_MAPS
  applyNormalMap(surface, hit.triangle);
#endif
  // The step is done.
  path.travelled += hit.t;
  ++path.event;
#if MEDIA && ROULETTE_AT_SURFACES
  // A turn of [VPT2024, algorithm 3] that went into a medium ends here, at the medium's end.
  if (mediumInside(path.inside) >= 0 &&
      !survivesTurn(path, unitFloat(randomWordPair(numbers, path.event, kPurposeMediumChoice).x)))
    return false;
#endif
#if EMISSION
  if (any(greaterThan(material.emission, vec3(0.0))) && counts(path.scatterings))
    addEmission(path, hit, surface, numbers);
#endif
  // A boundary where nothing refracts is passed.
  float iorBeyond = path.ior;
#if INTERIORS
  if (rank >= 0) {
    iorBeyond = iorInside(beyond);
    if (iorBeyond == path.ior) {  // nothing refracts: another medium, or a boundary that a higher one covers
      path.inside = beyond;
      startAt(path, surface, hit.triangle);
      return true;
    }
  }
#endif
  // Light that arrives here from lamps.
  if (path.scatterings >= tracer.maxScatterings) return false;
  Facet facet = facetOf(path, surface, material, iorBeyond);
  ++path.scatterings;
#if NEXT_EVENT
  if (!isSmooth(facet) && counts(path.scatterings))
    addNextEvent(path, surface, hit.triangle, facet, iorBeyond, beyond, numbers);
#endif
#if UNOCCLUDED
  if (path.scatterings == 2u && facet.kind == PATH_DIFFUSE) {  // nothing is in the way: on to the surfaces behind
    path.scatterings = 1u;
    path.origin = beside(surface, -surface.geometricNormal);
    path.skip = hit.triangle;
    return path.event < 4096u;
  }
#endif
#if !SCATTERED_LIGHT
  if (path.scatterings >= tracer.maxScatterings && !isSmooth(facet)) return false;  // nothing more could be found
#endif
  // The next direction, and on whose side it goes on.
  path.travelled = 0.0;
#if DIELECTRICS
  uvec2 choice = randomWordPair(numbers, path.event, kPurposeChoice);
#else
  uvec4 choice = randomWords(numbers, path.event, kPurposeChoice);  // for roulette alone
#endif
  if (!scatter(path, facet, surface.geometricNormal, randomPair(numbers, path.event, kPurposeScatter),
               unitFloat(choice.x)))
    return false;
#if DIELECTRICS
  if (dot(path.direction, surface.geometricNormal) < 0.0) {
    path.ior = iorBeyond;
    path.inside = beyond;
  }
#endif
  path.chain = path.pdf == 0.0 ? min(path.chain + 1u, 255u) : 0u;
  if (!survivesSurface(path, unitFloat(choice.y))) return false;
  startAt(path, surface, hit.triangle);
#if TOUCHING
  if (dot(path.direction, surface.geometricNormal) > 0.0) {
    path.inside = before;
    path.ior = iorInside(before);
  }
#endif
  return true;
}

// a + b as a float and what that float lacks [Knuth1997, 4.2.2].
vec3 twoSum(vec3 a, vec3 b, out vec3 rest) {
  precise vec3 sum = a + b;
  precise vec3 back = sum - a;
  precise vec3 error = (a - (sum - back)) + (b - back);
  rest = error;
  return sum;
}

// A lane's job: which ray it traces.
const uint kPathRay = 0u;
const uint kShadowRay = 1u;
const uint kBesidesRay = 2u;  // the short one across a boundary

// Its stages: what is to be done next.
const int kTraces = 0;
const int kLit = 1;      // a shadow ray has been followed to its end
const int kFlies = 2;    // the path's ray was traced
const int kFlown = 3;    // and lamps beside it were asked
const int kArrives = 4;  // at a surface, or far away
const int kMeets = 5;    // all boundaries there are known
const int kEnds = 6;
const int kGoesOn = 7;   // with the next ray

void main() {
  // The pixel's film, and its path where the last dispatch left it.
  ivec2 lane = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(lane, tracer.tile.zw))) return;
  ivec2 pixel = tracer.tile.xy + lane;
  uvec4 meanWords = imageLoad(filmMean, pixel);
  uint samples = meanWords.w;
  if (samples >= tracer.sampleTarget) return;
  vec3 mean = uintBitsToFloat(meanWords.xyz), rest = uintBitsToFloat(imageLoad(filmRest, pixel).xyz);
  vec3 spread = uintBitsToFloat(imageLoad(filmSpread, pixel).xyz);

  // picture.w: number of the film's first sample.
  PathNumbers numbers =
      PathNumbers(uint(pixel.y * tracer.picture.x + pixel.x), uint(tracer.picture.w) + samples, tracer.seed);
  Lane here = Lane(uint(lane.y * tracer.tile.z + lane.x), uint(tracer.picture.z));
  Path path;
  if (!restorePath(here, path)) path = startPath(pixel, numbers);

  // One traversal serves all rays, since drivers inline every function: each further call site costs registers and
  // minutes of compiling. What is to be traced next is the lane's job; what is to be done with a hit its stages, each
  // of which follows from those above it.
  bool inFlight = true;
  uint job = kPathRay;
  int after = kGoesOn;  // the stage to go on with once a shadow ray has been followed to its end
  Hit arrival;          // what the path's ray has met
  shadow.waits = false;
#if MEDIA
  float flight = 3e38;  // length of the path's present flight
#endif
#if TOUCHING
  Hit crossed;          // the boundary that a shadow ray crosses
  Besides besides;
  bool right = true;    // whether the path was where it can cross the boundary
#endif
  for (;;) {
    // The ray of this turn.
    int stage = kTraces;
    Ray ray = Ray(path.origin, 0.0, path.direction, 3e38);
    uint skip = path.skip;
    if (job == kPathRay) {
      if (loopTurns >= tracer.turns) break;
      loopTurns += 4u;
#if ASKED
      notePlace(path);
#endif
#if MEDIA
      // In a homogeneous medium the flight is drawn first: rays that need not go far are cheap.
      int medium = mediumInside(path.inside);
      flight = medium >= 0 ? beginFlight(path, media[medium], numbers) : 3e38;
#if WALKS
      if (medium >= 0 && !walk(path, media[medium], flight, numbers)) stage = kEnds;
      skip = path.skip;
#endif
      ray = Ray(path.origin, 0.0, path.direction, flight + flightMargin());
#endif
    }
#if !SHADOW_AT_ONCE
    if (job == kShadowRay) {
#if INTERIORS
      ray = Ray(shadow.origin, shadow.tMin, shadow.direction, shadow.infinite ? 3e38 : 1.0);
#else
      ray = Ray(shadow.origin, 0.0, shadow.direction, shadow.infinite ? 3e38 : 1.0);
#endif
      skip = shadow.skip;
    }
#endif
#if TOUCHING
    vec3 ahead = vec3(0.0);
    float besidesGap = 0.0;
    if (job == kBesidesRay) {
      Surface surface;
      if (shadow.waits) surface = surfaceAt(crossed.triangle, crossed.barycentrics, shadow.direction);
      else surface = surfaceAt(arrival.triangle, arrival.barycentrics, path.direction);
      besidesGap = gapAt(surface);
      ahead = -besidesGap * surface.geometricNormal;
      ray = besidesRay(besides, surface.position, ahead);
      skip = besides.skip;
    }
#endif

    // Traced: the one traversal.
    BvhTraversal traversal = beginRay(ray, skip);
    if (stage == kEnds) traversal.top = -1;
#if INTERIORS || SHADOW_AT_ONCE
    const bool any = false;  // boundaries may let light through
#else
    bool any = job == kShadowRay;
#endif
    while (!isDone(traversal)) advanceRay(traversal, any);
    Hit hit = traversal.hit;
    if (!any) hit = finishRay(traversal, ray.direction);

    // What the hit is to the job: the path's arrival, a step across a boundary, or a shadow ray's.
    if (job == kPathRay && stage == kTraces) {
      arrival = hit;
      stage = kFlies;
    }
#if TOUCHING
    if (job == kBesidesRay && !crossBesides(besides, hit, ahead)) {
      if (shadow.waits) {
        shadow.inside = besides.beyond;
        if (hit.triangle != kNoHit) shadow.light = vec3(0.0);
        shadow.tMin +=
            dot(ahead, ahead) / max(dot(ahead, shadow.direction), 0.01 * besidesGap * length(shadow.direction));
        job = kShadowRay;
        if (!shadowGoesOn()) stage = kLit;
      } else {
        job = kPathRay;
        stage = kMeets;
        if (hit.triangle != kNoHit) {  // a wall right behind is what the path has met, from where it is
          besides.beyond = besides.before = path.inside;
          arrival.triangle = hit.triangle;
          arrival.barycentrics = hit.barycentrics;
        } else if (!right) {
          atomicAdd(wrongCrossings, 1u);
        }
      }
    } else
#endif
    if (job == kShadowRay) {
#if INTERIORS
      bool goesOn = crossShadow(hit);
#if TOUCHING
      if (goesOn) {
        job = kBesidesRay;
        crossed = hit;
        besides = Besides(shadow.inside, shadow.inside, 0.0, hit.triangle, 0u);
      }
#else
      goesOn = goesOn && shadowGoesOn();
#endif
      if (!goesOn) stage = kLit;
#else
      if (hit.triangle != kNoHit) shadow.light = vec3(0.0);
      stage = kLit;
#endif
    }
    // A shadow ray's light arrives; the path goes on where it had waited.
    if (stage == kLit) {
      path.radiance += shadow.light;
#if ASKED
      noteShadow(path, after == kFlown, numbers);
#endif
      shadow.waits = false;
      job = kPathRay;
      stage = after;
    }

    // The flight through a medium: lamps beside it, then whether it ends before the surface.
#if MEDIA
    if (stage == kFlies) {
      int medium = mediumInside(path.inside);
      stage = medium < 0 ? kArrives : kFlown;
#if NEXT_EVENT && (POINTS || SPOTS) && !DISTANCE_WITHOUT_PDF && !BOOSTED_INTERACTION
      if (medium >= 0 && media[medium].grid < 0 && lampsReach(path)) {
        addPointLight(path, media[medium], channelProbabilities(path.throughput), flownDistance(path, arrival, flight),
                      numbers);
        if (shadow.waits) {
          job = kShadowRay;
          after = kFlown;
          stage = kTraces;
        }
      }
#endif
    }
    if (stage == kFlown) {
      int became = crossMedium(path, media[mediumInside(path.inside)], flight, arrival, numbers);
      stage = became == kFlightArrives ? kArrives : became == kScattered ? kGoesOn : kEnds;
      if (stage != kArrives && shadow.waits) {
        job = kShadowRay;
        after = stage;
        stage = kTraces;
      }
    }
#else
    if (stage == kFlies) stage = kArrives;
#endif
    // The surface: first all boundaries there, then what the path meets and the lamps that it sees.
    if (stage == kArrives) {
      stage = kMeets;
#if TOUCHING
      // What else the step beyond crosses: a face that coincides with this one is of the same interface.
      besides = Besides(path.inside, path.inside, 0.0, arrival.triangle, 0u);
      int rank = arrival.triangle != kNoHit ? rankOf(arrival.triangle) : -1;
      if (rank >= 0) {
        right = crossBoundary(besides.beyond, rank, facesAgainst(arrival.triangle, path.direction));
        job = kBesidesRay;
        stage = kTraces;
      }
#endif
    }
    if (stage == kMeets) {
#if TOUCHING
      stage = meet(path, arrival, besides.beyond, besides.before, numbers) ? kGoesOn : kEnds;
#else
      stage = meet(path, arrival, numbers) ? kGoesOn : kEnds;
#endif
#if SHADOW_AT_ONCE
      if (shadow.waits &&
          !anyHit(Ray(shadow.origin, 0.0, shadow.direction, shadow.infinite ? 3e38 : 1.0), shadow.skip)) {
        path.radiance += shadow.light;
#if ASKED
        noteShadow(path, false, numbers);
#endif
      }
      shadow.waits = false;
#else
      if (shadow.waits) {
        job = kShadowRay;
        after = stage;
        stage = kTraces;
      }
#endif
    }
    // A sample is done: Welford's mean and spread [Welford1962], with what the mean's floats lack.
    if (stage == kEnds) {
      ++samples;
      vec3 difference = (path.radiance - mean) - rest;
      mean = twoSum(mean, rest + difference / float(samples), rest);
      spread += difference * ((path.radiance - mean) - rest);
      numbers.sampleIndex = uint(tracer.picture.w) + samples;
      if (samples >= tracer.sampleTarget) {
        inFlight = false;
        break;
      }
      path = startPath(pixel, numbers);
    }
  }

  // Counters, the film, and the path in flight.
  atomicMax(longest, loopTurns);
  atomicAdd(allTurns, loopTurns);
#if MEDIA
  atomicAdd(collisions, collisionCount);
#endif
  imageStore(filmMean, pixel, uvec4(floatBitsToUint(mean), samples));
  imageStore(filmSpread, pixel, uvec4(floatBitsToUint(spread), 0u));
  imageStore(filmRest, pixel, uvec4(floatBitsToUint(rest), 0u));
  savePath(here, path, inFlight);
}
