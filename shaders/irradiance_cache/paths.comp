// Irradiance at records by path tracing: PATHS lanes trace one path each from a record, and their mean is added to
// the record's estimate.
//
// A path leaves the record with cosine weighting and samples one light at each surface, combined by multiple
// importance sampling [Veach1997] as in the path tracer (pathtracer/path.comp), whose triangles, materials, lights and
// random numbers it shares. Every surface is treated as Lambertian, as forward shading treats it. Direct light of the
// sun, spots and omnidirectional lamps is excluded: forward shading adds it per pixel.
// FROM_CELLS, for measurements: instead of the record, the middle of a cell that a lookup at the record would read.
// CACHED: where a path's hit lies among records, their irradiance of the previous frame replaces the rest of the
// path. One bounce per frame thus adds up to all of them; elsewhere the path continues.
layout(local_size_x = 64) in;  // CACHE_LANES; GLSL 4.30 accepts only literals here
#include "shared/bindings.h"
#include "shared/path_tracer.h"
layout(std140, binding = BLOCK_CACHE_PATHS) uniform PathBlock { PathConstants tracer; };
#include "rays/random.glsl"
#include "rays/bsdf.glsl"
#include "rays/materials.glsl"
#include "rays/bvh.glsl"
#include "rays/shadow_start.glsl"
#include "rays/environment.glsl"
#if NEXT_EVENT
#include "rays/lights.glsl"
#endif
#if CACHED
#include "irradiance_cache/lookup.glsl"
#else
#include "irradiance_cache/common.glsl"
#endif
// unordered CacheRecords: each dispatch changes the records of its own part of the list
layout(std430, binding = CACHE_RECORDS_BUFFER) restrict buffer CacheRecords { CacheRecord records[]; };
#include "irradiance_cache/work.glsl"
layout(std430, binding = CACHE_WORK_BUFFER) readonly restrict buffer CacheWorkBlock { CacheWork work; };
#include "irradiance_cache/record_surface.glsl"
layout(std430, binding = CACHE_LIST_BUFFER) readonly restrict buffer CacheLit { uint lit[]; };
uniform uint firstGroup;  // of a part of `lit`
shared vec3 found[CACHE_LANES];

#if FROM_CELLS
#include "cascades/weight.glsl"
const float kLookupOffset = 0.5;  // cells along the normal, as published; 0 to 1 in quarters, it has the least error
// The middle of a cell around a position, drawn with the weight that a trilinear lookup in the cascades gives it; false
// beyond all cascades.
bool drawCell(vec3 position, vec3 normal, PathNumbers numbers, out vec3 middle) {
  uvec4 words = randomWords(numbers, 0u, kPurposeChoice);
  vec3 corner = vec3(unitFloat(words.xy), unitFloat(words.z));
  float drawn = unitFloat(words.w), left = 1.0;
  for (int k = 0; k < grids.shape.y; ++k) {
    float weight = left * cascadeWeight(k, position);
    if (drawn < weight) {
      vec3 texel = (position - grids.cascades[k].minimum) / grids.cascades[k].cellSize,
           place = texel + kLookupOffset * normal - 0.5, low = floor(place);
      vec3 cell = low + vec3(lessThan(corner, place - low));
      cell = clamp(cell, 0.0, float(grids.shape.x - 1));
      middle = grids.cascades[k].minimum + (cell + 0.5) * grids.cascades[k].cellSize;
      return true;
    }
    drawn -= weight;
    left -= weight;
  }
  return false;
}
#endif

bool counts(uint scatterings) { return scatterings >= tracer.minScatterings && scatterings <= tracer.maxScatterings; }

// Whether records store direct light from emissive surfaces and the sky, which lookups then include.
bool keepsDirectLight() { return tracer.minScatterings <= 1u; }

struct Shadow {
  bool waits;
  vec3 light;  // added if nothing blocks it
  Ray ray;
  uint skip;
};

