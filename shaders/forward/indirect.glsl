// The one place where a technique adds to direct light: irradiance at a surface, W per square scene unit. Flags, one of
// them at most: PROPAGATED, from the light propagation volume; RECEIVED, from receivers about the surface; GATHERED,
// from a picture made before shading. Without any it is 0.
// normal: for shading, where a picture may bend it; meshNormal: of the mesh, on which receivers stand, so that their
// irradiance is that of it, as gathered one is.
#include "shared/bindings.h"
#if PROPAGATED
#include "lpv/lookup.glsl"
vec3 indirectIrradiance(vec3 position, vec3 normal, vec3 meshNormal) { return lpvIrradiance(position, normal); }
#elif RECEIVED
#include "lpv/receivers/lookup.glsl"
vec3 indirectIrradiance(vec3 position, vec3 normal, vec3 meshNormal) {
  bool found;
  return receivedIrradiance(position, meshNormal, found);
}
#elif GATHERED
layout(binding = UNIT_GATHERED) uniform sampler2D gatheredIrradiance;  // w = 2: interpolation refused the pixel
vec3 indirectIrradiance(vec3 position, vec3 normal, vec3 meshNormal) {
  return texelFetch(gatheredIrradiance, ivec2(gl_FragCoord.xy), 0).rgb;
}
#else
vec3 indirectIrradiance(vec3 position, vec3 normal, vec3 meshNormal) { return vec3(0.0); }
#endif

// Whether the pixel is to be shown as one that interpolation refused.
bool indirectIsRefused() {
#if SHOW_REFUSED
  return texelFetch(gatheredIrradiance, ivec2(gl_FragCoord.xy), 0).w > 1.5;
#else
  return false;
#endif
}
