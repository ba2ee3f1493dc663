// Spot and omnidirectional lights as the forward shader reads them: those with shadows in uniform block 3, all others
// in a storage block. Present only if the scene has such lights.
#pragma once
#include "shared/types.h"

SHARED_BEGIN

#define LIGHTS_MAX_SHADOWS 16  // lamps of a kind
#define PLAIN_LAMPS_BINDING 6  // a storage block

struct SpotLightConstants {
  mat4 clipFromPlace;  // perspective, of its shadow map, for positions relative to `position`
  vec3 position;
  float cosInner;      // of the cone's half angle of full intensity
  vec3 direction;      // unit, along the axis
  float cosOuter;      // of the half angle at which the intensity has fallen to zero
  vec3 intensity;      // W/sr on the axis
  float shadowTexel;   // width of a texel of the shadow map at depth 1 (scene units per scene unit)
  vec3 padding;
  float radius;        // of its ball; 0 where its shadow has no penumbra
};

struct PointLightConstants {
  vec3 position;
  float shadowTexel;   // width of a texel of the shadow map at depth 1 along the face's axis
  vec3 intensity;      // W/sr
  float depthScale;    // shadow map depth of a point at distance m along its face's axis: depthOffset - depthScale / m
  float radius;        // of its ball; 0 where its shadow has no penumbra
  float padding0, padding1;
  float depthOffset;
};

struct LightConstants {
  SpotLightConstants spots[LIGHTS_MAX_SHADOWS];
  PointLightConstants points[LIGHTS_MAX_SHADOWS];
};
SHARED_BLOCK(LightConstants)

// A lamp without a shadow map; rays may tell whether it is visible (rays/shadow_rays.comp).
struct PlainLamp {
  vec3 position;
  float cosInner;
  vec3 direction;      // of a spot
  float cosOuter;      // below -1: omnidirectional
  vec3 intensity;      // W/sr, of a spot on its axis
  float radius;        // of its ball
};

SHARED_END