#if NEXT_EVENT
// Next-event estimation from a surface of reflectance `throughput` * pi over irradiance; scatterings: including this
// one.
Shadow queueShadowRay(Surface surface, uint triangle, vec3 throughput, uint scatterings, bool lampsAlone,
                      PathNumbers numbers) {
  Shadow shadow = Shadow(false, vec3(0.0), Ray(vec3(0.0), 0.0, vec3(1.0), 0.0), kNoHit);
  LightSample light;
  if (!sampleLight(surface.position, randomPair(numbers, scatterings, kPurposeLight),
                   randomWords(numbers, scatterings, kPurposePick), light))
    return shadow;
  bool isLamp = light.pdf == 0.0;
  if (isLamp ? scatterings == 1u : lampsAlone) return shadow;
  float cosine = dot(light.direction, surface.normal);
  ShadowStart start =
      isLamp ? shadowStart(surface, triangle)
             : ShadowStart(offsetRay(surface.position, surface.geometricNormal, surface.magnitude),
                           surface.geometricNormal, triangle);
  if (!(cosine > 0.0 && dot(light.direction, start.normal) > 0.0)) return shadow;
  shadow.light = throughput * light.value * (cosine / kPi);
  if (!isLamp) shadow.light *= powerHeuristic(light.pdf, cosine / kPi);
  shadow.ray =
      Ray(start.origin, 0.0, light.infinite ? light.direction : light.end - start.origin, light.infinite ? 3e38 : 1.0);
  shadow.skip = start.skip;
  shadow.waits = any(notEqual(shadow.light, vec3(0.0)));
  return shadow;
}
#endif

