// Surfaces lit by the light propagation volume too; with INDIRECT_SPECULAR they reflect it along a lobe.
#include "lib/frame.glsl"
#include "lpv/lookup.glsl"
#define INDIRECT 1
vec3 indirectIrradiance(vec3 position, vec3 normal, vec3 meshNormal) { return lpvIrradiance(position, normal); }
#if INDIRECT_SPECULAR
#include "lpv/glossy.glsl"
vec3 indirectSpecular(vec3 position, vec3 normal, vec3 toCamera, Coat coat) {
  return lpvGlossy(position, normal, toCamera, coat);
}
#endif
#include "forward/surface.glsl"
