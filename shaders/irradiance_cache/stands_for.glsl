// The record that stands for a surface point: of the point's cell, on the side that its normal leans to most, in the
// finest cascade that has one with light. Needs irradiance_cache/common.glsl.
layout(binding = UNIT_CACHE_SLOTS) uniform usamplerBuffer cacheSlots;
layout(binding = UNIT_CACHE_LIGHT) uniform samplerBuffer cacheLight;  // of a record: irradiance; w: 0 if it has none

// xyz: irradiance; w: 0 if the slot has no record with light.
vec4 lightOfSlot(uint slot) {
  uint holds = texelFetch(cacheSlots, int(slot)).x;
  return holds == 0u || holds > cache.capacity ? vec4(0.0) : texelFetch(cacheLight, int(holds - 1u));
}

// 1 + its slot; 0: none.
uint standsFor(vec3 position, vec3 normal) {
  for (int k = 0; k < grids.shape.y; ++k) {
    vec3 inCells = floor(placeInCells(k, position, normal));
    if (any(lessThan(inCells, vec3(0.0))) || any(greaterThanEqual(inCells, vec3(grids.shape.x)))) continue;
    ivec3 cell = clampedInt(inCells, ivec3(0), ivec3(grids.shape.x - 1)) + cache.firstCell[k].xyz;
    vec3 lean = normal * normal;
    for (int i = 0; i < 3; ++i) {
      int axis = lean.x >= lean.y && lean.x >= lean.z ? 0 : lean.y >= lean.z ? 1 : 2;
      if (lean[axis] < 0.25) break;
      lean[axis] = 0.0;
      uint slot = uint(slotOf(k, faceOf(axis, normal[axis]), cell));
      cellOfLight = grids.cascades[k].cellSize;
      if (lightOfSlot(slot).w > 0.0) return slot + 1u;
    }
  }
  return 0u;
}
