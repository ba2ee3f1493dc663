// The visible fraction of the sun, from one shadow map for the whole scene or from cascades (flag SUN_CASCADES: their
// number, 0 for one map). Points in the air, without a normal (0), take the nearest texel alone.
// Needs forward/shadow_filter.glsl.

#if SUN_CASCADES
#include "shared/sun_cascades.h"
layout(std140, binding = BLOCK_SUN_CASCADES) uniform SunCascadeBlock { SunCascadeConstants sun; };
#endif

// The rows of an orthographic matrix are the light's axes, each by a scale of its own. Planes within one degree of the
// light count as those of one degree.
ShadowReceiver sunReceiver(mat4 clipFromWorld, vec3 position, vec3 normal, int cascade) {
  mat3 rows = transpose(mat3(clipFromWorld));
  vec3 scale = vec3(length(rows[0]), length(rows[1]), length(rows[2]));
  vec3 n = (normal * rows) / scale, uvz = 0.5 * (clipFromWorld * vec4(position, 1.0)).xyz + 0.5;
  vec2 size = vec2(textureSize(sunMap, 0).xy), texels = size * scale.xy / scale.z;  // of the map, by depth
  float cosine = max(abs(n.z), 0.0175);
  ShadowReceiver receiver;
  receiver.place = uvz.xy * size;
  receiver.depth = uvz.z;
  receiver.slope = (n.z < 0.0 ? n.xy : -n.xy) / (cosine * texels);
  receiver.away = 1.0 / (min(texels.x, texels.y) * cosine);
  receiver.spread = mat2(texels.x * frame.sunTangent, 0.0, 0.0, texels.y * frame.sunTangent);
  receiver.distant = 1.0 / max(min(texels.x, texels.y) * frame.sunTangent, 1e-30);
  receiver.nearest = 0.0;
  receiver.light = kSunMap;
  receiver.layer = cascade;
  receiver.axis = receiver.u = receiver.v = vec3(0.0);
  receiver.none = 1.0;
  return receiver;
}

float visibleInMap(mat4 clipFromWorld, vec3 position, vec3 normal, int cascade) {
  ShadowReceiver receiver = sunReceiver(clipFromWorld, position, normal, cascade);
  if (normal == vec3(0.0)) return float(storedDepth(receiver, receiver.place) >= min(receiver.depth, 1.0));
  return visibleShare(receiver);
}

#if SUN_CASCADES
// From the finest cascade that contains the point to coarser ones, each blended into the next over the outer tenth of
// its map.
float sunVisibility(vec3 position, vec3 normal) {
  const float kBlend = 0.1;
  // a point near a map's border may lie outside the next map, so the sum is divided by its weights at the end
  float visibility = 0.0, left = 1.0;
  for (int k = 0; k < SUN_CASCADES && left > 0.0; ++k) {
    vec3 moved = position + normal * sun.normalOffset[k];
    vec4 clip = sun.clipFromWorld[k] * vec4(moved, 1.0);
    float inside = 1.0 - max(abs(clip.x), abs(clip.y));
    float border = 2.0 / float(textureSize(sunMap, 0).x);  // the filter's radius
#if PENUMBRA_TAPS
    mat3 rows = transpose(mat3(sun.clipFromWorld[k]));  // and that of the widest penumbra
    border += frame.sunTangent * (1.0 + clip.z) * length(rows[0]) / length(rows[2]);
#endif
    float weight = k + 1 < SUN_CASCADES ? clamp((inside - border) / kBlend, 0.0, 1.0) : float(inside > 0.0);
    if (weight > 0.0)
      visibility += left * weight * visibleInMap(sun.clipFromWorld[k], moved, normal, k);
    left -= left * weight;
  }
  return left < 1.0 ? visibility / (1.0 - left) : 1.0;
}
#else
// Points outside the map are lit.
float sunVisibility(vec3 position, vec3 normal) {
  return visibleInMap(frame.sunClipFromWorld, position + normal * frame.shadowNormalOffset, normal, 0);
}
#endif
