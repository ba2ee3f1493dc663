// Glossy reflection of the volume's light [Kaplanyan2010, "glossy reflections"; LPV2015, 8: a wish of its author].
//
// A surface reflects radiance L(i) into direction o as the integral of f(o, i) L(i) <n, i> over its hemisphere. With L
// of two bands, L(i) = Y00 l0 - Y1 <l1, i> (light from i travels along -i), that is exactly
//   Y00 rho l0 - Y1 <l1, m>,  rho = integral of f <n, i>,  m = integral of f <n, i> i,
// so all that a lobe needs is its reflectance rho and its moment m (lpv/glossy_lobes.hpp has the table). f: the coat's
// reflection (lib/coat.glsl).
// L is what the first surface along a ray of the lobe sends, as radiance does not change along a ray (a constant
// radiance is always reflected as rho L). A march finds it: surfels of area A cover A cos / s^2 of a ray's cross
// section in a cell, which band 1 of their potential A / s^2 lobe(n) holds as A / (2 s^2) cos. A ray meets a layer of
// them 1 / cos times, so a closed surface covers all of it. Light is read once, a cell before half of the ray is
// covered: behind a surface it is dark, and software renderers would run a lookup in every step.
#include "shared/lpv.h"
#include "lib/coat.glsl"
#include "lpv/radiance.glsl"
layout(binding = UNIT_LPV_LOBES) uniform sampler2D lpvLobes;

// (rho, m along the mirror direction's tangent, m along the normal) of facets of reflectance 1, and weighted by
// Schlick's (1 - <o, h>)^5.
void glossyLobe(float cosine, float alpha, out vec3 facets, out vec3 grazing) {
  vec2 table = vec2(LPV_LOBES_ANGLES, LPV_LOBES_ALPHAS);  // texels; the weighted ones follow above
  vec2 at = clamp(vec2(acos(min(cosine, 1.0)) * 2.0 / kPi, sqrt(alpha)) * table, vec2(0.5), table - 0.5);
  facets = textureLod(lpvLobes, at / table * vec2(1.0, 0.5), 0.0).xyz;
  grazing = textureLod(lpvLobes, at / table * vec2(1.0, 0.5) + vec2(0.0, 0.5), 0.0).xyz;
}

float lpvCellSizeAt(vec3 position) {
  float size = 0.0, left = 1.0;
  for (int k = 0; k < grids.shape.y && left > 0.0; ++k) {
    float weight = left * cascadeWeight(k, position);
    left -= weight;
    size += weight * grids.cascades[k].cellSize;
  }
  return size;
}

layout(binding = UNIT_LPV_GEOMETRY) uniform sampler3D lpvGeometry;

// Part of a ray's cross section that surfels facing its origin cover in a cell.
float lpvCovered(vec3 position, vec3 direction) {
  float corners = float(grids.shape.x + 1), left = 1.0;
  vec3 potential = vec3(0.0);
  for (int k = 0; k < grids.shape.y && left > 0.0; ++k) {
    float weight = left * cascadeWeight(k, position);
    left -= weight;
    if (weight <= 0.0) continue;
    // Samples lie on the corners.
    vec3 texel = (position - grids.cascades[k].minimum) / grids.cascades[k].cellSize + 0.5;
    float border = clamp(min(texel.z, corners - texel.z) + 0.5, 0.0, 1.0);
    texel.z = clamp(texel.z, 0.5, corners - 0.5) + float(k) * corners;
    vec3 place = texel / vec3(corners, corners, corners * float(grids.shape.y));
    potential += weight * border * textureLod(lpvGeometry, place, 0.0).yzw;
  }
  return clamp(-2.0 * kY1 * dot(potential, direction), 0.0, 1.0);
}

mat3x4 lpvLightAlong(vec3 position, vec3 direction) {
  float left = 1.0;
  vec3 at = position + lpvCellSizeAt(position) * direction;  // a surface does not meet itself
  for (int i = 1; i < grids.shape.z; ++i) {
    vec3 next = at + lpvCellSizeAt(at) * direction;
    left -= lpvCovered(next, direction);
    if (left < 0.5) break;
    at = next;
  }
  return lpvRadiance(at);
}

// Radiance reflected towards the camera. normal: on the camera's side.
vec3 lpvGlossy(vec3 position, vec3 normal, vec3 toCamera, Coat coat) {
  float cosine = max(dot(normal, toCamera), 0.0);
  vec3 across = cosine * normal - toCamera;
  // Towards the mirror direction; any tangent where the camera looks along the normal.
  if (dot(across, across) < 1e-8) across = cross(normal, abs(normal.x) < 0.7 ? vec3(1, 0, 0) : vec3(0, 1, 0));
  across = normalize(across);
  vec3 facets, grazing;
  glossyLobe(cosine, coat.alpha, facets, grazing);
  vec3 direction = normalize(facets.y * across + facets.z * normal);

  // Directions spread evenly over a cap about the mean [Vogel1979]. Their mean, (1 + the cosine at its border) / 2, is
  // as long as the lobe's.
  float meanLength = clamp(length(facets.yz) / max(facets.x, 1e-6), 0.5, 1.0);
  vec3 side = normalize(cross(normal, across)), over = cross(direction, side);
  mat3x4 light = mat3x4(0.0);
  float directions = 0.0;
  for (int i = 0; i < LPV_GLOSSY_RAYS; ++i) {
    float z = 1.0 - 2.0 * (1.0 - meanLength) * (float(i) + 0.5) / float(LPV_GLOSSY_RAYS);
    float turn = 2.399963229728653 * float(i);
    vec3 one = z * direction + sqrt(max(1.0 - z * z, 0.0)) * (cos(turn) * side + sin(turn) * over);
    if (dot(one, normal) <= 0.0) continue;
    light += lpvLightAlong(position, one);
    directions += 1.0;
  }
  light /= max(directions, 1.0);

  vec3 reflected;
  for (int c = 0; c < 3; ++c) {
    vec3 lobe = coat.specular[c] * facets + (coatGrazing(coat.specular) - coat.specular[c]) * grazing;
    vec3 moment = lobe.y * across + lobe.z * normal;
    reflected[c] = max(dot(light[c], vec4(kY00 * lobe.x, -kY1 * moment)), 0.0);
  }
  return reflected * grids.referenceIrradiance;
}
