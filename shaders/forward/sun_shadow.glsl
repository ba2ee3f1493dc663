// The visible fraction of the sun, from one shadow map for the whole scene or from cascades (flag SUN_CASCADES: their
// number, 0 for one map).
#include "shared/bindings.h"
#include "lib/frame.glsl"
#include "lib/shadow.glsl"

// d(depth)/d(u, v) of the plane with that normal. The rows of an orthographic matrix are the light's axes, each by a
// scale of its own. Planes within 3 degrees of the light count as those of 3 degrees; without a normal: 0.
vec2 depthSlope(mat4 clipFromWorld, vec3 normal) {
  mat3 rows = transpose(mat3(clipFromWorld));
  vec3 scale = vec3(length(rows[0]), length(rows[1]), length(rows[2]));
  vec3 n = (normal * rows) / scale;
  float cosine = max(abs(n.z), 0.05);
  return (n.z < 0.0 ? n.xy : -n.xy) / cosine * (scale.z / scale.xy);
}

#if SUN_CASCADES
#include "shared/sun_cascades.h"
layout(std140, binding = BLOCK_SUN_CASCADES) uniform SunCascadeBlock { SunCascadeConstants sun; };
layout(binding = UNIT_SUN_SHADOW) uniform sampler2DArrayShadow shadowMap;

// From the finest cascade that contains the point to coarser ones, each blended into the next over the outer tenth of
// its map.
float sunVisibility(vec3 position, vec3 normal) {
  const float kBlend = 0.1;
  // a point near a map's border may lie outside the next map, so the sum is divided by its weights at the end
  float visibility = 0.0, left = 1.0;
  for (int k = 0; k < SUN_CASCADES && left > 0.0; ++k) {
    vec4 clip = sun.clipFromWorld[k] * vec4(position + normal * sun.normalOffset[k], 1.0);
    float inside = 1.0 - max(abs(clip.x), abs(clip.y));
    float border = 2.0 / float(textureSize(shadowMap, 0).x);  // the filter's radius
    float weight = k + 1 < SUN_CASCADES ? clamp((inside - border) / kBlend, 0.0, 1.0) : float(inside > 0.0);
    if (weight > 0.0) visibility += left * weight * shadowTent(shadowMap, float(k), 0.5 * clip.xyz + 0.5,
                                                            depthSlope(sun.clipFromWorld[k], normal));
    left -= left * weight;
  }
  return left < 1.0 ? visibility / (1.0 - left) : 1.0;
}
#else
layout(binding = UNIT_SUN_SHADOW) uniform sampler2DShadow shadowMap;

// Points outside the map are lit.
float sunVisibility(vec3 position, vec3 normal) {
  vec4 clip = frame.sunClipFromWorld * vec4(position + normal * frame.shadowNormalOffset, 1.0);
  return shadowTent(shadowMap, 0.5 * clip.xyz + 0.5, depthSlope(frame.sunClipFromWorld, normal), frame.shadowTexelUv);
}
#endif
