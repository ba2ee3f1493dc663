// Which lights the pixel's sample sees, as rays found out (rays/shadow_rays.comp): the sun if there is one, then lamps.
#include "shared/bindings.h"
layout(binding = UNIT_VISIBLE_LIGHTS) uniform usampler2DArray visibleLights;

float lightVisibility(int light) {
  uvec4 words = texelFetch(visibleLights, ivec3(gl_FragCoord.xy, light >> 7), 0);
  return float(words[light >> 5 & 3] >> (light & 31) & 1u);
}
