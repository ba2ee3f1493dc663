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
layout(std430, binding = 5) restrict buffer StateBlock {
  uint unfinished;      // pixels of the tile that do not have their samples yet
  uint leakedPaths;     // ended, since they were found outside of the scene, yet inside of a closed boundary
  uint wrongCrossings;  // of boundaries left without having been entered: open or turned meshes
  uint longest;         // turns of loops that a lane took
  // and that all lanes took; below 2^32, as a submission has no more than 2^28 but for the last segments
  uint allTurns;
  uint collisions;      // in media, of all lanes
  uvec4 state[];        // STATE_WORDS a lane, lane by lane within each
};

struct Path {
  vec3 origin;
  uint skip;            // triangle that the ray starts on
  vec3 direction;       // unit
  // density with which it was sampled, 1/sr; 0 where nothing else could have: camera and smooth surfaces
  float pdf;
  vec3 throughput;
  float travelled;      // since the last scattering, along boundaries that change nothing
  vec3 radiance;
  uint scatterings;     // up to here
  uint event;           // place in the sequence of random numbers: one a surface or medium met
  float ior;            // of where the ray is
  uint chain;           // smooth scatterings in a row up to here
#if INTERIORS
  uvec4 inside;         // of which closed boundaries (boundary.glsl)
  // length of the ray before its origin, which lies a little beside a surface; negative: what the origin is too early
  float head;
  uint face;            // that surface, where head is not 0
#endif
};

// Throughput below which roulette begins. In media many weak scatterings make up what is seen, and dying at each of
// them costs more in noise than it saves in time: a slab of albedo 0.5 needs a third of the time for the same error
// with 1/4 as with 1.
#if MEDIA
const float kRouletteBelow = 0.25;
#else
const float kRouletteBelow = 1.0;
#endif

const uint kInFlight = 0x80000000u;  // in the saved event: there is a path to be gone on with

bool counts(uint scatterings) { return scatterings >= tracer.minScatterings && scatterings <= tracer.maxScatterings; }

#if INTERIORS
uniform uvec4 cameraInside;  // of which closed boundaries the camera is
uniform float cameraIor;     // and the index of refraction there
#endif

// What a light adds where the path now is.
vec3 lightOf(Path path, vec3 light) {
#if DIELECTRICS
  light *= cameraIor * cameraIor / (path.ior * path.ior);
#endif
  return path.throughput * light;
}
void addLight(inout Path path, vec3 light) { path.radiance += lightOf(path, light); }

// A lamp that was asked: its ray waits to be traced.
struct Shadow {
  bool waits;
  bool infinite;
  uint skip;
  vec3 light;      // what it adds to the path's radiance where nothing is in the way
  vec3 origin;
  vec3 direction;  // to the lamp, its length the distance; unit to one at infinity
#if INTERIORS
  float tMin;
  float from;      // where the present medium begins
  float ior;
  uint crossed;    // boundaries
  uvec4 inside;    // of which closed boundaries
  uvec4 words;     // random
#endif
};
Shadow shadow;
#if MEDIA
uint collisionCount = 0u;  // of this lane, in this submission
#endif

#if INTERIORS
#include "pathtracer/boundary.glsl"
const uint kPurposeTransmittance = kFreePurpose + 3u;
#endif

// start: where the ray begins, on the triangle `skip`.
void askLight(Path path, vec3 contribution, vec3 start, LightSample light, uint skip, PathNumbers numbers) {
  shadow.waits = true;
  shadow.infinite = light.infinite;
  shadow.skip = skip;
  shadow.light = lightOf(path, contribution);
  shadow.origin = start;
  shadow.direction = light.infinite ? light.direction : light.end - start;
#if INTERIORS
  shadow.tMin = shadow.from = 0.0;
  shadow.ior = iorInside(path.inside);
  shadow.crossed = 0u;
  shadow.inside = path.inside;
  shadow.words = randomWords(numbers, path.event, kPurposeTransmittance);
#endif
}

#if MEDIA
// In media a ray starts nearer to its surface than elsewhere, 8 units in the last place of the triangle's largest
// coordinate, as what lies between may be a good part of a mean free path; and the flight through it is counted.
const float kBeside = 4.76837158203125e-7;  // 2^-21
#endif

// How far beside a surface rays start that leave it.
float gapAt(Surface surface) {
#if FIXED_EPSILON
  return 1e-3;  // scene units, whatever the scene's size [VPT2024]
#elif MEDIA
  return surface.magnitude * kBeside;
#else
  return surface.magnitude * 3.814697265625e-6;  // as offsetRay
#endif
}

