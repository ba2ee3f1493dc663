// Which lights the pixel's sample sees, as rays found out (rays/shadow_rays.comp): the sun if there is one, then lamps.
#include "shared/bindings.h"
layout(binding = UNIT_VISIBLE_LIGHTS) uniform usampler2D visibleLights;

float lightVisibility(int light) {
  uvec4 words = texelFetch(visibleLights, ivec2(gl_FragCoord.xy), 0);
  return float(words[light >> 5] >> (light & 31) & 1u);
}
