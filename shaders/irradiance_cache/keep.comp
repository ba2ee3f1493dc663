// Runs after the cascades have moved: keeps the records whose cell is still inside, and registers their slots again.
layout(local_size_x = 64) in;
#include "irradiance_cache/common.glsl"
#include "irradiance_cache/work.glsl"
layout(std430, binding = CACHE_WORK_BUFFER) restrict buffer CacheWorkBlock { CacheWork work; };
layout(std430, binding = CACHE_RECORDS_BUFFER) readonly restrict buffer CacheRecords { CacheRecord before[]; };
layout(std430, binding = CACHE_SLOTS_BUFFER) writeonly restrict buffer CacheSlots { uint slots[]; };
layout(std430, binding = CACHE_KEPT_BUFFER) writeonly restrict buffer CacheKept { CacheRecord records[]; };
layout(std430, binding = CACHE_WORK_BEFORE_BUFFER) readonly restrict buffer CacheWorkBefore { uint workBefore[]; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= min(workBefore[3], cache.capacity)) return;
  CacheRecord r = before[i];
  int cascade = r.cell.w / CACHE_FACES;
  ivec3 place = r.cell.xyz - cache.firstCell[cascade].xyz;
  bool isInside = all(greaterThanEqual(place, ivec3(0))) && all(lessThan(place, ivec3(grids.shape.x)));
  if (r.triangle == CACHE_NOWHERE || !isInside) return;
  uint index = atomicAdd(work.wanted, 1u);
  atomicMax(work.allGroupsX, index / uint(CACHE_LANES) + 1u);
  records[index] = r;
  slots[slotOf(cascade, r.cell.w % CACHE_FACES, r.cell.xyz)] = index + 1u;
}
