// Writes the texture that the lookup filters: each record's irradiance at its cell and face, times its weight. The
// weight grows to what its number of paths is worth, slowly, so that new records fade in among others. A record
// with few paths is averaged with its neighbours (same face, surfaces that lean the same way), weighted by their paths.
// This trades noise for a little blur, and both vanish once the record has all its paths and stands for itself.
layout(local_size_x = 64) in;
#include "lib/float_pairs.glsl"
#include "irradiance_cache/common.glsl"
#include "irradiance_cache/work.glsl"
layout(std430, binding = CACHE_WORK_BUFFER) readonly restrict buffer CacheWorkBlock { CacheWork work; };
layout(std430, binding = CACHE_RECORDS_BUFFER) restrict buffer CacheRecords { CacheRecord records[]; };
layout(GRID_FORMAT, binding = 0) writeonly uniform image3D cacheIrradiance;
#include "irradiance_cache/neighbours.glsl"
#if SMOOTHS
#include "irradiance_cache/smoothing.glsl"
const float kLeastRounds = 4.0;  // for an estimate of the noise
#endif
uniform uint enoughPaths;  // a CACHE_FIRST record follows its estimate without limit until it has this many
// largest change per frame of the shown irradiance, relative to what it is or a quarter of its target; 0: no limit
uniform float mostChange;
// A new record's weight grows per frame by kGrowth of what it is and of what those beside it may have at least. What
// it takes away from a much brighter one then darkens a surface by at most kGrowth per frame. It takes 522 frames. A
// record that is much brighter than one beside it (CACHE_BRIGHT) starts with less, since it adds many times that.
const float kGrowth = 0.008, kBeside = 1.0 / 64.0, kBesideDark = 1.0 / 128.0, kNearly = 127.0 / 128.0;

// Avoids visible jumps: the irradiance that a record shows moves gradually towards the estimate from its own and its
// neighbours' paths, and a new record fades in. Where nothing was shown before, it starts with the estimate of its
// first frame.
void show(uint index, inout CacheRecord record, vec3 target) {
  vec3 change = target - record.shown;
  float largest = max(max(abs(change.x), abs(change.y)), abs(change.z));
  float scale = max(max(max(record.shown.x, record.shown.y), record.shown.z),
                    0.25 * max(max(target.x, target.y), target.z));
  scale = max(scale, 1e-3 * cacheUnit());  // otherwise it never reaches black
  bool isFirst = (record.state & CACHE_FIRST) != 0u;
  if (isFirst && record.paths >= enoughPaths) records[index].state = record.state & ~CACHE_FIRST;
  bool arrives = mostChange == 0.0 || isFirst || largest <= mostChange * scale;
  record.shown = arrives ? target : record.shown + change * (mostChange * scale / largest);
  float beside = (record.state & CACHE_BRIGHT) != 0u ? kBesideDark : kBeside;
  float grown = record.blendWeight + kGrowth * (record.blendWeight + beside);
  float full = fullBlendWeight(record.paths);
  record.blendWeight = min(mostChange == 0.0 ? full : grown, arrives ? full : kNearly * full);
  records[index].shown = record.shown;
  records[index].blendWeight = record.blendWeight;
}

vec3 withNeighbours(CacheRecord record) {
  float share = 1.0 - float(record.paths) / CACHE_FULL_PATHS;
  if (share <= 0.0) return record.irradiance;
  vec3 sum = float(record.paths) * record.irradiance;
  float weights = float(record.paths);
  for (int i = 0; i < kNeighbours; ++i) {
    uint other;
    if (!neighbourAt(record.cell, i, other)) continue;
    uint paths = records[other].paths;
    float weight = share * float(paths) * smoothstep(0.5, 1.0, dot(records[other].normal, record.normal));
    bool isNarrow = (records[other].state & ~record.state & CACHE_NARROW) != 0u;
    if (paths == 0u || !(weight > 0.0) || isNarrow) continue;
    sum += weight * records[other].irradiance;
    weights += weight;
  }
  return sum / weights;
}

#if SMOOTHS
// The same of records with several rounds of paths: only noise is taken away.
vec3 smoothed(CacheRecord record) {
  if (float(record.paths) < kLeastRounds * pathsOfRound) return withNeighbours(record);
  int axis = record.cell.w % CACHE_FACES / 2;
  float size = grids.cascades[cascadeOf(record.cell)].cellSize, error2 = squaredError(record.squares, record.paths);
  PlaneFit fit = beginFit();
  for (int i = 0; i < kNeighbours; ++i) {
    uint index;
    if (!neighbourAt(record.cell, i, index)) continue;
    CacheRecord other = records[index];
    float weight = smoothstep(0.5, 1.0, dot(other.normal, record.normal));
    bool isNarrow = (other.state & ~record.state & CACHE_NARROW) != 0u;
    if (other.paths == 0u || !(weight > 0.0) || isNarrow) continue;
    addToFit(fit, (other.position - record.position) / size, axis,
             (other.irradiance - record.irradiance) / cacheUnit(),
             error2 + squaredError(other.squares, other.paths), weight);
  }
  return max(record.irradiance + cacheUnit() * fittedDifference(fit), 0.0);
}
#endif

// The brightest irradiance of records around a cell that are not in a narrow place; -1: there are none.
float brightestAround(ivec4 cell) {
  float brightest = -1.0;
  for (int i = 0; i < kNeighbours; ++i) {
    uint other;
    if (!neighbourAt(cell, i, other) || records[other].paths == 0u) continue;
    if ((records[other].state & CACHE_NARROW) == 0u) brightest = max(brightest, largestOf(records[other].irradiance));
  }
  return brightest;
}

// Where another surface is much nearer than a cell is wide, a record may have light that the rest of its cell has not:
// on a ceiling at the edge of a lamp that hangs under it, say. It shows at most kMuch times the brightest of those
// around it that are not in such a place.
float shareOfItsCell(CacheRecord record, vec3 target) {
  const float kMuch = 1.25;  // 1: the foot of a lit wall is darker; 2: a lamp that hangs under a ceiling has a glow
  if ((record.state & CACHE_NARROW) == 0u) return 1.0;
  float around = brightestAround(record.cell), brightest = largestOf(target);
  return around >= 0.0 && brightest > kMuch * around ? kMuch * around / brightest : 1.0;
}

void main() {
  uint index = gl_GlobalInvocationID.x;
  if (index >= recordCount(work.wanted)) return;
  CacheRecord record = records[index];
  if (record.paths == 0u) return;
  if (isPart(record.cell)) return;  // parts.comp
  int cascade = cascadeOf(record.cell);
  ivec3 place = record.cell.xyz - cache.firstCell[cascade].xyz;
  if (any(lessThan(place, ivec3(0))) || any(greaterThanEqual(place, ivec3(grids.shape.x)))) return;
#if SMOOTHS
  vec3 target = smoothed(record);
#else
  vec3 target = withNeighbours(record);
#endif
  show(index, record, shareOfItsCell(record, target) * target);
  imageStore(cacheIrradiance, ivec3(place.xy, record.cell.w * grids.shape.x + place.z),
             record.blendWeight * vec4(record.shown / cacheUnit(), 1.0));
}
