// Irradiance at records by path tracing: PATHS lanes trace one path each from a record, and their mean is added to
// the record's estimate.
//
// A path leaves the record with cosine weighting and samples one light at each surface, combined by multiple
// importance sampling [Veach1997] as in the path tracer (pathtracer/path.comp), whose triangles, materials, lights and
// random numbers it shares. Every surface is treated as Lambertian, as forward shading treats it. Direct light of the
// sun, spots and omnidirectional lamps is excluded: forward shading adds it per pixel.
// FROM_CELLS, for measurements: instead of the record, the middle of a cell that a lookup at the record would read.
// What surfaces close to a spot or an omnidirectional lamp reflect is found by rays from the lamp: see isFoundFromLamp.
// CACHED: where a path's hit lies among records, their irradiance of the previous frame replaces the rest of the
// path. One bounce per frame thus adds up to all of them; elsewhere, and close to a small lamp, the path continues.
// KEEPS: traces the paths that retrace.comp lists, one per lane, and keeps what they hit (CacheHit) for relight.comp. A
// path ends at the first surface for which a record stands, whose light holds that of lamps as well.
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
#if NEXT_EVENT && (SPOTS || POINTS) && !FROM_CELLS && !KEEPS
#define LAMP_RAYS 1
const uint kRaysOfScattering = 4u;  // a shadow ray and the path's own, and a lamp's with another shadow ray
#else
#define LAMP_RAYS 0
const uint kRaysOfScattering = 2u;
#endif
#if CACHED
#include "irradiance_cache/lookup.glsl"
#if EMISSION
#include "irradiance_cache/small_lamps.glsl"
#endif
#if KEEPS
#include "lib/clamped_int.glsl"
#include "irradiance_cache/kept.glsl"
#include "irradiance_cache/stands_for.glsl"
layout(std430, binding = CACHE_HITS_BUFFER) writeonly restrict buffer CacheHits { CacheHit hits[]; };
CacheHit kept;  // of this lane
vec2 keptBarycentrics;  // of its first hit
#endif
#else
#include "irradiance_cache/common.glsl"
#endif
// unordered CacheRecords: each dispatch changes the records of its own part of the list
layout(std430, binding = CACHE_RECORDS_BUFFER) restrict buffer CacheRecords { CacheRecord records[]; };
#include "irradiance_cache/work.glsl"
#if KEEPS
layout(std430, binding = CACHE_WORK_BUFFER) restrict buffer CacheWorkOfPaths { CacheWork work; };
// aliased CacheSlots: only the winner of an empty slot changes it; all others skip the slot with either value
layout(std430, binding = CACHE_SLOTS_OF_PATHS_BUFFER) restrict buffer CacheSlots { uint slots[]; };
#else
layout(std430, binding = CACHE_WORK_BUFFER) readonly restrict buffer CacheWorkBlock { CacheWork work; };
#endif
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

// A ray from a lamp, which finds a surface that reflects the lamp's light to a path's vertex.
struct LampRay {
  bool waits;
  uint lamp;
  vec3 flux;  // of which each ray has a share
  Ray ray;
};

#if LAMP_RAYS
// Whether light goes from a lamp's ball by way of `surface` to the path's vertex before is found by rays from the lamp:
// where the surface is much closer to the lamp than to that vertex. A path seldom meets it, but then finds a light that
// grows as the inverse square of the distance: bright spots of single records. Not inside of the ball, nor where a
// smooth normal faces the lamp and the triangle hardly does, so that few of the lamp's rays meet it.
// before2: squared distance to the vertex before. All other ways are next-event estimation's.
bool isFoundFromLamp(Surface surface, float before2, PathLight lamp, vec3 direction) {
  vec3 away = lamp.a - surface.position;
  float distance2 = dot(away, away);
  return distance2 < 0.25 * before2 && distance2 > lamp.size * lamp.size &&
         dot(direction, surface.geometricNormal) > 0.25 * dot(direction, surface.normal);
}

