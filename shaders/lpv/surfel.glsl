// Converts a surfel of a reflective shadow map for the geometry volume; shared by all ways to fill it. Needs
// lib/sh.glsl, cascades/block.glsl. LOWEST_CELL is 0; 1 with the deviation lpv.first-cell.
#include "lib/clamped_int.glsl"
#include "lib/finite.glsl"

bool isUsableSurfel(vec4 position, vec3 normal, float area) {
  return position.w > 0.5 && allFinite(position.xyz) && allFinite(normal) && allFinite(vec3(area)) &&
         dot(normal, normal) > 0.25 && dot(normal, normal) < 4.0;
}

// The surfel's cell of the geometry volume in cascade k.
bool surfelCorner(int k, vec3 position, out ivec3 corner) {
  int corners = grids.shape.x + 1;
  vec3 cornerPosition = (position - grids.cascades[k].minimum) / grids.cascades[k].cellSize + 0.5;
#if !TRUNCATE  // deviation lpv.truncate: positions in (-1, 0) fall into cell 0
  cornerPosition = floor(cornerPosition);
#endif
  corner = clampedInt(cornerPosition, ivec3(-1), ivec3(corners));
  return all(greaterThanEqual(corner, ivec3(LOWEST_CELL))) && all(lessThan(corner, ivec3(corners)));
}
