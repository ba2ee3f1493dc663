// Visits every record once per frame. A new one is placed where its pixel's ray meets the scene, in the ray caster's
// coordinates, so that no path starts inside a surface. Needed records that do not have all their paths yet are
// listed. SPLIT: cells are split, into as many parts a side, where a record sees other surfaces close by. A new record
// first shows the irradiance looked up at its place in the previous frame.
layout(local_size_x = 64) in;
#include "shared/bindings.h"
#include "shared/path_tracer.h"
layout(std140, binding = BLOCK_CACHE_PATHS) uniform PathBlock { PathConstants tracer; };
#include "rays/random.glsl"
#include "rays/bsdf.glsl"
#include "rays/materials.glsl"
#include "rays/bvh.glsl"
#include "lib/clamped_int.glsl"
#include "irradiance_cache/lookup.glsl"
#include "irradiance_cache/work.glsl"
layout(std430, binding = CACHE_WORK_BUFFER) restrict buffer CacheWorkBlock { CacheWork work; };
#include "irradiance_cache/seen.glsl"
layout(std430, binding = CACHE_RECORDS_BUFFER) restrict buffer CacheRecords { CacheRecord records[]; };
layout(std430, binding = CACHE_LIST_BUFFER) writeonly restrict buffer CacheLit { uint lit[]; };
layout(binding = UNIT_CACHE_SEEN) uniform usamplerBuffer cacheSeen;
#include "irradiance_cache/neighbours.glsl"
uniform uint mostLit;     // records
uniform uint pathTarget;  // paths that each record should have
#if SPLIT
uniform float shareOfParts;  // paths of all parts of cells, over those of all cells
uniform uint mostTiles;
uniform bool listsParts;    // else records of cells alone
layout(std430, binding = CACHE_TILES_BUFFER) restrict buffer CacheTiles { uint tiles[]; };
#endif
uniform bool countsFading;  // also list records whose shown value is still fading in

// Whether one of the neighbours that are shown is much darker. Those of this frame are not shown yet.
bool isBrightBeside(ivec4 cell, vec3 light) {
  const float kMuch = 4.0;
  float most = largestOf(light) / kMuch;
  bool isBright = false;
  for (int i = 0; i < kNeighbours; ++i) {
    uint other;
    if (!neighbourAt(cell, i, other) || !(records[other].blendWeight > 0.0)) continue;
    float shown = largestOf(records[other].shown);
    isBright = isBright || (shown > 0.0 && shown <= most);
  }
  return isBright;
}

// Share of a surface's cosine-weighted hemisphere in which another surface is within reach.
float shareWithin(float reach, Surface surface, uint triangle) {
  const uint kRays = 32u;
  vec3 start = offsetRay(surface.position, surface.geometricNormal, surface.magnitude);
  uint met = 0u;
  for (uint i = 0u; i < kRays; ++i) {
    vec2 xi = vec2((float(i) + 0.5) / float(kRays), fract(0.618034 * float(i)));
    met += uint(anyHit(Ray(start, 0.0, cosineSample(surface.geometricNormal, xi), reach), triangle));
  }
  return float(met) / float(kRays);
}

// That of surfaces much nearer than a cell is wide, and than the camera is: a cell may be as large as a room.
float shareBlockedNearby(Surface surface, uint triangle, ivec4 cell) {
  const float kOfCell = 1.0 / 8.0, kOfView = 1.0 / 64.0;
  return shareWithin(min(kOfCell * grids.cascades[cascadeOf(cell)].cellSize,
                         kOfView * distance(surface.position, tracer.cameraPosition)), surface, triangle);
}

#if SPLIT
// Where other surfaces are close, light changes within a cell [Ward1988]: whether some are nearer than kReach cells in
// at least kShare of the hemisphere. On a floor x kReach cells from a wall's foot, that share is the part of the unit
// disc beyond x: 5 % for x = 0.8.
bool isClose(Surface surface, uint triangle, ivec4 cell) {
  const float kReach = 1.5, kShare = 0.05;
  return shareWithin(kReach * grids.cascades[cascadeOf(cell)].cellSize, surface, triangle) >= kShare;
}
#endif

