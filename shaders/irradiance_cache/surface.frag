// Surfaces lit by the records around them too. Records are defined for the mesh's own normal.
#include "lib/frame.glsl"
#include "irradiance_cache/lookup.glsl"
#define INDIRECT 1
vec3 indirectIrradiance(vec3 position, vec3 normal, vec3 meshNormal) {
  bool found;
  return cachedIrradiance(position, meshNormal, found);
}
#include "forward/surface.glsl"
