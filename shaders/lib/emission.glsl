// Radiance emitted by a mesh's material. Sampled before `discard`, like the albedo (lib/material.glsl).
#include "shared/bindings.h"
uniform vec3 materialEmission;
#if EMISSION_TEXTURES
layout(binding = UNIT_EMISSION_MAP) uniform sampler2D emissionTexture;  // white where a material has none
#endif

vec3 materialEmitted(vec2 texCoord) {
#if EMISSION_TEXTURES
  return materialEmission * texture(emissionTexture, texCoord).rgb;
#else
  return materialEmission;
#endif
}
