// Direct light at a point by shadow rays, reflected; see engine/radiosity/direct_rays.hpp. Storage block 1, texture
// units 60 and 61. Unoccluded irradiance from an emissive triangle is computed in closed form (radiosity/polygon.glsl).
// Its visible fraction is the mean over points of the triangle, evenly distributed by area and weighted by their
// contribution, so without a blocker there is no noise.
#include "lib/spot.glsl"
#include "lib/tangent.glsl"
#include "lib/round_light.glsl"
#include "rays/bvh.glsl"
#include "radiosity/polygon.glsl"

struct DirectLight {
  vec4 a, b, c, d;  // Light in direct_rays.cpp
};
layout(std430, binding = 1) readonly buffer DirectLights {
  ivec4 directHead;  // lights, rays per triangle
  vec4 directOrigin;
  DirectLight directLights[];
};

// Hashes 32 bits per pixel [JarzynskiOlano2020, pcg2d] to two numbers in 0..1.
vec2 directShift(uvec2 v) {
  v = v * 1664525u + 1013904223u;
  v.x += v.y * 1664525u;
  v.y += v.x * 1664525u;
  v ^= v >> 16;
  v.x += v.y * 1664525u;
  v.y += v.x * 1664525u;
  v ^= v >> 16;
  return vec2(v >> 8) * 5.9604645e-8;
}

struct DirectReflection {
  vec3 base;  // albedo below the coat
  vec3 matt;  // radiance per irradiance of light from all sides
};

// position: of the pixel; normal: for shading; face: of the geometry; both unit, on the front side. plane: distance of
// the face's plane from the origin along `face`; magnitude: the largest coordinate of the triangle in the ray caster.
// A position interpolated over a large face is off by more than its own rounding, so it is projected back onto the
// plane. Rays then start beyond the rounding error of that triangle, as a path's do.
vec3 directRadiance(vec3 position, vec3 normal, vec3 face, float plane, float magnitude,
#if SPECULAR
                    Coat coat,
#endif
                    vec3 toCamera, DirectReflection reflected) {
  vec3 p = position - directOrigin.xyz - face * (dot(position, face) - plane), start = offsetRay(p, face, magnitude);
  vec3 u = normalize(abs(normal.x) > 0.5 ? vec3(normal.y, -normal.x, 0.0) : vec3(0.0, normal.z, -normal.y)),
       v = cross(normal, u);
  mat3 toFrame = mat3(u, v, normal);
  vec2 shift = directShift(uvec2(gl_FragCoord.xy));
  vec3 sum = vec3(0.0);
  for (int i = 0; i < directLights.length() && i < directHead.x; ++i) {
    DirectLight light = directLights[i];
    int kind = int(light.a.w);  // bounded: 0 to 3
    vec3 facing = kind == 0 ? cross(light.b.xyz, light.c.xyz) : vec3(0.0);
    vec3 unblocked = vec3(0.0);
    if (kind == 0) {
      vec3 a = light.a.xyz - p, ab = light.b.xyz * toFrame, ca = -light.c.xyz * toFrame;
      if (dot(a, facing) != 0.0)
        unblocked = light.d.xyz * formFactor(a * toFrame, ab, (light.c.xyz - light.b.xyz) * toFrame, ca);
    } else {
      vec3 to = kind == 1 ? light.a.xyz : light.a.xyz - p;
      float distance2 = dot(to, to);
      unblocked = light.d.xyz * max(dot(to, normal) * inversesqrt(distance2), 0.0);
      if (kind > 1) unblocked /= distance2;
      if (kind == 2) unblocked *= spotFalloff(-dot(to, light.b.xyz) * inversesqrt(distance2), light.b.w, light.c.w);
    }
    if (!any(greaterThan(unblocked, vec3(0.0)))) continue;
    float open = 0.0, all = 0.0;
    // Samples of a pixel share the rays to a triangle; each has one to a disc or a ball, a single one to its middle.
    int rays = kind == 0 ? (directHead.y + frame.pixelSamples - 1) / frame.pixelSamples : 1;
    for (int k = 0; k < 4096 && k < rays; ++k) {
      // The R2 sequence, based on the plastic number [Roberts2018], shifted per pixel and folded onto the triangle.
      vec2 xi = fract(shift + float(k + 1 + frame.pixelSample * rays) * vec2(0.7548776662, 0.5698402910));
      float size = frame.pixelSamples > 1 ? light.d.w : 0.0;
      if (kind == 0 && xi.x + xi.y > 1.0) xi = 1.0 - xi;
      Ray ray;
      ray.origin = start;
      ray.tMin = 0.0;
      ray.tMax = 1.0;
      float weight = 1.0;
      if (kind == 0) {
        vec3 to = light.a.xyz + xi.x * light.b.xyz + xi.y * light.c.xyz - p;
        float distance2 = dot(to, to);
        weight = max(dot(to, normal), 0.0) * abs(dot(to, facing)) / (distance2 * distance2);
        ray.direction = to + (p - start);
      } else if (kind == 1) {
        ray.direction = coneSample(light.a.xyz, size, xi);
        ray.tMax = 3.0e38;
      } else {
        ray.direction = light.a.xyz - start;
        if (size > 0.0) {
          vec3 centre = ray.direction;
          float distance2 = dot(centre, centre);
          ray.direction = coneSample(centre * inversesqrt(distance2), ballLessCosine(size, distance2), xi);
          ray.direction *= distanceToBall(centre, size, ray.direction);
        }
      }
      all += weight;
      if (weight > 0.0 && !anyHitToLamp(ray, kNoHit)) open += weight;
    }
    vec3 perIrradiance = reflected.matt;
#if SPECULAR
    if (kind > 0)
      perIrradiance = coatedReflection(coat, reflected.base, normal, toCamera,
                                       normalize(kind == 1 ? light.a.xyz : light.a.xyz - p));
#endif
    vec3 leaving = all > 0.0 ? perIrradiance * unblocked * (open / all) : vec3(0.0);
    sum += leaving;
#if INSPECTED
    record(INSPECTED_LIGHTS + i, vec4(leaving, 0.0));
#endif
  }
  return sum;
}
