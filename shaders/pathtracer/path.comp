// Path tracing. An invocation traces the paths of a pixel one after the other, segment by segment, until the pixel has
// its samples or this submission's budget of loop iterations is used up. An unfinished path then waits in the state
// buffer. So every submission is bounded however long paths get, and no path is dropped: dropping the long ones would
// bias the picture. With SHARES_PIXELS an invocation whose pixel is finished takes the next one, so that it does not
// wait for the longest path beside it.
//
// A path: camera ray, then at each surface next-event estimation for one light and a new direction sampled from the
// BSDF, combined by multiple importance sampling [Veach1997], and Russian roulette. `throughput` omits the squared
// refractive indices, since a boundary conserves L / n^2; light contributions are multiplied by (n_camera / n_here)^2
// instead.
// Film: three images of 32-bit words that hold the bits of floats: mean and number of samples; sum of squared
// deviations [Welford1962]; the low part of the mean below a float's last place, so that the mean keeps converging
// however many samples there are. With HALVES it holds two independent pictures of half the samples, one above the
// other; their pixels have other numbers, so other random numbers.
layout(local_size_x = 8, local_size_y = 8) in;
#include "shared/path_tracer.h"
layout(std140, binding = 0) uniform PathBlock { PathConstants tracer; };

#include "rays/random.glsl"
#include "rays/bsdf.glsl"
#include "pathtracer/fresnel.glsl"
#include "rays/materials.glsl"
#include "rays/bvh.glsl"
#include "rays/shadow_start.glsl"
#include "rays/environment.glsl"
#include "rays/lights.glsl"
#include "rays/view.glsl"

layout(rgba32ui, binding = 0) uniform uimage2D filmMean;    // xyz and, as an integer, the number of samples
layout(rgba32ui, binding = 1) uniform uimage2D filmM2;  // sum of squared deviations; w unused
layout(rgba32ui, binding = 2) uniform uimage2D filmRest;
#include "pathtracer/path.glsl"
#if MEDIA
uint collisionCount = 0u;  // of this lane, in this submission
#endif
#if INSPECTED
#include "pathtracer/inspected.glsl"
#endif
#include "pathtracer/shadow_ray.glsl"
#if INTERIORS
#include "pathtracer/crossing.glsl"
#endif
#if MANIFOLDS
#include "pathtracer/manifold_request.glsl"
#endif
#if MEDIA
#include "pathtracer/flight.glsl"
#endif
#include "pathtracer/bsdf.glsl"
#include "pathtracer/next_event.glsl"

// Light from infinity.
void addFromAfar(inout Path path, PathNumbers numbers) {
#if ENVIRONMENT
  if (counts(path.scatterings)) {
    vec3 radiance = environmentRadiance(path.direction);
#if ENVIRONMENT_PICTURE && NEXT_EVENT
    if (path.pdf > 0.0) radiance *= powerHeuristic(path.pdf, tracer.environmentPick * environmentPdf(path.direction));
#endif
    addLight(path, radiance);
#if INSPECTED
    noteLight(path, numbers, lightOf(path, radiance), PATH_LIGHT_ENVIRONMENT, 0u, path.origin, path.direction, true);
#endif
  }
#elif BACKGROUND
  if (path.scatterings == 0u && counts(0u)) {
    addLight(path, tracer.background);  // visible, but lights nothing
#if INSPECTED
    noteLight(path, numbers, tracer.background, PATH_INSPECTED_BACKGROUND, 0u, path.origin, path.direction, true);
#endif
  }
#endif
}

#if EMISSION
void addEmission(inout Path path, Hit hit, Surface surface, PathNumbers numbers) {
  vec3 emission = emissionAt(surface.material, hit.triangle, hit.barycentrics);
#if NEXT_EVENT
  if (path.pdf > 0.0) {
    float pdf = lampDensityOfHit(hit.triangle, surface.position - path.travelled * path.direction, path.travelled,
                                 -dot(surface.geometricNormal, path.direction));
    emission *= powerHeuristic(path.pdf, pdf);
  }
#endif
  addLight(path, emission);
#if INSPECTED
  noteLight(path, numbers, lightOf(path, emission), PATH_LIGHT_TRIANGLE, hit.triangle, path.origin, surface.position,
            false);
#endif
}
#endif

