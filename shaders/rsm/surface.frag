// Surfaces lit by irradiance that was gathered for each pixel, for the mesh's own normal; with SHOW_REFUSED those that
// interpolation rejected are red.
#include "shared/bindings.h"
#define INDIRECT 1
layout(binding = UNIT_GATHERED) uniform sampler2D gatheredIrradiance;  // w = 2: interpolation rejected the pixel
vec3 indirectIrradiance(vec3 position, vec3 normal, vec3 meshNormal) {
  return texelFetch(gatheredIrradiance, ivec2(gl_FragCoord.xy), 0).rgb;
}
bool indirectIsRefused() { return texelFetch(gatheredIrradiance, ivec2(gl_FragCoord.xy), 0).w > 1.5; }
#include "forward/surface.glsl"
