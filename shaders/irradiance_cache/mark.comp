// Marks the slots that the camera needs. Each pixel names those of its cell, in every cascade that contributes there,
// for each axis that its normal leans to. The prefetch points around the camera do so too, in the coarsest cascades;
// they come after the picture's pixels. Slots with a record keep it. An empty slot goes to the pixel nearest to its
// cell's centre and most aligned with its axis: an actual point, because the mean of several would lie buried in edges
// and corners.
// PARTS: the same for the parts of cells that list.comp has split.
// First pass: the best key of each empty slot, and a list of the pixels that found one. Second pass, CLAIM, over that
// list: the winner creates the record.
#if CLAIM
layout(local_size_x = 64) in;  // CACHE_LANES; GLSL 4.30 accepts only literals here
#else
layout(local_size_x = 8, local_size_y = 8) in;
#endif
#include "lib/clamped_int.glsl"
#include "irradiance_cache/common.glsl"
#include "irradiance_cache/work.glsl"
layout(std430, binding = CACHE_WORK_BUFFER) restrict buffer CacheWorkBlock { CacheWork work; };
#include "irradiance_cache/cascade_weight.glsl"
#include "forward/visible.glsl"
#if PARTS
#include "irradiance_cache/parts.glsl"
#endif
layout(binding = UNIT_CACHE_SLOTS) uniform usamplerBuffer cacheSlots;  // 0: empty, else the record's index + 1
#if CLAIM
layout(binding = UNIT_CACHE_KEYS) uniform usamplerBuffer cacheKeys;
layout(std430, binding = CACHE_RECORDS_BUFFER) writeonly restrict buffer CacheRecords { CacheRecord records[]; };
// aliased CacheSlots: only the winner of an empty slot changes it; all others skip the slot with either value
layout(std430, binding = CACHE_SLOTS_BUFFER) writeonly restrict buffer CacheSlots { uint slots[]; };
layout(std430, binding = CACHE_CLAIMING_BUFFER) readonly restrict buffer CacheClaiming { uint claiming[]; };
#else
layout(std430, binding = CACHE_CLAIMING_BUFFER) writeonly restrict buffer CacheClaiming { uint claiming[]; };
layout(std430, binding = CACHE_SEEN_BUFFER) writeonly restrict buffer CacheSeen { uint seen[]; };
layout(std430, binding = CACHE_KEYS_BUFFER) restrict buffer CacheKeys { uint keys[]; };
#endif
layout(std430, binding = CACHE_PREFETCH_BUFFER) readonly restrict buffer CachePrefetch { PrefetchPoint prefetched[]; };

const float kLeans = 0.02;  // squared component of the normal from which the slot is filled
const int kPrefetchCascades = 2;
#if PARTS
const int kParts = SPLIT;
#else
const int kParts = 1;
#endif

void main() {
  ivec2 size = textureSize(visibleDepth, 0);
#if CLAIM
  if (gl_GlobalInvocationID.x >= work.claiming) return;
  int number = int(claiming[gl_GlobalInvocationID.x]);
  ivec2 pixel = ivec2(number % size.x, number / size.x);
#else
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (pixel.x >= size.x) return;
  int number = pixel.y * size.x + pixel.x;
  bool claims = false;
#endif
  int beyond = number - size.x * size.y;
  bool isPrefetch = beyond >= 0;
  vec3 position, normal;
  uint name;  // in a key
  if (isPrefetch) {
    if (beyond >= int(cache.prefetch) || prefetched[beyond].isThere == 0u) return;
    position = prefetched[beyond].position;
    normal = prefetched[beyond].normal;
    name = uint(number - beyond - 1) / cache.markEvery + 1u + uint(beyond);
  } else {
    if (uint(number) % cache.markEvery != 0u || !isVisibleSurface(pixel)) return;
    position = visiblePosition(pixel);
    normal = visibleUnitNormal(pixel);
    name = uint(number) / cache.markEvery;
  }
  float left = 1.0;
  for (int k = isPrefetch ? max(grids.shape.y - kPrefetchCascades, 0) : 0; k < grids.shape.y && left > 0.0; ++k) {
    float weight = left * cacheCascadeWeight(k, position);
    if (!(weight > 0.0)) continue;
    if (!isPrefetch) left -= weight;
    vec3 inCells = placeInCells(k, position, normal);
    inCells *= float(kParts);
    ivec3 cell = clampedInt(floor(inCells), ivec3(-1), ivec3(kParts * grids.shape.x));
    if (any(lessThan(cell, ivec3(0))) || any(greaterThanEqual(cell, ivec3(kParts * grids.shape.x)))) continue;
    float offCentre = length(inCells - vec3(cell) - 0.5);
    cell += kParts * cache.firstCell[k].xyz;
    for (int axis = 0; axis < 3; ++axis) {
      float lean = normal[axis] * normal[axis];
      if (lean < kLeans) continue;
      int face = faceOf(axis, normal[axis]);
#if PARTS
      int slot = partOf(k, face, cell), level = k + grids.shape.y;
      if (slot < 0) continue;
#else
      int slot = slotOf(k, face, cell), level = k;
#endif
      uint holds = texelFetch(cacheSlots, slot).x;
      uint score = uint(clampedInt((offCentre + 0.5 * (1.0 - lean)) * (511.0 / 1.5), 0, 511));
      uint key = score << 23u | name;
#if CLAIM
      if (holds != 0u || texelFetch(cacheKeys, slot).x != key) continue;
      uint index = atomicAdd(work.wanted, 1u);
      if (index >= cache.capacity) continue;
      atomicMax(work.allGroupsX, index / uint(CACHE_LANES) + 1u);
      records[index] = CacheRecord(ivec4(cell, level * CACHE_FACES + face), CACHE_UNPLACED, 0u, 0.0, 0.0, vec3(0.0), 0u,
                                     position, cache.frame, normal, uint(number), vec3(0.0), 0.0, 0.0, 0.0, 0.0, 0.0);
      slots[slot] = index + 1u;
#if PARTS
      atomicAdd(work.parts, 1u);
#endif
#else
      claims = claims || holds == 0u;
      if (holds == 0u)
        atomicMin(keys[slot], key);
      else if (!isPrefetch && holds <= uint(seen.length()))
        seen[holds - 1u] = cache.frame;
#endif
    }
  }
#if !CLAIM
  if (!claims) return;
  uint place = atomicAdd(work.claiming, 1u);
  claiming[place] = uint(number);
  atomicMax(work.claimGroups[0], place / uint(CACHE_LANES) + 1u);
#endif
}
