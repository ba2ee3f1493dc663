// Incoming light from spot and omnidirectional lights: E = I(omega) cos / d^2. The flags SPOTS and POINTS give the
// numbers of those with shadow maps, SOFT_SPOTS and SOFT_POINTS the same if any of them has a size; PLAIN_LAMPS:
// whether there are others. Soft ones need forward/shadow_filter.glsl.
#include "shared/bindings.h"
#include "lib/spot.glsl"
#include "shared/lights.h"
layout(std140, binding = BLOCK_LIGHTS) uniform LightBlock { LightConstants lights; };

struct Arriving {
  vec3 irradiance;
  vec3 toLight;  // unit
  float cosine;  // to the normal; no light arrives at or below 0
};

// texels of the shadow map at the receiver's depth; the second where lookups follow the receiver's plane
const float kNormalOffset = 1.5, kSoftNormalOffset = 0.1;
// squared distance; a surface point inside the lamp has no direction to it and gets no light rather than NaN
const float kTouching = 1e-30;

#if SOFT_SPOTS || SOFT_POINTS
// In the map of a view along `axis`, of `size` texels a side. Depth at the distance z along the axis is none - scale /
// z, so that planes are affine. A ball of radius R covers R (1 / z' - 1 / z) of the map at depth 1 before a blocker at
// z', drawn out away from the axis. It is looked for up to a fourth of the way from the lamp.
ShadowReceiver lampReceiver(vec3 fromLight, vec3 normal, vec3 axis, vec3 u, vec3 v, float texelAtOne, float size,
                            float none, float scale, float radius) {
  ShadowReceiver receiver;
  float along = max(dot(fromLight, axis), 1e-30), distance = length(fromLight), towards = dot(normal, fromLight);
  vec2 t = vec2(dot(fromLight, u), dot(fromLight, v)) / along;
  float cosine = max(abs(towards) / distance, 0.0175);
  vec3 n = towards > 0.0 ? -normal : normal;
  receiver.place = t / texelAtOne + 0.5 * size;
  receiver.depth = none - scale / along;
  receiver.slope = vec2(dot(n, u), dot(n, v)) * (scale * texelAtOne / (cosine * distance));
  receiver.away = scale * texelAtOne / (along * cosine);
  float texels = radius / (scale * texelAtOne), drawnOut = texels / (1.0 + sqrt(1.0 + dot(t, t)));
  receiver.spread = mat2(texels + drawnOut * t.x * t.x, drawnOut * t.x * t.y, drawnOut * t.x * t.y,
                         texels + drawnOut * t.y * t.y);
  receiver.distant = max(1.0 / max(texels, 1e-30), receiver.away);
  receiver.nearest = none - 4.0 * scale / along;
  receiver.axis = axis;
  receiver.u = u;
  receiver.v = v;
  receiver.none = none;
  return receiver;
}
#endif

#if SPOTS
#if SOFT_SPOTS
float spotVisibility(int i, vec3 fromLight, vec3 normal) {
  mat4 rows = transpose(lights.spots[i].clipFromPlace);
  vec3 u = normalize(rows[0].xyz), v = normalize(rows[1].xyz), axis = rows[3].xyz;
  float scale = -0.5 * rows[2].w, none = 0.5 + 0.5 * dot(rows[2].xyz, axis);
  ShadowReceiver receiver =
      lampReceiver(fromLight, normal, axis, u, v, lights.spots[i].shadowTexel, float(textureSize(spotMaps, 0).x), none,
                   scale, lights.spots[i].radius);
  receiver.light = kSpotMap;
  receiver.layer = i;
  return visibleShare(receiver);
}
#else
layout(binding = UNIT_SPOT_SHADOWS) uniform sampler2DArrayShadow spotShadows;

// The visible fraction, from four bilinear depth comparisons that form a 3x3 tent filter. The receiver has been moved
// along its normal, and the map is rendered with a depth offset by slope. Without derivatives, since lanes outside of
// the cone have left.
float spotShadowTap(vec4 place) { return textureGrad(spotShadows, place, vec2(0.0), vec2(0.0)); }
float spotVisibility(int i, vec3 fromLight, vec3 normal) {
  vec4 clip = lights.spots[i].clipFromPlace * vec4(fromLight, 1.0);
  if (clip.w <= 0.0) return 1.0;
  vec3 uvz = 0.5 * clip.xyz / clip.w + 0.5;
  float layer = float(i), d = 0.5 / float(textureSize(spotShadows, 0).x);
  return 0.25 * (spotShadowTap(vec4(uvz.xy + vec2(-d, -d), layer, uvz.z)) +
                 spotShadowTap(vec4(uvz.xy + vec2(d, -d), layer, uvz.z)) +
                 spotShadowTap(vec4(uvz.xy + vec2(-d, d), layer, uvz.z)) +
                 spotShadowTap(vec4(uvz.xy + vec2(d, d), layer, uvz.z)));
}
#endif

