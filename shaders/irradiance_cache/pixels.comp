// Records that are in no cell: one at the surface that each of these pixels shows. For measurements.
layout(local_size_x = 64) in;
#include "shared/bindings.h"
#include "shared/path_tracer.h"
layout(std140, binding = BLOCK_CACHE_PATHS) uniform PathBlock { PathConstants tracer; };
#include "rays/random.glsl"
#include "rays/bsdf.glsl"
#include "rays/materials.glsl"
#include "rays/bvh.glsl"
#include "irradiance_cache/common.glsl"
#include "irradiance_cache/work.glsl"
layout(std430, binding = CACHE_WORK_BUFFER) restrict buffer CacheWorkBlock { CacheWork work; };
#include "irradiance_cache/seen.glsl"
layout(std430, binding = CACHE_RECORDS_BUFFER) writeonly restrict buffer CacheRecords { CacheRecord records[]; };
layout(std430, binding = CACHE_LIST_BUFFER) writeonly restrict buffer CacheLit { uint lit[]; };
uniform uint first, pixels;
uniform int round;  // gives other random numbers

void main() {
  uint index = gl_GlobalInvocationID.x, pixel = first + index;
  if (index >= pixels) return;
  CacheRecord record;
  record.cell = ivec4(pixel, round, 0, 0);
  record.triangle = CACHE_NOWHERE;
  record.state = 0u;
  record.second = record.third = record.blendWeight = 0.0;
  record.irradiance = record.shown = record.position = record.normal = vec3(0.0);
  record.paths = record.born = 0u;
  record.pixel = pixel;
  Hit hit;
  Surface surface;
  if (seenAt(int(pixel), hit, surface)) {
    record.triangle = hit.triangle;
    record.position = surface.position + cache.rayOrigin;
    record.normal = surface.normal;
    record.second = hit.barycentrics.x;
    record.third = hit.barycentrics.y;
    record.state = surface.front ? CACHE_FRONT : 0u;
    uint place = atomicAdd(work.waiting, 1u);
    uint group = place / uint(CACHE_LANES / PATHS);
    atomicMax(work.litGroups[3u * (group / uint(CACHE_PART_GROUPS))], group % uint(CACHE_PART_GROUPS) + 1u);
    if (place < uint(lit.length())) lit[place] = index;
  }
  records[index] = record;
}