// Where a ray starts that leaves a surface towards the side of `normal`.
vec3 beside(Surface surface, vec3 normal) { return surface.position + normal * gapAt(surface); }

// Starts the path's next ray on a surface.
void startAt(inout Path path, Surface surface, uint triangle) {
  float cosine = dot(path.direction, surface.geometricNormal);
  path.origin = beside(surface, cosine > 0.0 ? surface.geometricNormal : -surface.geometricNormal);
  path.skip = triangle;
#if MEDIA
  path.head = surface.magnitude * kBeside / max(abs(cosine), 0.01);
  path.face = triangle;
#endif
}

#if INTERIORS
#include "pathtracer/volume.glsl"
#endif

Path startPath(ivec2 pixel, PathNumbers numbers) {
#if PIXEL_CENTRES
  vec2 place = vec2(pixel) + 0.5;
#else
  vec2 place = vec2(pixel) + randomPair(numbers, 0u, kPurposeFilm);
#endif
  Path path;
  path.origin = tracer.cameraPosition;
  path.skip = kNoHit;
  path.direction = normalize(tracer.firstPixel + place.x * tracer.pixelRight + place.y * tracer.pixelUp);
  path.pdf = 0.0;
  path.throughput = vec3(1.0);
  path.travelled = 0.0;
  path.radiance = vec3(0.0);
  path.scatterings = 0u;
  path.event = 0u;
  path.ior = 1.0;
  path.chain = 0u;
#if INTERIORS
  path.inside = cameraInside;
  path.head = 0.0;
  path.face = 0u;
  path.ior = cameraIor;
#endif
  return path;
}

// What a surface does to light where a path has met it. Lambert: `albedo` is its reflectance; mirrors, conductors:
// reflectance at normal incidence.
struct Facet {
  uint kind;
  vec3 albedo;
  float roughness;
  float eta;       // dielectrics: index on the path's side over the other's
  vec3 normal;     // for shading, on the path's side
};

bool isSmooth(Facet facet) {
#if GLOSSY
  return facet.kind == PATH_MIRROR || (facet.kind != PATH_DIFFUSE && facet.roughness == 0.0);
#else
  return facet.kind != PATH_DIFFUSE;
#endif
}

// BSDF times the cosine of `i`, and the density with which scatter() draws it; not for smooth surfaces. `o` and `i`
// point away from the surface.
vec3 evaluate(Facet facet, vec3 o, vec3 i, out float pdf) {
#if GLOSSY
  if (facet.kind != PATH_DIFFUSE) {
    vec3 t, b;
    tangentFrame(facet.normal, t, b);
    vec3 lo = vec3(dot(o, t), dot(o, b), dot(o, facet.normal)), li = vec3(dot(i, t), dot(i, b), dot(i, facet.normal));
    if (facet.kind == PATH_CONDUCTOR)
      return ggxReflect(lo, li, facet.roughness, pdf) * schlick(facet.albedo, max(dot(lo, normalize(lo + li)), 0.0));
#if ROUGH_DIELECTRICS
    float cosT, share;
    vec3 h = normalize(lo + li);
    float value =
        li.z > 0.0 ? ggxReflect(lo, li, facet.roughness, pdf) : ggxRefract(lo, li, facet.roughness, facet.eta, h, pdf);
    float reflectance = fresnelDielectric(clamp(dot(lo, h), 0.0, 1.0), facet.eta, cosT);
    share = li.z > 0.0 ? reflectance : 1.0 - reflectance;
    pdf *= share;
    return vec3(value * share);
#endif
  }
#endif
  float cosine = max(dot(i, facet.normal), 0.0);
  pdf = cosine / kPi;
  return facet.albedo * pdf;
}

