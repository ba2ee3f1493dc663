// The surface visible in a pixel, read from the geometry pass: depth and normal.
#include "shared/bindings.h"
layout(binding = UNIT_VISIBLE_DEPTH) uniform sampler2D visibleDepth;
layout(binding = UNIT_VISIBLE_NORMAL) uniform sampler2D visibleNormal;
uniform mat4 worldFromClip;

bool isVisibleSurface(ivec2 pixel) { return texelFetch(visibleDepth, pixel, 0).r < 1.0; }

vec3 visiblePosition(ivec2 pixel) {
  vec3 window = vec3((vec2(pixel) + 0.5) / vec2(textureSize(visibleDepth, 0)), texelFetch(visibleDepth, pixel, 0).r);
  vec4 world = worldFromClip * vec4(2.0 * window - 1.0, 1.0);
  return world.xyz / world.w;
}

vec3 visibleUnitNormal(ivec2 pixel) { return normalize(texelFetch(visibleNormal, pixel, 0).xyz); }
