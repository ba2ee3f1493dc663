// Path tracing: one invocation a pixel follows its paths one after the other, segment by segment, and starts the next as soon as one has
// ended, until the pixel has its samples or this submission's segments are used up; the unfinished path then waits in the state buffer.
// So every submission is bounded however long paths get, and no path is dropped: dropping the long ones would bias the picture.
//
// A path: camera ray, then at each surface next-event estimation towards one light and a new direction drawn from the surface, weighted
// against each other [Veach1997], and Russian roulette. `throughput` is without the squares of refractive indices, as L / n^2 is what a
// boundary conserves; what a light adds is multiplied by (n_camera / n_here)^2 instead.
// Film: three images of 32-bit words that hold floats' bits: mean and number of samples; sum of squared deviations [Welford1962]; the
// mean's rest below a float's last place, so that it does not stall however many samples there are.
layout(local_size_x = 8, local_size_y = 8) in;
#include "shared/path_tracer.h"
layout(std140, binding = 0) uniform PathBlock { PathConstants tracer; };

#include "pathtracer/random.glsl"
#include "pathtracer/bsdf.glsl"
#include "pathtracer/fresnel.glsl"
#include "pathtracer/materials.glsl"
#include "pathtracer/bvh.glsl"
#include "pathtracer/environment.glsl"
#include "pathtracer/lights.glsl"

layout(rgba32ui, binding = 0) uniform uimage2D filmMean;    // xyz and, as an integer, the number of samples
layout(rgba32ui, binding = 1) uniform uimage2D filmSpread;  // sum of squared deviations; w unused
layout(rgba32ui, binding = 2) uniform uimage2D filmRest;
layout(std430, binding = 5) restrict buffer StateBlock {
  uint unfinished;      // pixels of the tile that do not have their samples yet
  uint leakedPaths;     // ended, since they were found outside of the scene, yet inside of a closed boundary
  uint wrongCrossings;  // of boundaries left without having been entered: open or turned meshes
  uint padding;
  uvec4 state[];        // STATE_WORDS a lane, lane by lane within each
};

struct Path {
  vec3 origin;
  uint skip;            // triangle that the ray starts on
  vec3 direction;       // unit
  float pdf;            // density with which it was sampled, 1/sr; 0 where nothing else could have: camera and smooth surfaces
  vec3 throughput;
  float travelled;      // since the last scattering, along boundaries that change nothing
  vec3 radiance;
  uint scatterings;     // up to here
  uint event;           // place in the sequence of random numbers: one a surface or medium met
  float ior;            // of where the ray is
#if INTERIORS
  uvec4 inside;         // of which closed boundaries (boundary.glsl)
#endif
};

const uint kInFlight = 0x80000000u;  // in the saved event: there is a path to be gone on with

bool counts(uint scatterings) { return scatterings >= tracer.minScatterings && scatterings <= tracer.maxScatterings; }

#if INTERIORS
uniform uvec4 cameraInside;  // of which closed boundaries the camera is
uniform float cameraIor;     // and the index of refraction there
#endif

// What a light adds where the path now is.
void addLight(inout Path path, vec3 light) {
#if DIELECTRICS
  light *= cameraIor * cameraIor / (path.ior * path.ior);
#endif
  path.radiance += path.throughput * light;
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
#if INTERIORS
  path.inside = cameraInside;
  path.ior = cameraIor;
#endif
  return path;
}

// How much light gets through on a straight line; nothing that refracts lets any through.
vec3 visibility(Path path, Surface surface, uint triangle, LightSample light, PathNumbers numbers) {
  float side = dot(light.direction, surface.geometricNormal) > 0.0 ? 1.0 : -1.0;
  vec3 start = offsetRay(surface.position, side * surface.geometricNormal, surface.magnitude);
#if INTERIORS
  return straightTransmittance(start, light.infinite ? light.direction : light.end, light.infinite, triangle, path.inside,
                               randomWords(numbers, path.event, kPurposeTransmittance));
#else
  Ray ray = light.infinite ? Ray(start, 0.0, light.direction, 3e38) : Ray(start, 0.0, light.end - start, 1.0);
  return anyHit(ray, triangle) ? vec3(0.0) : vec3(1.0);
#endif
}