// From the lamp that next-event estimation picks, too. To where isFoundFromLamp may hold for a vertex at `position`.
LampRay queueLampRay(vec3 position, uint scatterings, PathNumbers numbers) {
  LampRay result = LampRay(false, 0u, vec3(0.0), Ray(vec3(0.0), 0.0, vec3(1.0), 0.0));
  uvec4 words = randomWords(numbers, scatterings, kPurposePick);
  result.lamp = pick(words);
  PathLight lamp = lights[result.lamp];
  if (lamp.kind != PATH_LIGHT_POINT && lamp.kind != PATH_LIGHT_SPOT) return result;
  vec3 axis = vec3(0.0, 0.0, 1.0);
  float lessCosine = 2.0, falloff = 1.0;
  bool isSpot = lamp.kind == PATH_LIGHT_SPOT;
  if (isSpot) axis = lamp.b, lessCosine = 1.0 - uintBitsToFloat(lamp.q);
  vec3 direction = coneSample(axis, lessCosine, randomPair(numbers, scatterings, kPurposeLight)), t, b;
#if SPOTS
  if (isSpot) falloff = spotFalloff(dot(direction, lamp.b), uintBitsToFloat(lamp.p), uintBitsToFloat(lamp.q));
#endif
  result.flux = lamp.c * (2.0 * kPi * lessCosine * falloff / lamp.probability);
  // A ball's rays in one direction are spread evenly over its disc.
  tangentFrame(direction, t, b);
  float radius2 = unitFloat(words.z), turn = 2.0 * kPi * unitFloat(words.w);
  vec3 start = lamp.a + lamp.size * (sqrt(radius2) * (cos(turn) * t + sin(turn) * b) + sqrt(1.0 - radius2) * direction),
       largest = abs(start);
  float gap = max(largest.x, max(largest.y, largest.z)) * 7.62939453125e-6;  // 2^-17: surfaces in which the lamp lies
  result.ray = Ray(start, gap, direction, 1.001 * (distance(lamp.a, position) + lamp.size));
  result.waits = any(greaterThan(result.flux, vec3(0.0)));
  return result;
}

// From where the lamp's ray has met a surface to the path's vertex.
Shadow queueConnection(LampRay from, Hit hit, Surface surface, uint triangle, vec3 throughput) {
  vec3 start = offsetRay(surface.position, surface.geometricNormal, surface.magnitude), toLamp = -from.ray.direction;
  Shadow shadow = Shadow(false, vec3(0.0), Ray(start, 0.0, vec3(1.0), 1.0), triangle);
  Surface lit = surfaceAt(hit.triangle, hit.barycentrics, from.ray.origin + hit.t * from.ray.direction - start);
  vec3 way = lit.position - start;
  float distance2 = dot(way, way), cosine = dot(toLamp, lit.normal);
  vec3 direction = way * inversesqrt(max(distance2, 1e-30));
  float leaves = dot(direction, surface.normal), arrives = -dot(direction, lit.geometricNormal);
  if (!(leaves > 0.0 && dot(direction, surface.geometricNormal) > 0.0 && arrives > 0.0 && cosine > 0.0)) return shadow;
  PathLight lamp = lights[from.lamp];
  bool isLit = dot(toLamp, shadowStart(lit, hit.triangle).normal) > 0.0;
  if (!isLit || !isFoundFromLamp(lit, distance2, lamp, toLamp)) return shadow;
  shadow.light = throughput * from.flux * wholeAlbedoAt(lit) *
                 (leaves * arrives / (kPi * kPi * distance2) * cosine / dot(toLamp, lit.geometricNormal));
  shadow.ray.direction = way;
  shadow.waits = any(notEqual(shadow.light, vec3(0.0)));
  return shadow;
}
#endif

