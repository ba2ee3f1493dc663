// Lists what the lookup reads from each record for one point: one entry per record of a cell or of a part. One
// invocation.
layout(local_size_x = 1) in;
#include "lib/clamped_int.glsl"
#include "irradiance_cache/lookup.glsl"
#include "forward/inspected_parts.glsl"
layout(binding = UNIT_CACHE_SLOTS) uniform usamplerBuffer cacheSlots;
layout(std430, binding = CACHE_RECORDS_BUFFER) readonly buffer CacheRecords { CacheRecord records[]; };
uniform vec3 inspectedPosition;
uniform vec3 inspectedNormal;  // of the mesh
#if SHOWS_PARTS
layout(binding = UNIT_CACHE_PART_SLOTS) uniform usamplerBuffer cachePartSlots;
#endif

// The cascades' weights, and the sum that normalises them.
float weightsOfCascades(out float weights[MAX_CASCADES], out float there[MAX_CASCADES]) {
  float left = 1.0, sum = 0.0;
  for (int k = 0; k < MAX_CASCADES; ++k) {
    weights[k] = there[k] = 0.0;
    if (k >= grids.shape.y || !(left > 0.0)) continue;
    float weight = left * cacheCascadeWeight(k, inspectedPosition);
    if (!(weight > 0.0)) continue;
    there[k] = cachedInCascade(k, inspectedPosition, inspectedNormal).w;
    if (!(there[k] > kLeast)) continue;
    weights[k] = weight * min(there[k] / kEnough, 1.0);
    sum += weights[k];
    left -= weights[k];
  }
  return sum;
}

#if SHOWS_PARTS
// The entries of the parts around, as in cachedInParts. scale: by which what they hold is multiplied.
void tellSplit(int k, float scale) {
  vec3 place = float(SPLIT) * cachePlace(k, inspectedPosition) - 0.5, near = fract(place);
  ivec3 first = clampedInt(floor(place), ivec3(-1), ivec3(SPLIT * grids.shape.x));
  for (int i = 0; i < 24; ++i) {
    int axis = i >> 3;
    ivec3 corner = ivec3(i, i >> 1, i >> 2) & 1;
    vec3 weights = mix(1.0 - near, near, vec3(corner));
    float share = scale * inspectedNormal[axis] * inspectedNormal[axis] * weights.x * weights.y * weights.z;
    if (!(share > 0.0)) continue;
    int part = partOf(k, faceOf(axis, inspectedNormal[axis]), first + corner + SPLIT * cache.firstCell[k].xyz);
    if (part < 0) continue;
    vec4 held = texelFetch(cacheParts, part);
    uint slot = texelFetch(cachePartSlots, part).x;
    if (!(held.w > 0.0) || slot == 0u || slot > cache.capacity) continue;
    tellPart(InspectedPart(share * cacheUnit() * held.rgb, share * held.w, records[slot - 1u].position, 0.0,
                           ivec4(first + corner, grids.shape.y + k), vec4(0.0), vec4(0.0), vec4(0.0)));
  }
}
#endif

void main() {
  int cells = grids.shape.x;
  float weights[MAX_CASCADES], there[MAX_CASCADES], sum = weightsOfCascades(weights, there);
  for (int k = 0; k < grids.shape.y; ++k) {
    if (!(weights[k] > 0.0)) continue;
    float ofCells = 1.0;
#if SHOWS_PARTS
    float found = cachedInParts(k, inspectedPosition, inspectedNormal).w, ofParts = min(found / kEnoughParts, 1.0);
    if (ofParts > 0.0) tellSplit(k, ofParts * weights[k] / (found * sum));
    ofCells -= ofParts;
#endif
    vec3 place = cachePlace(k, inspectedPosition) - 0.5;
    for (int i = 0; i < 24; ++i) {
      int axis = i >> 3, face = faceOf(axis, inspectedNormal[axis]);
      ivec3 corner = ivec3(i & 1, i >> 1 & 1, i >> 2 & 1),
            cell = clampedInt(floor(place), ivec3(-2), ivec3(cells)) + corner;
      vec3 near = mix(1.0 - fract(place), fract(place), vec3(corner));
      float share = inspectedNormal[axis] * inspectedNormal[axis] * near.x * near.y * near.z * weights[k] *
                    ofCells / (there[k] * sum);
      if (!(share > 0.0) || any(lessThan(cell, ivec3(0))) || any(greaterThanEqual(cell, ivec3(cells)))) continue;
      vec4 held = texelFetch(cacheIrradiance, cell + ivec3(0, 0, (k * CACHE_FACES + face) * cells), 0);
      uint slot = texelFetch(cacheSlots, slotOf(k, face, cell + cache.firstCell[k].xyz)).x;
      if (!(held.w > 0.0) || slot == 0u || slot > cache.capacity) continue;
      tellPart(InspectedPart(share * cacheUnit() * held.rgb, share * held.w, records[slot - 1u].position,
                         0.0, ivec4(cell, k), vec4(0.0), vec4(0.0), vec4(0.0)));
    }
  }
  endParts();
}
