// Lists the paths that must be traced anew in a scene that moves: those of new records, those whose light goes further
// than to a record, those whose record is gone, and those with a ray that crosses a box in which surfaces have moved
// (the ray to what they hit, or the shadow ray to an emissive surface). `budget`: how many of those that have been
// traced before; the rest stay as they are, and are listed in a later frame.
// MOVED: surfaces have moved, not lights alone.
layout(local_size_x = 64) in;
#include "lib/clamped_int.glsl"
#include "shared/bindings.h"
#include "shared/path_tracer.h"
layout(std140, binding = BLOCK_CACHE_PATHS) uniform PathBlock { PathConstants tracer; };
#include "rays/random.glsl"
#include "rays/bsdf.glsl"
#include "rays/materials.glsl"
#include "rays/bvh.glsl"
#include "rays/environment.glsl"
#if NEXT_EVENT
#include "rays/lights.glsl"
#endif
#include "irradiance_cache/common.glsl"
#include "irradiance_cache/work.glsl"
layout(std430, binding = CACHE_WORK_BUFFER) restrict buffer CacheWorkBlock { CacheWork work; };
layout(std430, binding = CACHE_RECORDS_BUFFER) restrict buffer CacheRecords { CacheRecord records[]; };
#include "irradiance_cache/record_surface.glsl"
#include "irradiance_cache/stands_for.glsl"
layout(std430, binding = CACHE_LIST_BUFFER) writeonly restrict buffer CacheTraced { uint traced[]; };
layout(std430, binding = CACHE_HITS_BUFFER) restrict buffer CacheHits { CacheHit hits[]; };
#if MOVED
layout(binding = UNIT_CACHE_MOVED) uniform samplerBuffer movedCorners;  // two per box: least, most
uniform int movedBoxes;
#endif
uniform uint budget;
uniform bool allAnew;

#if MOVED
// Whether the part of a ray from 0 to `end` meets a box in which surfaces have moved.
bool crosses(vec3 origin, vec3 direction, float end) {
  for (int i = 0; i < movedBoxes; ++i) {
    vec3 least = texelFetch(movedCorners, 2 * i).xyz - cache.rayOrigin,
         most = texelFetch(movedCorners, 2 * i + 1).xyz - cache.rayOrigin,
         gap = 1e-4 * (most - least) + 1e-6 * max(abs(least), abs(most)), d = direction;
    d = mix(d, vec3(1e-20), lessThan(abs(d), vec3(1e-20)));
    vec3 a = (least - gap - origin) / d, b = (most + gap - origin) / d, low = min(a, b), high = max(a, b);
    if (max(max(low.x, low.y), max(low.z, 0.0)) <= min(min(high.x, high.y), min(high.z, end))) return true;
  }
  return false;
}

// The ray of a path's first vertex to what it hits, at `t`, and that to an emissive surface; their random numbers are
// those of paths.comp.
bool pathCrosses(Surface surface, PathNumbers numbers, float t) {
  if (crosses(surface.position, cosineSample(surface.normal, randomPair(numbers, 1u, kPurposeScatter)), t)) return true;
#if NEXT_EVENT
  LightSample light;
  if (sampleLight(surface.position, surface.normal, randomPair(numbers, 1u, kPurposeLight),
                  randomWords(numbers, 1u, kPurposePick), light) &&
      light.pdf > 0.0)
    return light.infinite ? crosses(surface.position, light.direction, 3e38)
                          : crosses(surface.position, light.end - surface.position, 1.0);
#endif
  return false;
}
#endif

bool isListed(CacheHit hit, Surface surface, PathNumbers numbers) {
  uint slot = hit.slot & CACHE_SLOT_MASK;
  if ((hit.slot & (CACHE_FAR | CACHE_STALE)) != 0u) return true;
  if (slot != 0u && !(lightOfSlot(slot - 1u).w > 0.0)) return true;
#if MOVED
  return pathCrosses(surface, numbers, hit.t);
#else
  return false;
#endif
}

void main() {
  uint count = min(recordCount(work.wanted), uint(CACHE_KEEPING));
  if (gl_GlobalInvocationID.x >= count) return;
  // The list begins with other records in each frame, so that no path waits for ever.
  uint index = (gl_GlobalInvocationID.x + cache.frame % 64u * (count / 64u)) % count;
  CacheRecord record = records[index];
  if (record.triangle == CACHE_UNPLACED || record.triangle == CACHE_NOWHERE) return;
  bool isKept = (record.state & CACHE_KEPT) != 0u;
  Surface surface = surfaceOf(record);
  uint pixel = pcg4d(uvec4(record.cell)).x;
  records[index].state = record.state | CACHE_KEPT;
  for (uint i = 0u; i < uint(CACHE_HITS); ++i) {
    uint path = index * uint(CACHE_HITS) + i;
    CacheHit hit = CacheHit(0u, 0u, 0u, 0.0);
    if (isKept) hit = hits[path];
    if (isKept && !allAnew && !isListed(hit, surface, PathNumbers(pixel, i, tracer.seed))) continue;
    uint place = atomicAdd(work.waiting, 1u);
    atomicAdd(work.traced, 1u);
    if (place >= uint(traced.length())) continue;
    uint group = place / uint(CACHE_LANES);
    atomicMax(work.litGroups[3u * (group / uint(CACHE_PART_GROUPS))], group % uint(CACHE_PART_GROUPS) + 1u);
    bool waits = isKept && place >= budget;
    traced[place] = waits ? CACHE_HOLE : path;
    if (waits) hits[path].slot = hit.slot | CACHE_STALE;
  }
}