// Radiance that reaches the record along one cosine-weighted path; irradiance is pi times its mean.
vec3 followPath(Surface surface, uint triangle, PathNumbers numbers) {
  vec3 radiance = vec3(0.0), throughput = vec3(1.0);
  Shadow shadow;
  shadow.waits = false;
  Ray ray;
  float pdf = 0.0;
  uint scatterings = 0u;
  bool arrives = true, ends = false;  // at `surface`; after the pending shadow ray
  bool last = false;                  // the next ray only collects light at its end and does not scatter
  // Each scattering casts a shadow ray and the path's own.
  for (uint rays = 0u; rays < 2u * (cache.mostSegments + 2u); ++rays) {
    if (arrives) {
      arrives = false;
      ++scatterings;
      bool cached = false;
#if CACHED
      if (scatterings > 1u) {
        vec3 kept = cachedIrradiance(surface.position + cache.rayOrigin, surface.normal, cached);
        radiance += throughput * kept / kPi;
        ends = cached;
#if EMISSION || ENVIRONMENT
        // If records store no direct light of emitters and the sky, this surface lacks it too. One more ray supplies
        // the other half of what next-event estimation finds.
        last = cached && !keepsDirectLight();
        ends = cached && !last;
#endif
      }
#endif
#if NEXT_EVENT
      if (counts(scatterings))
        shadow = queueShadowRay(surface, triangle, throughput, scatterings, cached && keepsDirectLight(), numbers);
#endif
      if (!ends) {
        vec3 direction = cosineSample(surface.normal, randomPair(numbers, scatterings, kPurposeScatter));
        pdf = dot(direction, surface.normal) / kPi;
        ray = Ray(offsetRay(surface.position, surface.geometricNormal, surface.magnitude), 0.0, direction, 3e38);
        ends = !(dot(direction, surface.geometricNormal) > 0.0) || scatterings >= cache.mostSegments + 1u ||
               loopIterations >= tracer.iterations;
#if FROM_CELLS
        if (scatterings == 1u) {
          // Two bands of the radiance L there give the irradiance E = integral of L (1/4 + <n, w> / 2) dw
          // [Ramamoorthi2001]; pi times this factor is what a uniformly drawn direction counts.
          vec3 middle;
          if (!drawCell(surface.position + cache.rayOrigin, surface.normal, numbers, middle)) break;
          vec2 xi = randomPair(numbers, scatterings, kPurposeScatter);
          float z = 1.0 - 2.0 * xi.x, sine = sqrt(max(1.0 - z * z, 0.0)), turn = 2.0 * kPi * xi.y;
          direction = vec3(sine * cos(turn), sine * sin(turn), z);
          throughput = vec3(1.0 + 2.0 * dot(surface.normal, direction));
          ray = Ray(middle - cache.rayOrigin, 0.0, direction, 3e38);
          triangle = kNoHit;
          ends = false;
        }
#endif
      }
      if (ends && !shadow.waits) break;
    }
    // One traversal for both kinds of rays, since drivers inline every call.
    bool isShadow = shadow.waits;
    Ray traced = ray;
    if (isShadow) traced = shadow.ray;
    BvhTraversal traversal = beginRay(traced, isShadow ? shadow.skip : triangle);
    if (isShadow) traversal.lampEnd = traced.tMax;
    for (int left = bvhNodeCount(); left > 0 && !isDone(traversal); --left) advanceRay(traversal, isShadow);
    if (isShadow) {
      if (traversal.hit.triangle == kNoHit) radiance += shadow.light;
      shadow.waits = false;
      if (ends) break;
      continue;
    }
    Hit hit = finishRay(traversal, traced.direction);
    if (hit.triangle == kNoHit) {
#if ENVIRONMENT
      if (counts(scatterings)) {
        vec3 sky = environmentRadiance(ray.direction);
#if ENVIRONMENT_PICTURE && NEXT_EVENT
        sky *= powerHeuristic(pdf, tracer.environmentPick * environmentPdf(ray.direction));
#endif
        radiance += throughput * sky;
      }
#endif
      break;
    }
    surface = surfaceAt(hit.triangle, hit.barycentrics, ray.direction);
    triangle = hit.triangle;
#if EMISSION
    if (counts(scatterings)) {
      vec3 emission = emissionAt(surface.material, hit.triangle, hit.barycentrics);
#if NEXT_EVENT
      emission *=
          powerHeuristic(pdf, pickDensity(hit.triangle) * hit.t * hit.t / -dot(surface.geometricNormal, ray.direction));
#endif
      radiance += throughput * emission;
    }
#endif
    if (last || scatterings >= tracer.maxScatterings) break;
    throughput *= wholeAlbedoAt(surface);
    // Russian roulette [Arvo1990]
    float survival = scatterings < 3u ? 1.0 : min(max(throughput.x, max(throughput.y, throughput.z)), 1.0);
    if (!(unitFloat(randomWords(numbers, scatterings, kPurposeChoice).x) < survival)) break;
    throughput /= survival;
    arrives = true;
  }
  return radiance;
}

void main() {
  uint lane = gl_LocalInvocationID.x,
       place = ((firstGroup + gl_WorkGroupID.x) * uint(CACHE_LANES) + lane) / uint(PATHS);
  bool there = place < min(work.waiting, uint(lit.length()));
  uint index = there ? min(lit[place], uint(records.length()) - 1u) : 0u;
  CacheRecord record = records[index];
  found[lane] = vec3(0.0);
  if (there) {
    Surface surface = surfaceOf(record);
    // The record's place determines the random numbers, not the order in which records were found.
    found[lane] =
        followPath(surface, record.triangle,
                   PathNumbers(pcg4d(uvec4(record.cell)).x, record.paths + lane % uint(PATHS), tracer.seed));
  }
  barrier();
  if (!there || lane % uint(PATHS) != 0u) return;
  vec3 sum = vec3(0.0);
  for (uint i = 0u; i < uint(PATHS); ++i) sum += found[lane + i];
  uint paths = record.paths + uint(PATHS);
  records[index].irradiance = record.irradiance + (kPi * sum - float(PATHS) * record.irradiance) / float(paths);
  records[index].paths = paths;
}
