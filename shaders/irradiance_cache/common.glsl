// Records: each cell of each cascade has six slots, one per axis and sign. A slot holds one actual point of a surface
// that faces that way. Slots are addressed by the cell's index from the origin, modulo the cascade's cells, so that a
// record keeps its slot while the grid moves.
#include "shared/bindings.h"
#include "cascades/block.glsl"
#include "shared/irradiance_cache.h"
layout(std140, binding = BLOCK_CACHE) uniform CacheBlock { CacheConstants cache; };

float cellOfLight;  // size of the cells from which the last lookup took its light

// Unit of the irradiance in the texture: small, since it is stored times a weight that begins at 1 / 8000 (store.comp).
float cacheUnit() { return grids.referenceIrradiance / 16.0; }

// A surface's place in a cascade, in cells: a little before it, so that a wall between two cells lies in one of them,
// whichever way positions are rounded.
vec3 placeInCells(int cascade, vec3 position, vec3 normal) {
  const float kBefore = 1.0 / 64.0;
  return (position - grids.cascades[cascade].minimum) / grids.cascades[cascade].cellSize + kBefore * normal;
}

int faceOf(int axis, float component) { return 2 * axis + (component < 0.0 ? 1 : 0); }

// cell: index counted from the origin.
int slotOf(int cascade, int face, ivec3 cell) {
  int cells = grids.shape.x;
  ivec3 place = cell - cells * ivec3(floor(vec3(cell) / float(cells)));  // bounded: by the integer that is divided
  place -= cells * ivec3(greaterThanEqual(place, ivec3(cells)));
  place += cells * ivec3(lessThan(place, ivec3(0)));
  return ((((cascade * CACHE_FACES + face) * cells) + place.z) * cells + place.y) * cells + place.x;
}

// Whether a record belongs to a part of a split cell; cascade of either.
bool isPart(ivec4 cell) { return cell.w >= grids.shape.y * CACHE_FACES; }
int cascadeOf(ivec4 cell) { return cell.w / CACHE_FACES % grids.shape.y; }
