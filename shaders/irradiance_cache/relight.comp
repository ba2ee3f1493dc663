// The irradiance of records from what their paths have hit, in a scene that moves: pi times the mean over paths of the
// hit surface's radiance, reflectance / pi times the irradiance of the record that stands for it, and the path's other
// light.
layout(local_size_x = 64) in;
#include "lib/clamped_int.glsl"
#include "shared/bindings.h"
#include "irradiance_cache/common.glsl"
#include "irradiance_cache/work.glsl"
#include "irradiance_cache/kept.glsl"
layout(std430, binding = CACHE_WORK_BUFFER) readonly restrict buffer CacheWorkBlock { CacheWork work; };
layout(std430, binding = CACHE_RECORDS_BUFFER) restrict buffer CacheRecords { CacheRecord records[]; };
layout(std430, binding = CACHE_HITS_BUFFER) readonly restrict buffer CacheHits { CacheHit hits[]; };
#include "irradiance_cache/stands_for.glsl"

void main() {
  uint index = gl_GlobalInvocationID.x;
  if (index >= min(recordCount(work.wanted), uint(CACHE_KEEPING))) return;
  if ((records[index].state & CACHE_KEPT) == 0u) return;
  const float kPi = 3.14159265358979;
  vec3 sum = vec3(0.0);
  for (uint i = 0u; i < uint(CACHE_HITS); ++i) {
    CacheHit hit = hits[index * uint(CACHE_HITS) + i];
    uint slot = hit.slot & CACHE_SLOT_MASK;
    sum += kPi * cacheUnit() * unpackColour(hit.light);
    if (slot != 0u) sum += unpackColour(hit.reflectance) * lightOfSlot(slot - 1u).rgb;
  }
  records[index].irradiance = sum / float(CACHE_HITS);
  records[index].paths = uint(CACHE_HITS);
}