// Draws a direction: multiplies the throughput by what that leaves and sets direction and density, 0 for smooth
// surfaces. False: absorbed.
bool scatter(inout Path path, Facet facet, vec3 geometricNormal, vec2 xi, float choice) {
  if (facet.kind == PATH_DIFFUSE) {
    path.direction = cosineSample(facet.normal, xi);
    path.pdf = dot(path.direction, facet.normal) / kPi;
    path.throughput *= facet.albedo;
    return dot(path.direction, geometricNormal) > 0.0;
  }
  vec3 o = -path.direction;
  vec3 h = facet.normal;
  path.pdf = 0.0;
#if GLOSSY
  bool rough = facet.roughness > 0.0 && facet.kind != PATH_MIRROR;
  vec3 t, b, lo;
  if (rough) {
    tangentFrame(facet.normal, t, b);
    lo = vec3(dot(o, t), dot(o, b), dot(o, facet.normal));
    vec3 lh = ggxSample(lo, facet.roughness, xi);
    h = normalize(lh.x * t + lh.y * b + lh.z * facet.normal);
  }
#endif
  float cosI = clamp(dot(o, h), 0.0, 1.0), cosT = 0.0;
  bool reflects = true;
  float share = 1.0;  // of the two ways
#if DIELECTRICS
  if (facet.kind == PATH_DIELECTRIC) {
    float reflectance = fresnelDielectric(cosI, facet.eta, cosT);
    reflects = choice < reflectance;
    share = reflects ? reflectance : 1.0 - reflectance;
  }
#endif
  vec3 scattered = reflects ? 2.0 * cosI * h - o : (facet.eta * cosI - cosT) * h - facet.eta * o;
  float side = dot(scattered, geometricNormal);
  if (reflects ? side <= 0.0 : side >= 0.0) {  // the shading normal sends it to the wrong side of the face
#if GLOSSY
    if (rough) return false;
#endif
    scattered = reflects ? 2.0 * dot(o, geometricNormal) * geometricNormal - o : -o;
  }
  path.direction = normalize(scattered);
#if GLOSSY
  if (rough) {
    vec3 li = vec3(dot(path.direction, t), dot(path.direction, b), dot(path.direction, facet.normal)), ignored;
    if (reflects ? li.z <= 0.0 : li.z >= 0.0) return false;
    float value = reflects ? ggxReflect(lo, li, facet.roughness, path.pdf)
                           : ggxRefract(lo, li, facet.roughness, facet.eta, ignored, path.pdf);
    if (!(path.pdf > 0.0)) return false;
    path.throughput *= value / path.pdf;
    path.pdf *= share;
  }
  if (facet.kind == PATH_CONDUCTOR) path.throughput *= schlick(facet.albedo, cosI);
#endif
#if MIRRORS
  if (facet.kind == PATH_MIRROR) path.throughput *= facet.albedo;
#endif
  return true;
}

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

