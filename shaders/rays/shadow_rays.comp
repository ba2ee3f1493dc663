// Which lights reach the surface at a point of each pixel: one bit a light, the sun's first where there is one, then
// the lamps', 128 in a layer. One ray goes to each light, to a point of its disc or ball that differs from pixel to
// pixel and from sample to sample, so that the mean of a pixel's samples is the visible share. One sequence of points
// serves the samples of all pixels along a Morton curve, so that those of neighbouring pixels are stratified together
// as well and their noise is blue [AhmedWonka2020]. A pixel with one sample looks at the middle.
layout(local_size_x = 8, local_size_y = 8) in;
#include "shared/bindings.h"
#include "shared/lights.h"
#include "shared/path_tracer.h"
layout(std140, binding = BLOCK_CACHE_PATHS) uniform PathBlock { PathConstants tracer; };
#include "rays/random.glsl"
#include "rays/bsdf.glsl"
#include "rays/materials.glsl"
#include "rays/bvh.glsl"
#include "rays/shadow_start.glsl"
#include "rays/view.glsl"
#include "lib/round_light.glsl"
#include "lib/morton.glsl"
#if WIDE
layout(binding = 0, rgba32ui) writeonly restrict uniform uimage2DArray visibleLights;
#else
layout(binding = 0, r32ui) writeonly restrict uniform uimage2DArray visibleLights;
#endif
#if LAMPS
layout(std430, binding = PLAIN_LAMPS_BINDING) readonly restrict buffer PlainLampBlock { PlainLamp lamps[]; };
#endif
uniform vec3 drawnOrigin;  // of lamps' positions, in the ray caster's coordinates
uniform vec3 sunDirection;
uniform float sunLessCosine;  // 1 - cosine of half its diameter
uniform ivec2 firstPixel;
uniform int pixelSample;  // its number; below 0: the only one
uniform uint samplesOfPixel;  // a power of two

void main() {
  ivec2 pixel = firstPixel + ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, tracer.picture.xy))) return;
  Ray view = Ray(vec3(0.0), 0.0, vec3(0.0), 3e38);
  viewRay(vec2(pixel) + 0.5, view.origin, view.direction);
  Hit hit = closestHit(view, kNoHit);
  bool isHit = hit.triangle != kNoHit;
  Surface surface;
  ShadowStart start;
  if (isHit) {
    surface = surfaceAt(hit.triangle, hit.barycentrics, view.direction);
    start = shadowStart(surface, hit.triangle);
  }
  PathNumbers numbers = PathNumbers(0u, mortonOf(pixel) * samplesOfPixel + uint(max(pixelSample, 0)), 0u);
  const int kCount = SUN_RAYS + LAMPS;
  for (int first = 0; first < kCount; first += 128) {
    uvec4 reached = uvec4(0u);
    int last = isHit ? min(first + 128, kCount) : first;
    for (int i = first; i < last; ++i) {
      vec2 xi = pixelSample < 0 ? vec2(0.0) : randomPair(numbers, 0u, kFreePurpose + uint(i));
#if SUN_RAYS
      if (i == 0) {
        Ray ray = Ray(start.origin, 0.0, coneSample(-sunDirection, sunLessCosine, xi), 3e38);
        if (dot(ray.direction, start.normal) > 0.0 && !anyHit(ray, start.skip)) reached.x |= 1u;
        continue;
      }
#endif
#if LAMPS
      PlainLamp lamp = lamps[i - SUN_RAYS];
      vec3 away = lamp.position + drawnOrigin - start.origin;
      float distance2 = max(dot(away, away), 1e-30);
      if (lamp.radius > 0.0) {
        vec3 direction =
            coneSample(away * inversesqrt(distance2), ballLessCosine(lamp.radius, distance2), xi);
        away = direction * distanceToBall(away, lamp.radius, direction);
      }
      bool faces = dot(away + start.origin - surface.position, start.normal) > 0.0;
      if (faces && !anyHitToLamp(Ray(start.origin, 0.0, away, 1.0), start.skip))
        reached[i >> 5 & 3] |= 1u << (i & 31);
#endif
    }
    imageStore(visibleLights, ivec3(pixel, first >> 7), reached);
  }
}
