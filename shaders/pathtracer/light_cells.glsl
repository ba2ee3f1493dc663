// Cells of the scene's box, and the kinds of lights told apart in them (engine/pathtracer/light_visibility.hpp). Space:
// the ray caster's.
#include "lib/clamped_int.glsl"

const uint kLightKinds = 3u;  // the sun, the environment, and lamps of all kinds
uniform vec3 lightCellsMin;
uniform float lightCellSize;
uniform ivec3 lightCells;

uint kindOfLight(uint kind) { return kind == PATH_LIGHT_SUN ? 0u : kind == PATH_LIGHT_ENVIRONMENT ? 1u : 2u; }

// Of the cell before a surface, not of that around it: the two sides of a thin wall are lit differently, and a face on
// the border of two cells would be in either by rounding.
uint lightCellBefore(Surface surface) {
  vec3 before = surface.position + 0.37 * lightCellSize * surface.geometricNormal;
  ivec3 cell = clampedInt((before - lightCellsMin) / lightCellSize, ivec3(0), lightCells - 1);
  return uint(cell.x + lightCells.x * (cell.y + lightCells.y * cell.z));
}
