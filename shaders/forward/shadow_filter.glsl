// The share of a light that a receiver sees, from the light's depth map. Planes are affine in such a map, orthographic
// or perspective, so the sun, spots and omnidirectional lamps share this filter. Flags: SUN and SUN_CASCADES (their
// number, 0: one map), SOFT_SPOTS and SOFT_POINTS (their numbers, if any has a size), PENUMBRA_TAPS (0: the sun has no
// disc, and lamps have no maps here).
#include "shared/bindings.h"
#include "lib/clamped_int.glsl"
#include "lib/frame.glsl"

struct ShadowReceiver {
  vec2 place;    // in the map, texels
  float depth;
  vec2 slope;    // d(depth)/d(place) of the receiver's plane
  float away;    // depth; what is stored farther from the plane than this is not joined to it
  mat2 spread;   // of the light's size: maps the unit disc to its cone in the map, texels by depth before the receiver
  float distant;  // depth; the cone's radius is a texel this far before the receiver
  float nearest;  // depth; nothing before the receiver is looked for nearer to the light
  int light;     // kSunMap, kSpotMap, kPointMap
  int layer;     // cascade or lamp
  vec3 axis, u, v;  // of a cube map's face
  float none;    // of a cube map: depth at infinity
};
const int kSunMap = 0, kSpotMap = 1, kPointMap = 2;

#if SUN  // by its map
#if SUN_CASCADES
layout(binding = UNIT_SUN_SHADOW) uniform sampler2DArray sunMap;
float sunDepth(ivec2 texel, int layer) { return texelFetch(sunMap, ivec3(texel, layer), 0).r; }
#else
layout(binding = UNIT_SUN_SHADOW) uniform sampler2D sunMap;
float sunDepth(ivec2 texel, int layer) { return texelFetch(sunMap, texel, 0).r; }
#endif
#endif
#if SOFT_SPOTS
layout(binding = UNIT_SPOT_SHADOWS) uniform sampler2DArray spotMaps;
#endif
#if SOFT_POINTS
layout(binding = UNIT_POINT_SHADOWS) uniform samplerCubeArray pointMaps;
#endif

// What the map stores at a place, 1 (nothing) outside of it.
float storedDepth(ShadowReceiver receiver, vec2 place) {
#if SOFT_POINTS
  if (receiver.light == kPointMap) {  // beyond the face's edge in the next face, whose depths are along its own axis
    vec2 t = place * (2.0 / float(textureSize(pointMaps, 0).x)) - 1.0;
    vec3 direction = receiver.axis + t.x * receiver.u + t.y * receiver.v, size = abs(direction);
    float stored = textureLod(pointMaps, vec4(direction, float(receiver.layer)), 0.0).r;
    return stored >= 1.0 ? 1.0 : receiver.none - max(size.x, max(size.y, size.z)) * (receiver.none - stored);
  }
#endif
  ivec2 size = ivec2(1);
#if SUN
  if (receiver.light == kSunMap) size = textureSize(sunMap, 0).xy;
#endif
#if SOFT_SPOTS
  if (receiver.light == kSpotMap) size = textureSize(spotMaps, 0).xy;
#endif
  ivec2 texel = clampedInt(floor(place), ivec2(-1), size);
  if (any(lessThan(texel, ivec2(0))) || any(greaterThanEqual(texel, size))) return 1.0;
#if SUN
  if (receiver.light == kSunMap) return sunDepth(texel, receiver.layer);
#endif
#if SOFT_SPOTS
  if (receiver.light == kSpotMap) return texelFetch(spotMaps, ivec3(texel, receiver.layer), 0).r;
#endif
  return 1.0;
}

#if PENUMBRA_TAPS
// Two numbers in [0, 1) that differ between neighbouring pixels [Jimenez2014] and between a pixel's samples, which fill
// the square evenly [Roberts2018].
vec2 penumbraNoise() {
  vec2 mixed = vec2(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715)),
                    dot(gl_FragCoord.yx, vec2(0.06711056, 0.00583715)) + 0.5);
  return fract(fract(52.9829189 * fract(mixed)) + float(frame.pixelSample) * vec2(0.7548776662, 0.5698402910));
}

