// Surfaces lit by the same irradiance everywhere, beside their direct light.
#include "shared/bindings.h"
#define INDIRECT 1
layout(std140, binding = BLOCK_CASCADES) uniform Ambient { vec4 ambientIrradiance; };
vec3 indirectIrradiance(vec3 position, vec3 normal, vec3 meshNormal) { return ambientIrradiance.rgb; }
#include "forward/surface.glsl"