#if NEXT_EVENT
void addNextEvent(inout Path path, Surface surface, uint triangle, vec3 albedo, PathNumbers numbers) {
  LightSample light;
  if (!sampleLight(surface.position, randomPair(numbers, path.event, kPurposeLight), randomWords(numbers, path.event, kPurposePick), light)) return;
  float cosine = dot(light.direction, surface.normal);
  if (!(cosine > 0.0 && dot(light.direction, surface.geometricNormal) > 0.0)) return;
  vec3 contribution = albedo * (cosine / kPi) * light.value;
#if MIS
  if (light.pdf > 0.0) contribution *= powerHeuristic(light.pdf, cosine / kPi);
#endif
  if (all(equal(contribution, vec3(0.0)))) return;
  addLight(path, contribution * visibility(path, surface, triangle, light, numbers));
}
#endif

// Follows the path's ray to what it meets and on from there; false where the path has ended.
bool extend(inout Path path, PathNumbers numbers) {
#if MEDIA
  // In a homogeneous medium the flight is drawn first: rays that need not go far are cheap.
  int medium = mediumInside(path.inside);
  float flight = medium >= 0 ? beginFlight(path, media[medium], numbers) : 3e38;
  Hit hit = closestHit(Ray(path.origin, 0.0, path.direction, flight), path.skip);
  if (medium >= 0) {
    int became = crossMedium(path, media[medium], flight, hit, numbers);
    if (became != kArrives) return became == kScattered;
  }
#else
  Hit hit = closestHit(Ray(path.origin, 0.0, path.direction, 3e38), path.skip);
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
  PathMaterial material = materials[surface.material];
  path.travelled += hit.t;
  ++path.event;
#if EMISSION
  if (any(greaterThan(material.emission, vec3(0.0))) && counts(path.scatterings)) {
    vec3 emission = emissionAt(surface.material, hit.triangle, hit.barycentrics);
#if NEXT_EVENT
    if (path.pdf > 0.0) {
      float pdf = material.pickDensity * path.travelled * path.travelled / -dot(surface.geometricNormal, path.direction);
      emission *= powerHeuristic(path.pdf, pdf);
    }
#endif
    addLight(path, emission);
  }
#endif
#if INTERIORS
  uvec4 beyond = path.inside;
  float iorBeyond = path.ior;
  int rank = int(material.boundary);
  if (rank >= 0) {
    if (!crossBoundary(beyond, rank, surface.front)) atomicAdd(wrongCrossings, 1u);
    iorBeyond = iorInside(beyond);
    if (iorBeyond == path.ior) {  // nothing refracts: another medium, or a boundary that a higher one covers
      path.inside = beyond;
      path.origin = offsetRay(surface.position, -surface.geometricNormal, surface.magnitude);
      path.skip = hit.triangle;
      return true;
    }
  }
#endif
  if (path.scatterings >= tracer.maxScatterings) return false;
  ++path.scatterings;
  path.travelled = 0.0;
  uvec4 choice = randomWords(numbers, path.event, kPurposeChoice);
#if MIRRORS || DIELECTRICS
  // By the shading normal, unless that sends the ray to the wrong side of the face.
  vec3 normal = dot(surface.normal, path.direction) < 0.0 ? surface.normal : surface.geometricNormal;
#endif
#if MIRRORS
  if (material.kind == PATH_MIRROR) {
    path.pdf = 0.0;
    path.throughput *= material.specular;
    vec3 mirrored = reflect(path.direction, normal);
    path.direction = dot(mirrored, surface.geometricNormal) > 0.0 ? mirrored : reflect(path.direction, surface.geometricNormal);
  }
#endif
#if DIELECTRICS
  if (material.kind == PATH_DIELECTRIC) {
    path.pdf = 0.0;
    float eta = path.ior / iorBeyond, cosT, cosI = -dot(normal, path.direction), reflectance = fresnelDielectric(cosI, eta, cosT);
    if (unitFloat(choice.x) < reflectance) {
      vec3 mirrored = reflect(path.direction, normal);
      path.direction = dot(mirrored, surface.geometricNormal) > 0.0 ? mirrored : reflect(path.direction, surface.geometricNormal);
    } else {
      vec3 refracted = normalize(eta * path.direction + (eta * cosI - cosT) * normal);
      path.direction = dot(refracted, surface.geometricNormal) < 0.0 ? refracted : path.direction;
      path.ior = iorBeyond;
      path.inside = beyond;
    }
  }
#endif
  if (material.kind == PATH_DIFFUSE) {
    vec3 albedo = albedoAt(surface);
#if NEXT_EVENT
    if (counts(path.scatterings)) addNextEvent(path, surface, hit.triangle, albedo, numbers);
#endif
#if !SCATTERED_LIGHT
    if (path.scatterings >= tracer.maxScatterings) return false;  // nothing more could be found
#endif
    path.direction = cosineSample(surface.normal, randomPair(numbers, path.event, kPurposeScatter));
    if (!(dot(path.direction, surface.geometricNormal) > 0.0)) return false;
    path.pdf = dot(path.direction, surface.normal) / kPi;
    path.throughput *= albedo;
  }
  // Roulette [Arvo1990]. From a throughput of 1 or more nothing dies for long; then a little does, so that every path ends.
  float survival = min(max(path.throughput.x, max(path.throughput.y, path.throughput.z)), path.event < 1024u ? 1.0 : 0.999);
  if (path.scatterings < 2u) survival = survival > 0.0 ? 1.0 : 0.0;
  if (!(unitFloat(choice.y) < survival)) return false;
  path.throughput /= survival;
  bool leaves = dot(path.direction, surface.geometricNormal) > 0.0;
  path.origin = offsetRay(surface.position, leaves ? surface.geometricNormal : -surface.geometricNormal, surface.magnitude);
  path.skip = hit.triangle;
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

void main() {
  ivec2 lane = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(lane, tracer.tile.zw))) return;
  ivec2 pixel = tracer.tile.xy + lane;
  uvec4 meanWords = imageLoad(filmMean, pixel);
  uint samples = meanWords.w;
  if (samples >= tracer.sampleTarget) return;
  vec3 mean = uintBitsToFloat(meanWords.xyz), rest = uintBitsToFloat(imageLoad(filmRest, pixel).xyz);
  vec3 spread = uintBitsToFloat(imageLoad(filmSpread, pixel).xyz);

  PathNumbers numbers = PathNumbers(uint(pixel.y * tracer.picture.x + pixel.x), samples, tracer.seed);
  uint slot = uint(lane.y * tracer.tile.z + lane.x), lanes = uint(tracer.picture.z);
  uvec4 saved = state[slot + 4u * lanes];
  Path path;
  if ((saved.x & kInFlight) != 0u) {
    uvec4 w0 = state[slot], w1 = state[slot + lanes], w2 = state[slot + 2u * lanes], w3 = state[slot + 3u * lanes];
    path = Path(uintBitsToFloat(w0.xyz), w0.w, uintBitsToFloat(w1.xyz), uintBitsToFloat(w1.w), uintBitsToFloat(w2.xyz), uintBitsToFloat(w2.w),
                uintBitsToFloat(w3.xyz), w3.w, saved.x & ~kInFlight, uintBitsToFloat(saved.y)
#if INTERIORS
                , state[slot + 5u * lanes]
#endif
                );
  } else {
    path = startPath(pixel, numbers);
  }

  bool inFlight = true;
  for (uint segment = 0u; segment < tracer.segments; ++segment) {
    if (extend(path, numbers)) continue;
    ++samples;
    vec3 difference = (path.radiance - mean) - rest;
    mean = twoSum(mean, rest + difference / float(samples), rest);
    spread += difference * ((path.radiance - mean) - rest);
    numbers.sampleIndex = samples;
    if (samples >= tracer.sampleTarget) {
      inFlight = false;
      break;
    }
    path = startPath(pixel, numbers);
  }

  imageStore(filmMean, pixel, uvec4(floatBitsToUint(mean), samples));
  imageStore(filmSpread, pixel, uvec4(floatBitsToUint(spread), 0u));
  imageStore(filmRest, pixel, uvec4(floatBitsToUint(rest), 0u));
  state[slot + 4u * lanes] = uvec4(inFlight ? path.event | kInFlight : 0u, floatBitsToUint(path.ior), 0u, 0u);
  if (!inFlight) return;
  state[slot] = uvec4(floatBitsToUint(path.origin), path.skip);
  state[slot + lanes] = uvec4(floatBitsToUint(path.direction), floatBitsToUint(path.pdf));
  state[slot + 2u * lanes] = uvec4(floatBitsToUint(path.throughput), floatBitsToUint(path.travelled));
  state[slot + 3u * lanes] = uvec4(floatBitsToUint(path.radiance), path.scatterings);
#if INTERIORS
  state[slot + 5u * lanes] = path.inside;
#endif
  atomicAdd(unfinished, 1u);
}