// normal: for shading; lifted: where the shadow is looked up, with an offset along faceNormal.
Arriving spotLight(int i, vec3 position, vec3 normal, vec3 lifted, vec3 faceNormal) {
  vec3 away = lights.spots[i].position - position;
  float distance2 = dot(away, away);
  Arriving result = Arriving(vec3(0.0), away * inversesqrt(max(distance2, kTouching)), 0.0);
  result.cosine = dot(normal, result.toLight);
  float falloff =
      spotFalloff(-dot(result.toLight, lights.spots[i].direction), lights.spots[i].cosInner, lights.spots[i].cosOuter);
  if (result.cosine <= 0.0 || falloff <= 0.0) return result;
  float depth = -dot(away, lights.spots[i].direction);
  float texels = SOFT_SPOTS > 0 ? kSoftNormalOffset : kNormalOffset;
  vec3 offset = faceNormal * (texels * lights.spots[i].shadowTexel * depth);
  float visible = spotVisibility(i, lifted - position + offset - away, faceNormal);
  result.irradiance = lights.spots[i].intensity * (falloff * result.cosine / distance2 * visible);
  return result;
}
#endif

#if POINTS
#if SOFT_POINTS
float pointVisibility(int i, vec3 fromLight, vec3 normal, vec3 u, vec3 v, float texel) {
  ShadowReceiver receiver =
      lampReceiver(fromLight, normal, sign(dot(fromLight, cross(u, v))) * cross(u, v), u, v,
                   lights.points[i].shadowTexel, float(textureSize(pointMaps, 0).x), lights.points[i].depthOffset,
                   lights.points[i].depthScale, lights.points[i].radius);
  receiver.light = kPointMap;
  receiver.layer = i;
  return visibleShare(receiver);
}
#else
layout(binding = UNIT_POINT_SHADOWS) uniform samplerCubeArrayShadow pointShadows;

float pointShadowTap(int i, vec3 fromLight) {
  vec3 size = abs(fromLight);
  float depth = lights.points[i].depthOffset - lights.points[i].depthScale / max(size.x, max(size.y, size.z));
  return texture(pointShadows, vec4(fromLight, float(i)), clamp(depth, 0.0, 1.0));
}

// Half a texel along the face's two axes. A tap beyond the face's edge is looked up in the neighbouring face, at the
// depth measured along that face's axis.
float pointVisibility(int i, vec3 fromLight, vec3 normal, vec3 u, vec3 v, float texel) {
  u *= 0.5 * texel;
  v *= 0.5 * texel;
  return 0.25 * (pointShadowTap(i, fromLight + u + v) + pointShadowTap(i, fromLight + u - v) +
                 pointShadowTap(i, fromLight - u + v) + pointShadowTap(i, fromLight - u - v));
}
#endif

Arriving pointLight(int i, vec3 position, vec3 normal, vec3 lifted, vec3 faceNormal) {
  vec3 away = lights.points[i].position - position;
  float distance2 = dot(away, away);
  Arriving result = Arriving(vec3(0.0), away * inversesqrt(max(distance2, kTouching)), 0.0);
  result.cosine = dot(normal, result.toLight);
  // All lanes look up a map that compares, lit or not: GLSL has no lookup in a cube's shadow map without derivatives.
  // Depth is measured along the face's axis, that of the largest component.
  vec3 size = abs(away);
  float texel = lights.points[i].shadowTexel * max(size.x, max(size.y, size.z));
  vec3 offset = faceNormal * ((SOFT_POINTS > 0 ? kSoftNormalOffset : kNormalOffset) * texel);
  vec3 u = size.x >= size.y && size.x >= size.z ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0);
  vec3 v = size.z > size.x && size.z > size.y ? vec3(0.0, 1.0, 0.0) : vec3(0.0, 0.0, 1.0);
  float visible = 0.0;
  if (SOFT_POINTS == 0 || result.cosine > 0.0)
    visible = pointVisibility(i, lifted - position + offset - away, faceNormal, u, v, texel);
  if (result.cosine > 0.0) result.irradiance = lights.points[i].intensity * (result.cosine / distance2 * visible);
  return result;
}
#endif

#if PLAIN_LAMPS
layout(std430, binding = PLAIN_LAMPS_BINDING) readonly restrict buffer PlainLampBlock { PlainLamp plainLamps[]; };

Arriving plainLamp(int i, vec3 position, vec3 normal) {
  PlainLamp lamp = plainLamps[i];
  vec3 away = lamp.position - position;
  float distance2 = max(dot(away, away), kTouching);
  Arriving result = Arriving(vec3(0.0), away * inversesqrt(distance2), 0.0);
  result.cosine = dot(normal, result.toLight);
  float falloff =
      lamp.cosOuter < -1.0 ? 1.0 : spotFalloff(-dot(result.toLight, lamp.direction), lamp.cosInner, lamp.cosOuter);
  if (result.cosine > 0.0) result.irradiance = lamp.intensity * (falloff * result.cosine / distance2);
  return result;
}
#endif
