// Lists what the lookup reads from each cell for one point: one entry per cell. One invocation.
layout(local_size_x = 1) in;
#include "lib/clamped_int.glsl"
#include "lpv/lookup.glsl"
#include "forward/inspected_parts.glsl"
uniform vec3 inspectedPosition;
uniform vec3 inspectedNormal;

void main() {
  int cells = grids.shape.x;
  float left = 1.0;
  for (int k = 0; k < grids.shape.y && left > 0.0; ++k) {
#if SUM_CASCADES
    float weight = 1.0;
#else
    float weight = left * cascadeWeight(k, inspectedPosition);
    left -= weight;
#endif
    float border;
    vec3 place = lpvPlace(k, inspectedPosition, inspectedNormal, border) - 0.5;
    vec4 lobe = lpvLobe(inspectedNormal);
    for (int i = 0; i < 8; ++i) {
      ivec3 corner = ivec3(i & 1, i >> 1 & 1, i >> 2),
            texel = clampedInt(floor(place), ivec3(-2), ivec3(cells, cells, cells * grids.shape.y)) + corner;
      vec3 near = mix(1.0 - fract(place), fract(place), vec3(corner));
      float share = weight * border * near.x * near.y * near.z;
      ivec3 cell = texel - ivec3(0, 0, k * cells);
      if (!(share > 0.0) || any(lessThan(cell, ivec3(0))) || any(greaterThanEqual(cell, ivec3(cells)))) continue;
      InspectedPart part;
      part.red = texelFetch(lpvRed, texel, 0);
      part.green = texelFetch(lpvGreen, texel, 0);
      part.blue = texelFetch(lpvBlue, texel, 0);
      part.irradiance = (share * 4.0 / kPi * grids.referenceIrradiance) *
                        vec3(dot(part.red, lobe), dot(part.green, lobe), dot(part.blue, lobe));
      part.weight = share;
      part.place = grids.cascades[k].minimum + grids.cascades[k].cellSize * (vec3(cell) + 0.5);
      part.padding = 0.0;
      part.number = ivec4(cell, k);
      tellPart(part);
    }
  }
  endParts();
}
