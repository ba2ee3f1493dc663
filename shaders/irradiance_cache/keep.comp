// Runs after the cascades or surfaces have moved: keeps the records whose cell is still inside, and registers their
// slots again. FOLLOWS: after surfaces or lights have moved. Records at surfaces that were or are others are dropped;
// the rest lacks all their paths again, but keeps what these have hit.
layout(local_size_x = 64) in;
#include "irradiance_cache/common.glsl"
#include "irradiance_cache/work.glsl"
layout(std430, binding = CACHE_WORK_BUFFER) restrict buffer CacheWorkBlock { CacheWork work; };
layout(std430, binding = CACHE_RECORDS_BUFFER) readonly restrict buffer CacheRecords { CacheRecord before[]; };
layout(std430, binding = CACHE_SLOTS_BUFFER) writeonly restrict buffer CacheSlots { uint slots[]; };
layout(std430, binding = CACHE_KEPT_BUFFER) writeonly restrict buffer CacheKept { CacheRecord records[]; };
layout(std430, binding = CACHE_WORK_BEFORE_BUFFER) readonly restrict buffer CacheWorkBefore { uint workBefore[]; };
#if FOLLOWS
layout(std430, binding = CACHE_MOVED_BUFFER) readonly restrict buffer CacheMoved { MovedBox moved[]; };
uniform uint movedBoxes;
#if KEEPS
layout(std430, binding = CACHE_HITS_BEFORE_BUFFER) readonly restrict buffer CacheHitsBefore { CacheHit hitsBefore[]; };
layout(std430, binding = CACHE_HITS_BUFFER) writeonly restrict buffer CacheHits { CacheHit hits[]; };
#endif

// Also beside them, by a cell: a slot may hold what they hide now, or have hidden.
bool isMoved(vec3 position, float cellSize) {
  bool isIn = false;
  for (uint i = 0u; i < movedBoxes && !isIn; ++i)
    isIn = all(greaterThanEqual(position, moved[i].least - cellSize)) &&
           all(lessThanEqual(position, moved[i].most + cellSize));
  return isIn;
}
#endif

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= min(workBefore[3], cache.capacity)) return;
  CacheRecord r = before[i];
  if (isPart(r.cell)) return;  // finished pictures find theirs anew
  int cascade = cascadeOf(r.cell);
  ivec3 place = r.cell.xyz - cache.firstCell[cascade].xyz;
  bool isInside = all(greaterThanEqual(place, ivec3(0))) && all(lessThan(place, ivec3(grids.shape.x)));
  if (r.triangle == CACHE_NOWHERE || !isInside) return;
#if FOLLOWS
  if (r.triangle == CACHE_UNPLACED || isMoved(r.position, grids.cascades[cascade].cellSize)) return;
  uint stateBefore = r.state;
  r.state = (r.state & (CACHE_FRONT | CACHE_NARROW)) | CACHE_FIRST;
  r.irradiance = vec3(0.0);
  r.paths = 0u;
  r.blendWeight = 0.0;
#endif
  uint index = atomicAdd(work.wanted, 1u);
  atomicMax(work.allGroupsX, index / uint(CACHE_LANES) + 1u);
#if FOLLOWS && KEEPS
  if ((stateBefore & CACHE_KEPT) != 0u && i < uint(CACHE_KEEPING) && index < uint(CACHE_KEEPING)) {
    r.state |= CACHE_KEPT;
    for (uint k = 0u; k < uint(CACHE_HITS); ++k)
      hits[index * uint(CACHE_HITS) + k] = hitsBefore[i * uint(CACHE_HITS) + k];
  }
#endif
  records[index] = r;
  slots[slotOf(cascade, r.cell.w % CACHE_FACES, r.cell.xyz)] = index + 1u;
}
