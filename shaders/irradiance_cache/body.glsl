// Media as previews see them, along rays (engine/irradiance_cache/bodies.hpp). A body is a dielectric, with a medium or
// clear; where bodies overlap, the one with the highest priority counts [SchmidtBudge2002]. Its medium absorbs along
// the ray. What it scatters is a surface's light: the share of the ray that is stopped shows the diffuse reflectance of
// a half-space under the light that falls onto the body. Clouds are walked through at random, with as many collisions
// as a preview has: within a boundary of index 1, or on a density grid behind a boundary of bsdf none, which rays do
// not meet. Scattering is isotropic, by similarity.
//
// Flags: BODIES, CLOUDS, GRIDS (clouds on density grids).
#include "shared/bodies.h"
// By material
layout(std430, binding = BODY_RECORDS_BUFFER) readonly restrict buffer BodyBlock { BodyRecord bodies[]; };

// The bodies around a ray, by material; -1: none. Of equal ones the last entered counts.
ivec4 aroundRay = ivec4(-1);
int bodyAround() {
  int top = -1;
  for (int i = 0; i < 4; ++i)
    if (aroundRay[i] >= 0 && (top < 0 || bodies[aroundRay[i]].priority >= bodies[top].priority)) top = aroundRay[i];
  return top;
}
void enterBody(int material) {
  for (int i = 0; i < 4; ++i)
    if (aroundRay[i] < 0) {
      aroundRay[i] = material;
      return;
    }
}
void leaveBody(int material) {
  for (int i = 0; i < 4; ++i)
    if (aroundRay[3 - i] == material) {
      aroundRay[3 - i] = -1;
      return;
    }
}
float iorOf(int body) { return body < 0 ? 1.0 : bodies[body].ior; }

#if CLOUDS
int cloudAround = -1;  // the material of the matched boundary that the ray is in, -1: none
#if GRIDS
#include "pathtracer/density.glsl"
uniform uvec4 gridClouds;  // materials, GRIDS of them
const int kCloudSteps = 48;
#endif

// Whether light collides within `distance`, which then is where. Distances are drawn by the mean of the channels'
// extinction, and the channels weighted by what they are. xi: two random numbers.
bool collidesIn(int material, vec3 origin, vec3 direction, vec2 xi, inout float distance, inout vec3 throughput) {
  BodyRecord cloud = bodies[material];
  float mean = (cloud.extinction.r + cloud.extinction.g + cloud.extinction.b) / 3.0, depth = -log(1.0 - xi.x),
        passed = 0.0;  // optical depths by the mean
  if (!(mean > 0.0)) return false;
  bool isHit = false;
#if GRIDS
  if (cloud.grid >= 0) {
    DensityRecord grid = densityRecords[cloud.grid];
    DensityMarch march;
    if (!densityMarchStart(grid, origin, direction, distance, march)) return false;
    float stride = (march.last - march.near) / float(kCloudSteps);
    for (int i = 0; i < kCloudSteps && !isHit; ++i) {
      float t = march.near + (float(i) + xi.y) * stride,
            here = mean * stride * densityAt(grid, march.origin + t * march.direction);
      isHit = here > 0.0 && passed + here >= depth;
      if (isHit) distance = march.near + (float(i) + (depth - passed) / here) * stride;
      passed = isHit ? depth : passed + here;
    }
  } else
#endif
  {
    isHit = mean * distance >= depth;
    if (isHit) distance = depth / mean;
    passed = mean * distance;
  }
  throughput *= exp(passed * (1.0 - cloud.extinction / mean));
  if (isHit) throughput *= cloud.extinction / mean * cloud.albedo;
  return isHit;
}

// The same in all clouds around the ray.
bool collides(vec3 origin, vec3 direction, uvec4 words, inout float distance, inout vec3 throughput) {
  vec2 xi = unitFloat(words.xy);
  bool isHit = cloudAround >= 0 && collidesIn(cloudAround, origin, direction, xi, distance, throughput);
#if GRIDS
  for (int i = 0; i < GRIDS; ++i) {
    words = pcg4d(words);
    isHit = collidesIn(int(gridClouds[i]), origin, direction, unitFloat(words.xy), distance, throughput) || isHit;
  }
#endif
  return isHit;
}

vec3 isotropicDirection(vec2 xi) {
  float z = 1.0 - 2.0 * xi.x, r = sqrt(max(1.0 - z * z, 0.0)), angle = 2.0 * kPi * xi.y;
  return vec3(r * cos(angle), r * sin(angle), z);
}
#endif
