// The leaves of the hierarchy of lamps (engine/rays/light_hierarchy.hpp): texture unit UNIT_LIGHT_HIERARCHY.
#include "shared/bindings.h"
layout(binding = UNIT_LIGHT_HIERARCHY) uniform usamplerBuffer lightHierarchy;

// x: number of the light; y: bits of the density by power of points on a triangle.
uvec2 lampOfLeaf(uint leaf) {
  uvec4 two = texelFetch(lightHierarchy, int(leaf / 2u));
  return (leaf & 1u) == 0u ? two.xy : two.zw;
}
