// Converts a surfel of a reflective shadow map for the geometry volume; shared by all ways to fill it. Needs
// lib/sh.glsl, lpv/common.glsl. LOWEST_CELL is 0; 1 with the deviation lpv.first-cell.
#include "lib/finite.glsl"

bool isUsableSurfel(vec4 position, vec3 normal, float area) {
  return position.w > 0.5 && allFinite(position.xyz) && allFinite(normal) && allFinite(vec3(area)) &&
         dot(normal, normal) > 0.25 && dot(normal, normal) < 4.0;
}

// The surfel's cell of the geometry volume in cascade k.
bool surfelCorner(int k, vec3 position, out ivec3 corner) {
  int corners = lpv.shape.x + 1;
  vec3 cornerPosition = (position - lpv.cascades[k].minimum) / lpv.cascades[k].cellSize + 0.5;
  vec3 bounded = clamp(cornerPosition, -1.0, float(corners));  // the integer of a huge number is undefined
#if TRUNCATE
  corner = ivec3(bounded);  // deviation lpv.truncate: positions in (-1, 0) fall into cell 0
#else
  corner = ivec3(floor(bounded));
#endif
  return all(greaterThanEqual(corner, ivec3(LOWEST_CELL))) && all(lessThan(corner, ivec3(corners)));
}