// What the path's ray has met, and on from there; false where the path has ended.
#if TOUCHING
bool meet(inout Path path, Hit hit, uvec4 beyond, uvec4 before, PathNumbers numbers) {
#else
bool meet(inout Path path, Hit hit, PathNumbers numbers) {
#endif
  if (hit.triangle == kNoHit) {
#if ENVIRONMENT
    if (counts(path.scatterings)) {
      vec3 radiance = environmentRadiance(path.direction);
#if ENVIRONMENT_PICTURE && NEXT_EVENT
      if (path.pdf > 0.0) radiance *= powerHeuristic(path.pdf, tracer.environmentPick * environmentPdf(path.direction));
#endif
      addLight(path, radiance);
    }
#elif BACKGROUND
    if (path.scatterings == 0u && counts(0u)) addLight(path, tracer.background);  // is seen, but lights nothing
#endif
    return false;
  }
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
  path.travelled += hit.t;
  ++path.event;
#if MEDIA && ROULETTE_AT_SURFACES
  // A turn of [VPT2024, algorithm 3] that went into a medium ends here, at the medium's end.
  if (mediumInside(path.inside) >= 0 &&
      !survivesTurn(path, unitFloat(randomWordPair(numbers, path.event, kPurposeMediumChoice).x)))
    return false;
#endif
#if EMISSION
  if (any(greaterThan(material.emission, vec3(0.0))) && counts(path.scatterings)) {
    vec3 emission = emissionAt(surface.material, hit.triangle, hit.barycentrics);
#if NEXT_EVENT
    if (path.pdf > 0.0) {
      float pdf =
          pickDensity(hit.triangle) * path.travelled * path.travelled / -dot(surface.geometricNormal, path.direction);
      emission *= powerHeuristic(path.pdf, pdf);
    }
#endif
    addLight(path, emission);
  }
#endif
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
  if (path.scatterings >= tracer.maxScatterings) return false;
  Facet facet = Facet(material.kind, material.specular, material.roughness, 1.0, surface.normal);
  // Mirrors and glass are not there for a path that sees the shading normal's back.
  if (facet.kind != PATH_DIFFUSE && !(dot(surface.normal, path.direction) < 0.0))
    facet.normal = surface.geometricNormal;
  if (facet.kind == PATH_DIFFUSE) facet.albedo = albedoAt(surface);
#if DIELECTRICS
  if (facet.kind == PATH_DIELECTRIC) facet.eta = path.ior / iorBeyond;
#endif
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
  // Roulette [Arvo1990]. From a throughput of 1 or more nothing dies for long; then a little does, so that every path
  // ends. Total reflection may catch paths in glass for ever, which hold next to no light: after many smooth
  // scatterings in a row more of them die.
  path.chain = path.pdf == 0.0 ? min(path.chain + 1u, 255u) : 0u;
  float most = path.chain > 32u ? 0.99 : path.event < 1024u ? 1.0 : 0.999;
  float largest = max(path.throughput.x, max(path.throughput.y, path.throughput.z));
#if MEDIA && ROULETTE_AT_SURFACES
  if (mediumInside(path.inside) < 0 && !survivesTurn(path, unitFloat(choice.y))) return false;
#elif ROULETTE_WITHOUT_DIVISION
  if (!(unitFloat(choice.y) < min(largest, min(most, 0.95)))) return false;  // [VPT2024, algorithm 3]
#else
  float survival = min(largest / kRouletteBelow, most);
  if (path.scatterings < 2u) survival = survival > 0.0 ? 1.0 : 0.0;
  if (!(unitFloat(choice.y) < survival)) return false;
  path.throughput /= survival;
#endif
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
  uint slot = uint(lane.y * tracer.tile.z + lane.x), lanes = uint(tracer.picture.z);
  uvec4 saved = state[slot + 4u * lanes];
  Path path;
  if ((saved.x & kInFlight) != 0u) {
    uvec4 w0 = state[slot], w1 = state[slot + lanes], w2 = state[slot + 2u * lanes], w3 = state[slot + 3u * lanes];
    path = Path(uintBitsToFloat(w0.xyz), w0.w, uintBitsToFloat(w1.xyz), uintBitsToFloat(w1.w), uintBitsToFloat(w2.xyz),
                uintBitsToFloat(w2.w), uintBitsToFloat(w3.xyz), w3.w & 0xffffffu, saved.x & ~kInFlight,
                uintBitsToFloat(saved.y), w3.w >> 24u
#if INTERIORS
                ,
                state[slot + 5u * lanes], uintBitsToFloat(saved.z), saved.w
#endif
    );
  } else {
    path = startPath(pixel, numbers);
  }

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
    int stage = kTraces;
    Ray ray = Ray(path.origin, 0.0, path.direction, 3e38);
    uint skip = path.skip;
    if (job == kPathRay) {
      if (loopTurns >= tracer.turns) break;
      loopTurns += 4u;
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
    if (stage == kLit) {
      path.radiance += shadow.light;
      shadow.waits = false;
      job = kPathRay;
      stage = after;
    }

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
      if (shadow.waits && !anyHit(Ray(shadow.origin, 0.0, shadow.direction, shadow.infinite ? 3e38 : 1.0), shadow.skip))
        path.radiance += shadow.light;
      shadow.waits = false;
#else
      if (shadow.waits) {
        job = kShadowRay;
        after = stage;
        stage = kTraces;
      }
#endif
    }
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

  atomicMax(longest, loopTurns);
  atomicAdd(allTurns, loopTurns);
#if MEDIA
  atomicAdd(collisions, collisionCount);
#endif
  imageStore(filmMean, pixel, uvec4(floatBitsToUint(mean), samples));
  imageStore(filmSpread, pixel, uvec4(floatBitsToUint(spread), 0u));
  imageStore(filmRest, pixel, uvec4(floatBitsToUint(rest), 0u));
  state[slot + 4u * lanes] = uvec4(inFlight ? path.event | kInFlight : 0u, floatBitsToUint(path.ior),
#if INTERIORS
                                   floatBitsToUint(path.head), path.face);
#else
                                   0u, 0u);
#endif
  if (!inFlight) return;
  state[slot] = uvec4(floatBitsToUint(path.origin), path.skip);
  state[slot + lanes] = uvec4(floatBitsToUint(path.direction), floatBitsToUint(path.pdf));
  state[slot + 2u * lanes] = uvec4(floatBitsToUint(path.throughput), floatBitsToUint(path.travelled));
  state[slot + 3u * lanes] =
      uvec4(floatBitsToUint(path.radiance), min(path.scatterings, 0xffffffu) | path.chain << 24u);
#if INTERIORS
  state[slot + 5u * lanes] = path.inside;
#endif
  atomicAdd(unfinished, 1u);
}