// Russian roulette [Arvo1990]. While the throughput is 1 or more the survival probability stays high but below 1, so
// that every path ends. Total internal reflection may trap paths in glass forever with almost no light; after many
// smooth scatterings in a row the probability drops. False: the path ends.
bool survivesSurface(inout Path path, float random) {
  float most = path.chain > 32u ? 0.99 : path.event < 1024u ? 1.0 : 0.999;
  float largest = max(path.throughput.x, max(path.throughput.y, path.throughput.z));
#if MEDIA && ROULETTE_AT_SURFACES
  return mediumInside(path.inside) >= 0 || survivesIteration(path, random);
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

#if SPLITS_BOUNDARIES
// Whether what refracts and what reflects are both followed: at the first thing that a sample meets, unless a dense
// medium lies behind it, where nearly all of the time goes. Nothing has shone on the way there, so the part that begins
// anew adds nothing twice.
bool splitsBoundary(Path path, Bsdf bsdf, PathMaterial material) {
  return path.event == 1u && bsdf.kind == PATH_DIELECTRIC && isSmooth(bsdf) &&
         interiors[int(material.boundary)].clearance < 0 && topRank(path.inside) < 0 && outerMedium < 0 &&
         all(equal(material.emission, vec3(0.0)));
}
#endif

// Handles the hit of the path's ray, and continues the path; false if the path has ended.
bool handleHit(inout Path path, Hit hit, PathNumbers numbers) {
  // No hit: light from infinity.
  if (hit.triangle == kNoHit) {
    addFromAfar(path, numbers);
    return false;
  }
  // A surface: the sides of the boundary and the material.
  Surface surface = surfaceAt(hit.triangle, hit.barycentrics, path.direction);
#if INTERIORS
  int rank = int(materials[surface.material].boundary);
#endif
  uvec4 beyond = uvec4(0u);  // the closed boundaries that contain the other side
#if TOUCHING
  reloadCoincident();
  beyond = coincident.beyond;
#elif INTERIORS
  beyond = path.inside;
  if (rank >= 0 && !crossBoundary(beyond, rank, surface.front)) atomicAdd(wrongCrossings, 1u);
#endif
  PathMaterial material = materials[surface.material];
#if DIFFUSE_ONLY
  if (material.kind != PATH_NONE) material.kind = PATH_DIFFUSE;
#endif
#if NORMAL_MAPS
  applyNormalMap(surface, hit.triangle);
#endif
  // The step is complete.
  path.travelled += hit.t;
  ++path.event;
#if MEDIA && ROULETTE_AT_SURFACES
  // An iteration of [VPT2024, algorithm 3] that entered a medium ends here, at the medium's far boundary.
  if (mediumInside(path.inside) >= 0 &&
      !survivesIteration(path, unitFloat(randomWordPair(numbers, path.event, kPurposeMediumChoice).x)))
    return false;
#endif
#if EMISSION
  if (any(greaterThan(material.emission, vec3(0.0))) && counts(path.scatterings))
    addEmission(path, hit, surface, numbers);
#endif
  // Pass straight through a boundary without refraction.
  float iorBeyond = path.ior;
#if INTERIORS
  if (rank >= 0) {
    iorBeyond = iorInside(beyond);
    if (iorBeyond == path.ior) {  // no refraction: another medium, or a boundary overlapped by a higher-priority one
      path.inside = beyond;
      startAt(path, surface, hit.triangle);
      return true;
    }
  }
#endif
  // Light from lamps at this surface.
  if (path.scatterings >= tracer.maxScatterings) return false;
  Bsdf bsdf = bsdfOf(path, surface, material, iorBeyond);
  ++path.scatterings;
#if NEXT_EVENT
  spill(path);
  if (!isSmooth(bsdf) && counts(path.scatterings))
    addNextEvent(path, surface, hit.triangle, bsdf, iorBeyond, beyond, numbers);
  forgetAddresses();
  reload(path);
#endif
#if MANIFOLDS
  if (!isSmooth(bsdf)) requestManifold(path, hit.triangle, hit.barycentrics, 1.0, numbers);
#endif
#if UNOCCLUDED
  if (path.scatterings == 2u && isOpaque(bsdf)) {  // surfaces do not block: continue to those behind
    path.scatterings = 1u;
    path.origin = beside(surface, -surface.geometricNormal);
    path.skip = hit.triangle;
    return path.event < 4096u;
  }
#endif
#if !SCATTERED_LIGHT
  if (path.scatterings >= tracer.maxScatterings && !isSmooth(bsdf)) return false;  // no further light can be found
#endif
  // Sample the next direction, and find the side on which the path continues.
  path.travelled = 0.0;
#if DIELECTRICS
  uvec2 choice = randomWordPair(numbers, path.event, kPurposeChoice);
#else
  uvec4 choice = randomWords(numbers, path.event, kPurposeChoice);  // for roulette only
#endif
  float lobe = unitFloat(choice.x);
#if SPLITS_BOUNDARIES
  if (splitsBoundary(path, bsdf, material)) {
    float cosI = clamp(-dot(bsdf.normal, path.direction), 0.0, 1.0), cosT;
    float reflectance = fresnelDielectric(cosI, bsdf.eta, cosT);
    if (path.part == kWhole) path.part = kFirst;
    bool reflects = path.part == kSecond;
    if (reflects) path.part = kLast;
    path.throughput *= reflects ? reflectance : 1.0 - reflectance;
    lobe = reflects ? 0.0 : 1.0;  // certain
  }
#endif
  if (!scatter(path, bsdf, surface.geometricNormal, randomPair(numbers, path.event, kPurposeScatter), lobe))
    return false;
#if TOUCHING
  reloadCoincident();
  beyond = coincident.beyond;
#endif
#if DIELECTRICS
  if (dot(path.direction, surface.geometricNormal) < 0.0) {
    path.ior = iorBeyond;
    path.inside = beyond;
  }
#endif
  path.chain = path.pdf == 0.0 ? min(path.chain + 1u, kMostChain) : 0u;
  if (!survivesSurface(path, unitFloat(choice.y))) return false;
  startAt(path, surface, hit.triangle);
#if TOUCHING
  if (dot(path.direction, surface.geometricNormal) > 0.0) {
    path.inside = coincident.before;
    path.ior = iorInside(coincident.before);
  }
#endif
  return true;
}

// a + b rounded to a float, and the rounding error [Knuth1997, 4.2.2].
vec3 twoSum(vec3 a, vec3 b, out vec3 rest) {
  precise vec3 sum = a + b;
  precise vec3 back = sum - a;
  precise vec3 error = (a - (sum - back)) + (b - back);
  rest = error;
  return sum;
}

// A pixel's film. A GPU reads it at the end of every sample, a software renderer once.
struct Film {
  vec3 mean, rest, m2;
};

Film readFilm(ivec2 pixel) {
  return Film(uintBitsToFloat(imageLoad(filmMean, pixel).xyz), uintBitsToFloat(imageLoad(filmRest, pixel).xyz),
              uintBitsToFloat(imageLoad(filmM2, pixel).xyz));
}

void writeFilm(ivec2 pixel, Film film, uint samples) {
  imageStore(filmMean, pixel, uvec4(floatBitsToUint(film.mean), samples));
  imageStore(filmM2, pixel, uvec4(floatBitsToUint(film.m2), 0u));
  imageStore(filmRest, pixel, uvec4(floatBitsToUint(film.rest), 0u));
}

// Welford's mean and sum of squares [Welford1962], with the mean's low part.
void addSample(inout Film film, vec3 radiance, uint samples) {
  vec3 difference = (radiance - film.mean) - film.rest;
  film.mean = twoSum(film.mean, film.rest + difference / float(samples), film.rest);
  film.m2 += difference * ((radiance - film.mean) - film.rest);
}

ivec2 pixelAt(uint where) { return ivec2(where & 0xffffu, where >> 16u); }

// What a lane does. Its job is the kind of ray that it traces, its stage what it does next. Within an iteration of the
// loop in main() each stage follows from those above it:
//   stage      of the lane                    does                                        next
//   kTraces    begins an iteration            traces its job's ray                        kLit, kFlies, kHits
//   kLit       shadow ray traced to its end   adds its light                              `after`
//   kFlies     path's ray traced              samples lamps along it, if in a medium      kFlown, else kArrives
//   kFlown     lamps along it sampled         flies: may collide and scatter              kArrives, kContinue, kEnds
//   kArrives   at a surface, or far away      looks for other boundaries beside it        kHits
//   kHits      all boundaries there known     gathers light and scatters                  kContinue, kEnds
//   kEnds      path ended                     completes the sample, starts the next path  kTraces
//   kContinue  path has its next ray                                                      kTraces
// Queued shadow rays, and the short rays beside a boundary, come before the next stage: kTraces, with their job.
const uint kPathRay = 0u;
const uint kShadowRay = 1u;
const uint kCoincidentRay = 2u;  // the short ray across a boundary
uint job = kPathRay;

const int kTraces = 0, kLit = 1, kFlies = 2, kFlown = 3, kArrives = 4, kHits = 5, kEnds = 6, kContinue = 7;
int stage = kTraces;
int after = kContinue;  // the stage to resume after a shadow ray has been traced to its end

Hit arrival;          // the hit of the path's ray
#if MEDIA
float flight = 3e38;  // length of the path's current flight
#endif
#if TOUCHING
Hit crossed;          // the boundary that a shadow ray is crossing
bool right = true;    // whether the path could validly cross the boundary
#endif

// If a shadow ray waits, it is traced before the lane's stage.
void traceShadowFirst() {
  if (!shadow.waits) return;
  job = kShadowRay;
  after = stage;
  stage = kTraces;
}

uint waitsIn = kReady + 1u - turn;  // the queue of a path that pauses

// kTraces: the ray of the lane's job, and the triangle that it starts on. False: the submission's budget is used up, or
// the path walks.
bool setUpRay(inout Path path, PathNumbers numbers, out Ray ray, out uint skip) {
  ray = Ray(vec3(0.0), 0.0, vec3(1.0), 0.0);
  skip = kNoHit;
  if (job == kPathRay) {
    if (loopIterations >= tracer.iterations) return false;
    loopIterations += 4u;
    reload(path);
    ray = Ray(path.origin, 0.0, path.direction, 3e38);
    skip = path.skip;
#if INSPECTED
    notePlace(path);
#endif
#if MEDIA
    // In a homogeneous medium the flight length is drawn first: short rays are cheap to trace.
    int medium = mediumInside(path.inside);
    flight = medium >= 0 ? beginFlight(path, mediumOf(medium), numbers) : 3e38;
#if WALKING
    if (medium >= 0 && mayWalk(path, flight, numbers)) {
      waitsIn = kWalking + turn;
      return false;
    }
#endif
    ray = Ray(path.origin, 0.0, path.direction, flight + flightMargin());
#endif
  }
#if !SHADOW_AT_ONCE
  if (job == kShadowRay) {
    reloadShadow();
#if INTERIORS
    ray = Ray(shadow.origin, shadow.tMin, shadow.direction, shadow.infinite ? 3e38 : 1.0);
#else
    ray = Ray(shadow.origin, 0.0, shadow.direction, shadow.infinite ? 3e38 : 1.0);
#endif
    skip = shadow.skip;
  }
#endif
#if TOUCHING
  if (job == kCoincidentRay) {
    reloadCoincident();
    Surface surface;
    if (shadow.waits) {
      reloadShadow();
      reloadHit(1u, crossed);
      surface = surfaceAt(crossed.triangle, crossed.barycentrics, shadow.direction);
    } else {
      reload(path);
      reloadHit(0u, arrival);
      surface = surfaceAt(arrival.triangle, arrival.barycentrics, path.direction);
    }
    coincident.gap = gapAt(surface);
    ray = coincidentRay(coincident, surface.position, -coincident.gap * surface.geometricNormal);
    spillCoincident();
    skip = coincident.skip;
  }
#endif
  return true;
}

// The hit goes to the lane's job: the path's arrival, a step across a boundary, or a shadow ray's hit. Then kLit.
void useHit(inout Path path, Ray ray, Hit hit, PathNumbers numbers) {
  // A path's arrival. Without interiors nothing else needs it, so it is not kept.
  bool arrives = job == kPathRay && stage == kTraces;
  if (INTERIORS == 0 || arrives) arrival = hit;
  if (arrives) {
    spillHit(0u, hit);
    stage = kFlies;
  }
#if TOUCHING
  // A short ray: to the next boundary, or back to the ray that crosses them.
  if (job == kCoincidentRay) {
    reloadCoincident();
    vec3 ahead = 0.5 * ray.direction;
    bool goesOn = crossCoincident(coincident, hit, ahead);
    if (!goesOn && shadow.waits) {
      reloadShadow();
      shadow.inside = coincident.beyond;
      if (hit.triangle != kNoHit) shadow.light = vec3(0.0);
      shadow.tMin +=
          dot(ahead, ahead) / max(dot(ahead, shadow.direction), 0.01 * coincident.gap * length(shadow.direction));
      job = kShadowRay;
      if (!shadowGoesOn()) stage = kLit;
      spillShadow();
    } else if (!goesOn) {
      job = kPathRay;
      stage = kHits;
      if (hit.triangle != kNoHit) {  // a surface immediately behind: the path has hit it from its current position
        reload(path);
        reloadHit(0u, arrival);
        coincident.beyond = coincident.before = path.inside;
        arrival.triangle = hit.triangle;
        arrival.barycentrics = hit.barycentrics;
        spillHit(0u, arrival);
      } else if (!right) {
        atomicAdd(wrongCrossings, 1u);
      }
    }
    spillCoincident();
  } else
#endif
  // A shadow ray may go on behind what it met.
  if (job == kShadowRay) {
    reloadShadow();
#if INTERIORS
    bool goesOn = crossShadow(hit);
#if TOUCHING
    if (goesOn) {
      job = kCoincidentRay;
      crossed = hit;
      spillHit(1u, hit);
      coincident = Coincident(shadow.inside, shadow.inside, 0.0, hit.triangle, 0u, 0.0);
      spillCoincident();
    }
#else
    goesOn = goesOn && shadowGoesOn();
#endif
    if (!goesOn) stage = kLit;
#else
    if (hit.triangle != kNoHit) shadow.light = vec3(0.0);
    stage = kLit;
#endif
    spillShadow();
  }
  // Add the shadow ray's light; the path resumes where it waited.
  if (stage == kLit) {
    reloadShadow();
    addRadiance(path, shadow.light);
#if INSPECTED
    reload(path);
    noteShadow(path, after == kFlown, numbers);
#endif
    shadow.waits = false;
    job = kPathRay;
    stage = after;
  }
}

// kFlies and kFlown: the flight through a medium. Lamps along it are sampled, then it is decided whether it ends before
// the surface.
void fly(inout Path path, PathNumbers numbers) {
#if MEDIA
  if (stage == kFlies) {
    reload(path);
    int medium = mediumInside(path.inside);
    stage = medium < 0 ? kArrives : kFlown;
#if NEXT_EVENT && (POINTS || SPOTS) && !DISTANCE_WITHOUT_PDF && !BOOSTED_INTERACTION
    if (medium >= 0 && media[medium].grid < 0 && lampsReach(path)) {
      reloadHit(0u, arrival);
      addPointLight(path, mediumOf(medium), channelProbabilities(path.throughput), flownDistance(path, arrival, flight),
                    numbers);
      traceShadowFirst();
    }
#endif
  }
  if (stage == kFlown) {
    reload(path);
    reloadHit(0u, arrival);
    int became = crossMedium(path, mediumInside(path.inside), flight, arrival, numbers);
    spill(path);
    stage = became == kFlightArrives ? kArrives : became == kScattered ? kContinue : kEnds;
    if (stage != kArrives) traceShadowFirst();
  }
#else
  if (stage == kFlies) stage = kArrives;
#endif
}

// kArrives and kHits: all boundaries at the surface are found, then the hit is handled and lamps are sampled.
void arrive(inout Path path, PathNumbers numbers) {
  if (stage == kArrives) {
    stage = kHits;
#if TOUCHING
    // The other boundaries crossed by the step to the far side: a face that coincides with this one belongs to the same
    // interface.
    reload(path);
    reloadHit(0u, arrival);
    coincident = Coincident(path.inside, path.inside, 0.0, arrival.triangle, 0u, 0.0);
    int rank = arrival.triangle != kNoHit ? rankOf(arrival.triangle) : -1;
    if (rank >= 0) {
      right = crossBoundary(coincident.beyond, rank, facesAgainst(arrival.triangle, path.direction));
      job = kCoincidentRay;
      stage = kTraces;
    }
    spillCoincident();
#endif
  }
  if (stage == kHits) {
    reload(path);
    reloadHit(0u, arrival);
    stage = handleHit(path, arrival, numbers) ? kContinue : kEnds;
    spill(path);
#if SHADOW_AT_ONCE
    if (shadow.waits &&
        !anyHitToLamp(Ray(shadow.origin, 0.0, shadow.direction, shadow.infinite ? 3e38 : 1.0), shadow.skip)) {
      path.radiance += shadow.light;
#if INSPECTED
      noteShadow(path, false, numbers);
#endif
    }
    shadow.waits = false;
#else
    traceShadowFirst();
#endif
  }
}

void beginPath(out Path path, ivec2 pixel, PathNumbers numbers) {
#if HALVES  // the film's upper half is of the same pixels
  pixel.y -= pixel.y < tracer.picture.y ? 0 : tracer.picture.y;
#endif
  path = startPath(pixel, numbers);
  spill(path);
  startRadiance(path);
}

// kEnds: the sample is complete, and the next path starts. False: the pixel has all its samples.
bool nextSample(inout Path path, inout Film film, uint where, inout PathNumbers numbers) {
  ivec2 pixel = pixelAt(where + hiddenZero());
#if PARTS
  if (path.part == kFirst) {
    vec3 radiance = radianceOf(path);
    beginPath(path, pixel, numbers);
    path.part = kSecond;
    path.radiance = radiance;
    spill(path);
    startRadiance(path);
    return true;
  }
#endif
  uint samples = ++numbers.sampleIndex - uint(tracer.picture.w);
#if SPILLED
  film = readFilm(pixel);
#endif
  addSample(film, radianceOf(path), samples);
#if SPILLED
  writeFilm(pixel, film, samples);
#endif
  if (samples >= tracer.sampleTarget) return false;
  beginPath(path, pixel, numbers);
  return true;
}

// What a GPU would otherwise keep in registers is computed again.
void forget(inout uint where, inout PathNumbers numbers) {
#if SPILLED
  forgetAddresses();
  where += hiddenZero();
  numbers.pixel = indexOf(pixelAt(where));
#endif
}

void finishPixel() {
  state[wordAt(4u)].x = kFinished;
  atomicAdd(finished, 1u);
}

// Whether a pixel lacks samples, and its path waits for no other kernel.
bool isReady(ivec2 pixel) {
  if (isMarked(kFinished)) return false;
#if MANIFOLDS
  if (manifoldStatus() != kManifoldDone) return false;
#endif
  if (isMarked(kInFlight) || imageLoad(filmMean, pixel).w < tracer.sampleTarget) return true;
  finishPixel();
  return false;
}

// The lane's next pixel. False: there is none.
bool takePixel(out ivec2 pixel) {
  while (loopIterations < tracer.iterations) {  // ends: by that
    uint number;
    if (!takeFrom(kReady + turn, number)) return false;
    if (findPixel(number, pixel) && isReady(pixel)) return true;
    ++loopIterations;
  }
  return false;
}

void main() {
  PathNumbers numbers;
  Film film;
  Path path;
  uint where = 0u;
  bool isTracing = false;
  // One traversal serves all rays, since drivers inline every function: each further call site costs registers and
  // minutes of compiling.
  // ends: each ray of a path adds 4 iterations, up to tracer.iterations; between two of them lie at most 256 boundaries
  // that a shadow ray crosses, with kMostCoincident short rays each
  while (true) {
    // A pixel's film, and the path left by the previous submission.
    bool inFlight = true;
    if (!isTracing) {
      ivec2 pixel;
      if (!takePixel(pixel)) break;
      numbers = numbersOf(pixel, imageLoad(filmMean, pixel).w);
#if !SPILLED
      film = readFilm(pixel);
#endif
      where = uint(pixel.x) | uint(pixel.y) << 16u;
      if (isMarked(kInFlight)) restorePath(path);
      else beginPath(path, pixel, numbers);
      shadow.waits = false;
      isTracing = true;
#if MANIFOLDS || WALKING
      if (isMarked(kPathEnded)) inFlight = nextSample(path, film, where, numbers);
#endif
    }
    forget(where, numbers);
    stage = kTraces;
    Ray ray;
    uint skip;
    bool pauses = false;
    if (inFlight) pauses = !setUpRay(path, numbers, ray, skip);
    if (inFlight && !pauses) {
      // The only traversal.
      BvhTraversal traversal = beginRay(ray, skip);
      if (job == kShadowRay) traversal.lampEnd = ray.tMax;
      if (job == kCoincidentRay) traversal.slack = -1.0;
#if INTERIORS || SHADOW_AT_ONCE
      const bool any = false;  // boundaries may let light through
#else
      bool any = job == kShadowRay;
#endif
      for (int left = bvhStepCount(); left > 0 && !isDone(traversal); --left) advanceRay(traversal, any);
      Hit hit = traversal.hit;
      if (!any) hit = finishRay(traversal, ray.direction);
      forget(where, numbers);

      useHit(path, ray, hit, numbers);
      fly(path, numbers);
      arrive(path, numbers);
#if MANIFOLDS
      // The path waits for manifold.comp.
      pauses = (stage == kContinue || stage == kEnds) && manifoldStatus() != kManifoldDone;
      if (pauses) waitsIn = kSeeking + turn;
#endif
      if (!pauses) inFlight = stage != kEnds || nextSample(path, film, where, numbers);
    }
    if (inFlight && !pauses) continue;

    // Store the film, and the path in flight.
    isTracing = false;
#if !SPILLED
    writeFilm(pixelAt(where), film, numbers.sampleIndex - uint(tracer.picture.w));
    if (inFlight) savePath(path);
#endif
    if (!inFlight) finishPixel();
#if MANIFOLDS
    if (pauses && stage == kEnds) mark(kPathEnded);
#endif
    if (pauses) addTo(waitsIn, numberOf(home));
    waitsIn = kReady + 1u - turn;
  }
  atomicMax(longest, loopIterations);
  atomicAdd(allIterations, loopIterations);
#if MEDIA
  atomicAdd(collisions, collisionCount);
#endif
}
