// Incoming light from spot and omnidirectional lights: E = I(omega) cos / d^2. The flags SPOTS and POINTS give the
// numbers of those with shadows; PLAIN_LAMPS: whether there are others.
#include "shared/bindings.h"
#include "lib/spot.glsl"
#include "shared/lights.h"
layout(std140, binding = BLOCK_LIGHTS) uniform LightBlock { LightConstants lights; };

struct Arriving {
  vec3 irradiance;
  vec3 toLight;  // unit
  float cosine;  // to the normal; no light arrives at or below 0
};

const float kNormalOffset = 1.5;  // texels of the shadow map at the receiver's depth
// squared distance; a surface point inside the lamp has no direction to it and gets no light rather than NaN
const float kTouching = 1e-30;

#if SPOTS
layout(binding = UNIT_SPOT_SHADOWS) uniform sampler2DArrayShadow spotShadows;

// The visible fraction, from four bilinear depth comparisons that form a 3x3 tent filter. The receiver has been moved
// along its normal, and the map is rendered with a depth offset by slope. Without derivatives, since lanes outside of
// the cone have left.
float spotShadowTap(vec4 place) { return textureGrad(spotShadows, place, vec2(0.0), vec2(0.0)); }
float spotShadowTent(float layer, vec3 uvz) {
  float d = 0.5 / float(textureSize(spotShadows, 0).x);
  return 0.25 * (spotShadowTap(vec4(uvz.xy + vec2(-d, -d), layer, uvz.z)) +
                 spotShadowTap(vec4(uvz.xy + vec2(d, -d), layer, uvz.z)) +
                 spotShadowTap(vec4(uvz.xy + vec2(-d, d), layer, uvz.z)) +
                 spotShadowTap(vec4(uvz.xy + vec2(d, d), layer, uvz.z)));
}

// normal: for shading; lifted: where the shadow is looked up, with an offset along meshNormal.
Arriving spotLight(int i, vec3 position, vec3 normal, vec3 lifted, vec3 meshNormal) {
  vec3 away = lights.spots[i].position - position;
  float distance2 = dot(away, away);
  Arriving result = Arriving(vec3(0.0), away * inversesqrt(max(distance2, kTouching)), 0.0);
  result.cosine = dot(normal, result.toLight);
  float falloff =
      spotFalloff(-dot(result.toLight, lights.spots[i].direction), lights.spots[i].cosInner, lights.spots[i].cosOuter);
  if (result.cosine <= 0.0 || falloff <= 0.0) return result;
  float depth = -dot(away, lights.spots[i].direction);
  vec4 clip = lights.spots[i].clipFromPlace *
              vec4(lifted - position + meshNormal * (kNormalOffset * lights.spots[i].shadowTexel * depth) - away, 1.0);
  float visible = clip.w > 0.0 ? spotShadowTent(float(i), 0.5 * clip.xyz / clip.w + 0.5) : 1.0;
  result.irradiance = lights.spots[i].intensity * (falloff * result.cosine / distance2 * visible);
  return result;
}
#endif

#if POINTS
layout(binding = UNIT_POINT_SHADOWS) uniform samplerCubeArrayShadow pointShadows;

float pointShadowTap(int i, vec3 fromLight) {
  vec3 size = abs(fromLight);
  float depth = lights.points[i].depthOffset - lights.points[i].depthScale / max(size.x, max(size.y, size.z));
  return texture(pointShadows, vec4(fromLight, float(i)), clamp(depth, 0.0, 1.0));
}

Arriving pointLight(int i, vec3 position, vec3 normal, vec3 lifted, vec3 meshNormal) {
  vec3 away = lights.points[i].position - position;
  float distance2 = dot(away, away);
  Arriving result = Arriving(vec3(0.0), away * inversesqrt(max(distance2, kTouching)), 0.0);
  result.cosine = dot(normal, result.toLight);
  // All lanes look up the map, lit or not: GLSL has no lookup in a cube's shadow map without derivatives.
  // Depth is measured along the face's axis, that of the largest component.
  vec3 size = abs(away);
  float texel = lights.points[i].shadowTexel * max(size.x, max(size.y, size.z));
  vec3 fromLight = lifted - position + meshNormal * (kNormalOffset * texel) - away;
  // Half a texel along the face's two axes. A tap beyond the face's edge is looked up in the neighbouring face, at the
  // depth measured along that face's axis.
  vec3 u = size.x >= size.y && size.x >= size.z ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0);
  vec3 v = size.z > size.x && size.z > size.y ? vec3(0.0, 1.0, 0.0) : vec3(0.0, 0.0, 1.0);
  u *= 0.5 * texel;
  v *= 0.5 * texel;
  float visible = 0.25 * (pointShadowTap(i, fromLight + u + v) + pointShadowTap(i, fromLight + u - v) +
                          pointShadowTap(i, fromLight - u + v) + pointShadowTap(i, fromLight - u - v));
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
