// The visible fraction of the sun, from one shadow map for the whole scene or from cascades (flag SUN_CASCADES: their
// number, 0 for one map): a 3x3 tent filter of comparisons, each with the depth that the receiver's plane has at the
// middle of that texel. Points in the air, without a normal (0), take the nearest texel alone.
#include "shared/bindings.h"
#include "lib/clamped_int.glsl"
#include "lib/frame.glsl"

#if SUN_CASCADES
#include "shared/sun_cascades.h"
layout(std140, binding = BLOCK_SUN_CASCADES) uniform SunCascadeBlock { SunCascadeConstants sun; };
layout(binding = UNIT_SUN_SHADOW) uniform sampler2DArray shadowMap;
float storedDepth(ivec2 texel, int cascade) { return texelFetch(shadowMap, ivec3(texel, cascade), 0).r; }
#else
layout(binding = UNIT_SUN_SHADOW) uniform sampler2D shadowMap;
float storedDepth(ivec2 texel, int cascade) { return texelFetch(shadowMap, texel, 0).r; }
#endif

// The plane of a surface in the sun's map.
struct ShadowPlane {
  vec2 slope;    // d(depth)/d(u, v)
  float away;  // what is stored farther from the plane than this is not joined to it
};

// The rows of an orthographic matrix are the light's axes, each by a scale of its own. Planes within one degree of the
// light count as those of one degree.
ShadowPlane shadowPlane(mat4 clipFromWorld, vec3 normal) {
  mat3 rows = transpose(mat3(clipFromWorld));
  vec3 scale = vec3(length(rows[0]), length(rows[1]), length(rows[2]));
  vec3 n = (normal * rows) / scale;
  float cosine = max(abs(n.z), 0.0175);
  float texel = scale.z / (min(scale.x, scale.y) * float(textureSize(shadowMap, 0).x));
  return ShadowPlane((n.z < 0.0 ? n.xy : -n.xy) / cosine * (scale.z / scale.xy), texel / cosine);
}

// What the map stores at a texel, 1 (nothing) outside of it.
float storedOrNothing(ivec2 texel, int cascade) {
  bool inside = all(greaterThanEqual(texel, ivec2(0))) && all(lessThan(texel, textureSize(shadowMap, 0).xy));
  return inside ? storedDepth(texel, cascade) : 1.0;
}

// Texels that store the receiver's own plane are lit, those that store something before it are not. Two kinds say
// nothing about the plane and nearly do not count. The tent reaches past the edge of a surface: what is behind the
// plane would light a wall that stands in its own roof's shadow. And where the sun sees the plane, what is before it by
// less than a texel is joined to it, as in the folds of a cloth, which would be dark.
float visibleInMap(mat4 clipFromWorld, vec3 position, vec3 normal, int cascade) {
  const float kElsewhere = 0.002, kSeen = 0.1;
  vec3 uvz = 0.5 * (clipFromWorld * vec4(position, 1.0)).xyz + 0.5;
  vec2 size = vec2(textureSize(shadowMap, 0).xy), place = uvz.xy * size, middle = floor(place);
  ivec2 texel = clampedInt(middle, ivec2(-2), textureSize(shadowMap, 0).xy + 1);
  if (normal == vec3(0.0)) return float(storedOrNothing(texel, cascade) >= min(uvz.z, 1.0));
  ShadowPlane plane = shadowPlane(clipFromWorld, normal);
  vec2 off = place - middle - 0.5;
  vec2 weights[3] = vec2[3](0.25 - 0.5 * off, vec2(0.5), 0.25 + 0.5 * off);
  float own = 0.0, blocked = 0.0, joined = 0.0, elsewhere = 0.0;
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 3; ++x) {
      vec2 step = vec2(x, y) - 1.0;
      float depth = uvz.z + dot(plane.slope, (step - off) / size);
      float stored = storedOrNothing(texel + ivec2(x, y) - 1, cascade), weight = weights[x].x * weights[y].y;
      if (stored >= min(depth + plane.away, 1.0)) elsewhere += weight;
      else if (stored >= depth) own += weight;
      else if (stored > depth - plane.away) joined += weight;
      else blocked += weight;
    }
  blocked += joined * max(1.0 - own / kSeen, 0.0);
  elsewhere *= kElsewhere;
  return (own + elsewhere) / (own + blocked + elsewhere);
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
    float border = 2.0 / float(textureSize(shadowMap, 0).x);  // the filter's radius
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
