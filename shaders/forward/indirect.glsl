// The only place where a technique adds to direct light. Returns irradiance at a surface, W per square scene unit. At
// most one of these flags is set: PROPAGATED (light propagation volume), IRRADIANCE_CACHE (records around the surface),
// GATHERED (a picture made before shading). Without any the result is 0.
// normal: the shading normal, possibly normal-mapped. meshNormal: the mesh's own; records and gathered irradiance are
// defined for it.
#include "shared/bindings.h"
#if PROPAGATED
#include "lpv/lookup.glsl"
vec3 indirectIrradiance(vec3 position, vec3 normal, vec3 meshNormal) { return lpvIrradiance(position, normal); }
#elif IRRADIANCE_CACHE
#include "irradiance_cache/lookup.glsl"
vec3 indirectIrradiance(vec3 position, vec3 normal, vec3 meshNormal) {
  bool found;
  return cachedIrradiance(position, meshNormal, found);
}
#elif GATHERED
layout(binding = UNIT_GATHERED) uniform sampler2D gatheredIrradiance;  // w = 2: interpolation rejected the pixel
vec3 indirectIrradiance(vec3 position, vec3 normal, vec3 meshNormal) {
  return texelFetch(gatheredIrradiance, ivec2(gl_FragCoord.xy), 0).rgb;
}
#else
vec3 indirectIrradiance(vec3 position, vec3 normal, vec3 meshNormal) { return vec3(0.0); }
#endif

// Whether to mark the pixel as one that interpolation rejected.
bool indirectIsRefused() {
#if SHOW_REFUSED
  return texelFetch(gatheredIrradiance, ivec2(gl_FragCoord.xy), 0).w > 1.5;
#else
  return false;
#endif
}
