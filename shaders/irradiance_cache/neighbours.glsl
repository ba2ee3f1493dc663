// The records beside one: in the cells around its own, of its cascade and face.
// Needs irradiance_cache/common.glsl.
layout(binding = UNIT_CACHE_SLOTS) uniform usamplerBuffer cacheSlots;
const int kNeighbours = 26;

// i: 0 to kNeighbours - 1. false: that cell has none.
bool neighbourAt(ivec4 ofRecord, int i, out uint record) {
  int place = i < kNeighbours / 2 ? i : i + 1, cascade = ofRecord.w / CACHE_FACES;  // the middle of 27 is itself
  ivec3 cell = ofRecord.xyz + ivec3(place % 3, place / 3 % 3, place / 9) - 1,
        inGrid = cell - cache.firstCell[cascade].xyz;
  record = 0u;
  if (any(lessThan(inGrid, ivec3(0))) || any(greaterThanEqual(inGrid, ivec3(grids.shape.x)))) return false;
  uint holds = texelFetch(cacheSlots, slotOf(cascade, ofRecord.w % CACHE_FACES, cell)).x;
  record = holds - 1u;
  return holds != 0u && holds <= cache.capacity;
}