// Percentage-closer soft shadows [Fernando2005] of what is distant. The mean of blockers' depths gives the penumbra's
// radius, and the share of lit places within it the light. Places lie on a spiral that fills the disc evenly
// [Vogel1979]; those of the search lie more densely around the receiver, where the cone is narrow. A blocker counts
// less the farther it lies outside of the cone, where it covers nothing of the light. What is nearer is left to the
// tent, with some overlap: beside a place that is just distant is another that is just not, beyond the reach of its
// tent.
float pastDistantBlockers(ShadowReceiver receiver) {
  const float kOverlap = 0.75;
  float distant = kOverlap * receiver.distant;
  const int kSearch = PENUMBRA_TAPS / 2, kTaps = PENUMBRA_TAPS;
  const mat2 kTurn = mat2(-0.737368878, 0.675490294, -0.675490294, -0.737368878);  // by the golden angle
  vec2 noise = penumbraNoise();
  float turn = 6.28318531 * noise.x, reach = receiver.depth - receiver.nearest;
  vec2 direction = vec2(cos(turn), sin(turn));
  float found = 0.0, heights = 0.0;
  for (int i = 0; i < kSearch; ++i) {
    float radius = (float(i) + noise.y) / float(kSearch);
    vec2 offset = receiver.spread * (reach * radius * direction);
    float stored = storedDepth(receiver, receiver.place + offset), height = receiver.depth - stored;
    if (stored < receiver.depth + dot(receiver.slope, offset) - distant && height > 0.0) {
      float outside = reach * radius / height, weight = 1.0 / (1.0 + pow(outside, 8.0));
      found += weight;
      heights += weight * height;
    }
    direction = kTurn * direction;
  }
  if (!(found > 0.0)) return 1.0;
  float height = heights / found, lit = 0.0;
  for (int i = 0; i < kTaps; ++i) {
    vec2 offset = receiver.spread * (height * sqrt((float(i) + noise.y) / float(kTaps)) * direction);
    float depth = receiver.depth + dot(receiver.slope, offset);
    lit += float(storedDepth(receiver, receiver.place + offset) >= min(depth - distant, 1.0));
    direction = kTurn * direction;
  }
  return lit / float(kTaps);
}
#endif

// A 3x3 tent of comparisons, each with the depth that the receiver's plane has at the middle of that texel. Texels that
// store the plane itself are lit, those that store something before it are not. Two kinds say nothing about the plane
// and nearly do not count. The tent reaches past the edge of a surface: what is behind the plane would light a wall
// that stands in its own roof's shadow. And where the light sees the plane, what is before it by less than a texel is
// joined to it, as in the folds of a cloth, which would be dark. What is distant has a penumbra wider than the tent.
float visibleShare(ShadowReceiver receiver) {
  const float kElsewhere = 0.002, kSeen = 0.1;
  vec2 middle = floor(receiver.place) + 0.5, off = receiver.place - middle;
  vec2 weights[3] = vec2[3](0.25 - 0.5 * off, vec2(0.5), 0.25 + 0.5 * off);
  float own = 0.0, blocked = 0.0, joined = 0.0, elsewhere = 0.0, distant = 0.0;
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 3; ++x) {
      vec2 step = vec2(x, y) - 1.0;
      float depth = receiver.depth + dot(receiver.slope, step - off);
      float stored = storedDepth(receiver, middle + step), weight = weights[x].x * weights[y].y;
      if (stored >= min(depth + receiver.away, 1.0)) elsewhere += weight;
      else if (stored >= depth) own += weight;
      else if (stored > depth - receiver.away) joined += weight;
#if PENUMBRA_TAPS
      else if (stored <= depth - receiver.distant) distant += weight;
#endif
      else blocked += weight;
    }
  blocked += joined * max(1.0 - (own + distant) / kSeen, 0.0);
  elsewhere *= kElsewhere;
  float all = own + blocked + elsewhere, near = all > 0.0 ? (own + elsewhere) / all : 1.0;
#if PENUMBRA_TAPS
  if (near > 0.0 && receiver.spread[0].x > 0.0) near *= pastDistantBlockers(receiver);
#endif
  return near;
}
