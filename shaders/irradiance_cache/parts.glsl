// Split cells: where surfaces are close to each other, a slot has a tile of SPLIT^3 parts, each with a record of its
// own. Needs irradiance_cache/common.glsl.
layout(binding = UNIT_CACHE_TILES) uniform usamplerBuffer cacheTiles;  // of a slot: 1 + its tile; 0: it has none

// part: counted in parts from the origin. -1: outside the grid, or its cell is not split.
int partOf(int cascade, int face, ivec3 part) {
  ivec3 inGrid = part - SPLIT * cache.firstCell[cascade].xyz;
  if (any(lessThan(inGrid, ivec3(0))) || any(greaterThanEqual(inGrid, ivec3(SPLIT * grids.shape.x)))) return -1;
  ivec3 inCell = inGrid % SPLIT;
  int tile = int(texelFetch(cacheTiles, slotOf(cascade, face, inGrid / SPLIT + cache.firstCell[cascade].xyz)).x) - 1;
  return tile < 0 ? -1 : ((tile * SPLIT + inCell.z) * SPLIT + inCell.y) * SPLIT + inCell.x;
}
