// Light of the parts of split cells in finished pictures: that of the cells around, and as much of the difference of
// the part's own record as is more than noise. Runs after store.comp.
layout(local_size_x = 64) in;
#include "irradiance_cache/lookup.glsl"
#include "lib/clamped_int.glsl"
#include "irradiance_cache/parts.glsl"
#include "irradiance_cache/work.glsl"
#include "irradiance_cache/smoothing.glsl"
layout(std430, binding = CACHE_WORK_BUFFER) readonly restrict buffer CacheWorkBlock { CacheWork work; };
layout(std430, binding = CACHE_RECORDS_BUFFER) restrict buffer CacheRecords { CacheRecord records[]; };
layout(std430, binding = CACHE_PARTS_BUFFER) writeonly restrict buffer CacheParts { vec4 partLight[]; };
layout(binding = UNIT_CACHE_SLOTS) uniform usamplerBuffer cacheSlots;
layout(binding = UNIT_CACHE_PART_SLOTS) uniform usamplerBuffer cachePartSlots;

// The irradiance of the cells around, in the place of a part's record.
vec3 ofCells(int cascade, vec3 position, vec3 normal, vec3 irradiance) {
  vec4 cells = cachedInCascade(cascade, position, normal);
  return cells.w > kLeast ? cells.rgb / cells.w * cacheUnit() : irradiance;
}

// How far a place is inside of split cells: 1 in the middle of one, 0 at the border of one that is not.
float shareOfSplit(int cascade, int face, vec3 position) {
  vec3 place = cachePlace(cascade, position) - 0.5, near = fract(place);
  ivec3 first = clampedInt(floor(place), ivec3(-1), ivec3(grids.shape.x));
  float split = 0.0, all = 0.0;
  for (int i = 0; i < 8; ++i) {
    ivec3 corner = ivec3(i, i >> 1, i >> 2) & 1, cell = first + corner;
    if (any(lessThan(cell, ivec3(0))) || any(greaterThanEqual(cell, ivec3(grids.shape.x)))) continue;
    vec3 weights = mix(1.0 - near, near, vec3(corner));
    int slot = slotOf(cascade, face, cell + cache.firstCell[cascade].xyz);
    if (texelFetch(cacheSlots, slot).x == 0u) continue;
    float weight = weights.x * weights.y * weights.z;
    all += weight;
    if (texelFetch(cacheTiles, slot).x != 0u) split += weight;
  }
  return all > 0.0 ? clamp(2.0 * split / all - 1.0, 0.0, 1.0) : 0.0;
}

void main() {
  uint index = gl_GlobalInvocationID.x;
  if (index >= recordCount(work.wanted)) return;
  CacheRecord record = records[index];
  if (record.paths == 0u || !isPart(record.cell)) return;
  int cascade = cascadeOf(record.cell), face = record.cell.w % CACHE_FACES,
      own = partOf(cascade, face, record.cell.xyz);
  if (own < 0) return;

  // Differences to the cells, of this part and of those around it.
  float size = grids.cascades[cascade].cellSize / float(SPLIT);
  vec3 base = ofCells(cascade, record.position, record.normal, record.irradiance),
       difference = (record.irradiance - base) / cacheUnit();
  float error2 = squaredError(record.squares, record.paths), errors2 = error2, found2 = dot(difference, difference);
  PlaneFit fit = beginFit();
  for (int i = 0; i < 27; ++i) {
    int part = partOf(cascade, face, record.cell.xyz + ivec3(i % 3, i / 3 % 3, i / 9) - 1);
    uint holds = part < 0 ? 0u : texelFetch(cachePartSlots, part).x;
    if (holds == 0u || holds > cache.capacity || holds - 1u == index) continue;
    CacheRecord other = records[holds - 1u];
    float weight = smoothstep(0.5, 1.0, dot(other.normal, record.normal));
    if (other.paths == 0u || !(weight > 0.0)) continue;
    vec3 theirs =
        (other.irradiance - ofCells(cascade, other.position, other.normal, other.irradiance)) / cacheUnit();
    float theirError2 = squaredError(other.squares, other.paths);
    errors2 += weight * theirError2;
    found2 += weight * dot(theirs, theirs);
    addToFit(fit, (other.position - record.position) / size, face / 2, theirs - difference, error2 + theirError2,
             weight);
  }

  // The share of what is found that is not noise [JamesStein1961]; kNoise: of the bound, what there is of it.
  const float kNoise = 0.25;
  float share = clamp(1.0 - kNoise * errors2 / max(found2, 1e-30), 0.0, 1.0) *
                shareOfSplit(cascade, face, record.position);
  vec3 shown = max(base + share * cacheUnit() * (difference + fittedDifference(fit)), 0.0);
  records[index].shown = shown;
  records[index].blendWeight = fullBlendWeight(record.paths);
  partLight[own] = vec4(shown / cacheUnit(), 1.0);
}