void main() {
  uint index = gl_GlobalInvocationID.x;
  if (index >= recordCount(work.wanted)) return;
  uint triangle = records[index].triangle;
  if (triangle == CACHE_UNPLACED) {
    Hit hit;
    Surface surface;
    bool isThere = seenAt(int(records[index].pixel), hit, surface);
    // A record in a slit, such as a pixel may see between a lamp and the ceiling that it hangs under, has the light of
    // the slit alone: it would be wrong for the rest of its cell.
    const float kSlit = 0.75;
    ivec4 cell = records[index].cell;
    float blocked = isThere && !isPart(cell) ? shareBlockedNearby(surface, hit.triangle, cell) : 0.0;
    isThere = isThere && blocked < kSlit;
    triangle = isThere ? hit.triangle : CACHE_NOWHERE;
    records[index].triangle = triangle;
    if (isThere) {
      records[index].position = surface.position + cache.rayOrigin;
      records[index].normal = surface.normal;
      records[index].second = hit.barycentrics.x;
      records[index].third = hit.barycentrics.y;
      bool known;
      vec3 before = cachedIrradiance(surface.position + cache.rayOrigin, surface.normal, known);
      records[index].shown = before;
      records[index].blendWeight = 0.0;
      records[index].state = (surface.front ? CACHE_FRONT : 0u) | (known ? 0u : CACHE_FIRST) |
                             (!isPart(cell) && isBrightBeside(cell, before) ? CACHE_BRIGHT : 0u) |
                             (blocked > 0.0 ? CACHE_NARROW : 0u);
#if SPLIT
      if (!isPart(cell) && isClose(surface, hit.triangle, cell)) records[index].state |= CACHE_CLOSE;
#endif
    }
  }
  if (triangle == CACHE_NOWHERE) return;
  uint target = pathTarget;
  ivec4 cell = records[index].cell;
#if FEWER_PATHS
  // It counts by lean^2 at most; but the light of a round sphere is that of all its axes.
  const float kFewest = 64.0;
  float lean = records[index].normal[cell.w % CACHE_FACES / 2];
  target = min(target, uint(clampedInt(max(kFewest, float(target) * min(2.0 * lean * lean, 1.0)), 0, 1 << 30)));
#endif
#if SPLIT
  if (isPart(cell)) {
    if (!listsParts) return;
    const float kLeast = 2.0 * float(PATHS);  // for an estimate of the noise
    float each = shareOfParts * float(pathTarget) * float(work.wanted - work.parts) / float(work.parts);
    target = min(target, uint(clampedInt(max(each, kLeast), 0, 1 << 30)));
  }
  if ((records[index].state & CACHE_CLOSE) != 0u) {
    int slot = slotOf(cascadeOf(cell), cell.w % CACHE_FACES, cell.xyz);
    if (tiles[slot] == 0u) {
      uint tile = atomicAdd(work.tiles, 1u);
      if (tile < mostTiles) tiles[slot] = tile + 1u;
    }
  }
#endif
  // also if it is not needed itself, but is looked up next to needed ones; not without any path, as it shows nothing
  uint paths = records[index].paths;
  bool fades = countsFading && paths > 0u && records[index].blendWeight < fullBlendWeight(paths);
  bool lacksPaths = paths < target &&
                    (records[index].born == cache.frame || texelFetch(cacheSeen, int(index)).x == cache.frame);
  if (!fades && !lacksPaths) return;
  uint place = atomicAdd(work.waiting, 1u);
  if (place >= mostLit) return;
  uint group = place / uint(CACHE_LANES / PATHS);
  atomicMax(work.litGroups[3u * (group / uint(CACHE_PART_GROUPS))], group % uint(CACHE_PART_GROUPS) + 1u);
  lit[place] = index;
}