#if NEXT_EVENT
// Next-event estimation from a surface of reflectance `throughput` * pi over irradiance; before2: squared distance to
// the vertex before; scatterings: including this one.
Shadow queueShadowRay(Surface surface, uint triangle, float before2, vec3 throughput, uint scatterings, bool lampsAlone,
                      PathNumbers numbers) {
  Shadow shadow = Shadow(false, vec3(0.0), Ray(vec3(0.0), 0.0, vec3(1.0), 0.0), kNoHit);
  LightSample light;
  uvec4 words = randomWords(numbers, scatterings, kPurposePick);
  vec2 xi = randomPair(numbers, scatterings, kPurposeLight);
  if (scatterings == 2u) {  // a record's light is that of its paths' first hits: all that decides it is spread evenly
    uvec3 further = furtherWords(numbers, 1u, kPurposeScatter);
    words.xy = uvec2(further.x, further.x * uint(lights.length() - SUN_APART));  // a light, and the rest for its alias
    xi = unitFloat(further.yz);
  }
  if (!sampleLight(surface.position, surface.normal, xi, words, light)) return shadow;
  bool isLamp = light.pdf == 0.0;
  if (isLamp ? scatterings == 1u : lampsAlone) return shadow;
  float cosine = dot(light.direction, surface.normal);
  ShadowStart start =
      isLamp ? shadowStart(surface, triangle)
             : ShadowStart(offsetRay(surface.position, surface.geometricNormal, surface.magnitude),
                           surface.geometricNormal, triangle);
  if (!(cosine > 0.0 && dot(light.direction, start.normal) > 0.0)) return shadow;
#if LAMP_RAYS
  PathLight lamp = lights[pickedLight];
  if (isLamp && !light.infinite && isFoundFromLamp(surface, before2, lamp, light.direction)) return shadow;
#endif
  shadow.light = throughput * light.value * (cosine / kPi);
  if (!isLamp) shadow.light *= powerHeuristic(light.pdf, cosine / kPi);
  shadow.ray =
      Ray(start.origin, 0.0, light.infinite ? light.direction : light.end - start.origin, light.infinite ? 3e38 : 1.0);
  shadow.skip = start.skip;
  shadow.waits = any(notEqual(shadow.light, vec3(0.0)));
  return shadow;
}
#endif

#if KEEPS
// Where no record stands for what a path has hit, makes one there, in the coarsest cascade: in the next frame the path
// ends at it.
void claimFor(Surface surface, uint triangle) {
  int k = grids.shape.y - 1;
  vec3 position = surface.position + cache.rayOrigin, lean = abs(surface.normal);
  vec3 inCells = floor(placeInCells(k, position, surface.normal));
  if (any(lessThan(inCells, vec3(0.0))) || any(greaterThanEqual(inCells, vec3(grids.shape.x)))) return;
  ivec3 cell = clampedInt(inCells, ivec3(0), ivec3(grids.shape.x - 1)) + cache.firstCell[k].xyz;
  int axis = lean.x >= lean.y && lean.x >= lean.z ? 0 : lean.y >= lean.z ? 1 : 2,
      face = faceOf(axis, surface.normal[axis]), slot = slotOf(k, face, cell);
  if (work.wanted >= cache.capacity || atomicCompSwap(slots[slot], 0u, CACHE_CLAIMED) != 0u) return;
  uint index = atomicAdd(work.wanted, 1u);
  slots[slot] = index < cache.capacity ? index + 1u : 0u;
  if (index >= cache.capacity) return;
  atomicMax(work.allGroupsX, index / uint(CACHE_LANES) + 1u);
  records[index] = CacheRecord(ivec4(cell, k * CACHE_FACES + face), triangle,
                               CACHE_FIRST | (surface.front ? CACHE_FRONT : 0u), keptBarycentrics.x, keptBarycentrics.y,
                               vec3(0.0), 0u, position, cache.frame, surface.normal, 0u, vec3(0.0), 0.0, 0.0, 0.0, 0.0,
                               0.0);
}
#endif

// Radiance that reaches the record along one cosine-weighted path; irradiance is pi times its mean.
vec3 followPath(Surface surface, uint triangle, PathNumbers numbers) {
  vec3 radiance = vec3(0.0), throughput = vec3(1.0);
  Shadow shadow;
  shadow.waits = false;
  LampRay lampRay;
  lampRay.waits = false;
  Ray ray;
  float pdf = 0.0, before2 = 0.0;
  uint scatterings = 0u;
  bool arrives = true, ends = false;  // at `surface`; after the pending shadow ray
  bool last = false;                  // the next ray only collects light at its end and does not scatter
  for (uint rays = 0u; rays < kRaysOfScattering * (cache.mostSegments + 2u); ++rays) {
    if (arrives) {
      arrives = false;
      ++scatterings;
      bool cached = false;
#if KEEPS
      if (scatterings == 2u) {
        kept.slot = standsFor(surface.position + cache.rayOrigin, surface.normal);
        kept.reflectance = packColour(throughput);
        kept.t = sqrt(before2);
#if EMISSION
        if (isNearSmallLamp(surface.position, cellOfLight)) kept.slot = 0u;
#endif
        if (kept.slot != 0u) break;
        kept.slot = CACHE_FAR;
        claimFor(surface, triangle);
      }
#endif
#if CACHED
      if (scatterings > 1u) {
        vec3 kept = cachedIrradiance(surface.position + cache.rayOrigin, surface.normal, cached);
#if EMISSION
        if (keepsDirectLight() && isNearSmallLamp(surface.position, cellOfLight)) cached = false;
#endif
        if (cached) radiance += throughput * kept / kPi;
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
        shadow =
            queueShadowRay(surface, triangle, before2, throughput, scatterings, cached && keepsDirectLight(), numbers);
#endif
#if LAMP_RAYS
      if (!cached && counts(scatterings + 1u) && scatterings <= cache.mostSegments)
        lampRay = queueLampRay(surface.position, scatterings, numbers);
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
      if (ends && !shadow.waits && !lampRay.waits) break;
    }
    // One traversal for all kinds of rays, since drivers inline every call.
    bool isShadow = shadow.waits, isLamps = false;
    Ray traced = ray;
    uint skip = triangle;
    if (isShadow) traced = shadow.ray, skip = shadow.skip;
#if LAMP_RAYS
    isLamps = !isShadow && lampRay.waits;
    if (isLamps) traced = lampRay.ray, skip = kNoHit;
#endif
    BvhTraversal traversal = beginRay(traced, skip);
    if (isShadow) traversal.lampEnd = traced.tMax;
    for (int left = bvhStepCount(); left > 0 && !isDone(traversal); --left) advanceRay(traversal, isShadow);
    if (isShadow) {
      if (traversal.hit.triangle == kNoHit) radiance += shadow.light;
      shadow.waits = false;
      if (ends && !lampRay.waits) break;
      continue;
    }
    Hit hit = finishRay(traversal, traced.direction);
#if LAMP_RAYS
    if (isLamps) {
      lampRay.waits = false;
      if (hit.triangle != kNoHit) shadow = queueConnection(lampRay, hit, surface, triangle, throughput);
      if (ends && !shadow.waits) break;
      continue;
    }
#endif
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
    before2 = hit.t * hit.t;
#if KEEPS
    keptBarycentrics = hit.barycentrics;
#endif
#if EMISSION
    if (counts(scatterings)) {
      vec3 emission = emissionAt(surface.material, hit.triangle, hit.barycentrics);
#if NEXT_EVENT
      emission *= powerHeuristic(
          pdf, lampDensityOfHit(hit.triangle, ray.origin, hit.t, -dot(surface.geometricNormal, ray.direction)));
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

#if KEEPS
void main() {
  uint place = (firstGroup + gl_WorkGroupID.x) * uint(CACHE_LANES) + gl_LocalInvocationID.x;
  if (place >= min(work.waiting, uint(lit.length()))) return;
  uint path = lit[place];
  if (path == CACHE_HOLE) return;
  CacheRecord record = records[path / uint(CACHE_HITS)];
  kept = CacheHit(0u, 0u, 0u, 3e38);
  vec3 light = followPath(surfaceOf(record), record.triangle,
                          PathNumbers(pcg4d(uvec4(record.cell)).x, path % uint(CACHE_HITS), tracer.seed));
  kept.light = packColour(light / cacheUnit());
  hits[path] = kept;
}
#else
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
  // Updated as by [Welford1962].
  vec3 change = kPi * sum / float(PATHS) - record.irradiance;
  float squares = record.paths == 0u ? 0.0 : record.squares;
  vec3 inUnits = change / cacheUnit();
  records[index].squares = squares + dot(inUnits, inUnits) * float(record.paths) / float(paths);
  records[index].irradiance = record.irradiance + change * (float(PATHS) / float(paths));
  records[index].paths = paths;
}
#endif
