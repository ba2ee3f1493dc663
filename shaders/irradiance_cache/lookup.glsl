// Irradiance at a surface from the records around it. For each axis, interpolates trilinearly between the existing
// records whose surface leans the same way as the normal, weighted by the square of the normal's component. Alpha is
// how much a record counts, 0 in empty cells.
#include "shared/bindings.h"
#include "irradiance_cache/common.glsl"
#include "irradiance_cache/cascade_weight.glsl"
layout(binding = UNIT_CACHE) uniform sampler3D cacheIrradiance;  // faces of cascades stacked along z

// Position for a lookup in a cascade, in cells of one face.
vec3 cachePlace(int k, vec3 position) {
  float cells = float(grids.shape.x);
  vec3 texel = (position - grids.cascades[k].minimum) / grids.cascades[k].cellSize;
  texel.z = clamp(texel.z, 0.5, cells - 0.5);  // the next face's layers follow
  return texel;
}

// xyz: irradiance in cacheUnit(), times w; w: total weight of the records found.
vec4 cachedInCascade(int k, vec3 position, vec3 normal) {
  float cells = float(grids.shape.x);
  vec3 uvw = cachePlace(k, position) / vec3(cells, cells, cells * float(grids.shape.y * CACHE_FACES));
  vec4 sum = vec4(0.0);
  for (int axis = 0; axis < 3; ++axis) {
    float layer = float(k * CACHE_FACES + faceOf(axis, normal[axis])) / float(grids.shape.y * CACHE_FACES);
    sum += normal[axis] * normal[axis] * textureLod(cacheIrradiance, uvw + vec3(0.0, 0.0, layer), 0.0);
  }
  return sum;
}

#if SHOWS_PARTS
#include "lib/clamped_int.glsl"
#include "irradiance_cache/parts.glsl"
layout(binding = UNIT_CACHE_PARTS) uniform samplerBuffer cacheParts;  // of a part: as in a cell

// The same from the parts of split cells.
vec4 cachedInParts(int k, vec3 position, vec3 normal) {
  vec3 place = float(SPLIT) * cachePlace(k, position) - 0.5, near = fract(place);
  ivec3 first = SPLIT * cache.firstCell[k].xyz +
                clampedInt(floor(place), ivec3(-1), ivec3(SPLIT * grids.shape.x));
  vec4 sum = vec4(0.0);
  for (int i = 0; i < 24; ++i) {
    int axis = i >> 3;
    ivec3 corner = ivec3(i, i >> 1, i >> 2) & 1;
    vec3 weights = mix(1.0 - near, near, vec3(corner));
    float weight = normal[axis] * normal[axis] * weights.x * weights.y * weights.z;
    if (!(weight > 0.0)) continue;
    int part = partOf(k, faceOf(axis, normal[axis]), first + corner);
    if (part >= 0) sum += weight * texelFetch(cacheParts, part);
  }
  return sum;
}
#endif

// Enough of a cascade: the least that a point's own record contributes, 1/8 of its blend weight of at least 1/4. A
// weight below kLeast is only the filter's rounding: its colour would be noise.
const float kEnough = 1.0 / 32.0, kLeast = 1e-5, kEnoughParts = 1.0 / 8.0;

// From the finest cascade to the coarsest, each blended into the next near its reach and where it has few records.
// found: false if no cascade has any record.
vec3 cachedIrradiance(vec3 position, vec3 normal, out bool found) {
  vec3 irradiance = vec3(0.0);
  float left = 1.0, sum = 0.0, cells = 0.0;
  for (int k = 0; k < grids.shape.y && left > 0.0; ++k) {
    float weight = left * cacheCascadeWeight(k, position);
    if (!(weight > 0.0)) continue;
    vec4 here = cachedInCascade(k, position, normal);
    if (!(here.w > kLeast)) continue;
    weight *= min(here.w / kEnough, 1.0);
#if SHOWS_PARTS
    vec4 parts = cachedInParts(k, position, normal);
    float share = min(parts.w / kEnoughParts, 1.0);
    here.rgb /= here.w;
    here.w = 1.0;
    if (share > 0.0) here.rgb = mix(here.rgb, parts.rgb / parts.w, share);
#endif
    irradiance += weight * here.rgb / here.w;
    cells += weight * grids.cascades[k].cellSize;
    sum += weight;  // not 1 - left, which would cancel for a small weight
    left -= weight;
  }
  found = sum > 0.0;
  cellOfLight = found ? cells / sum : 0.0;
  return found ? irradiance * (cacheUnit() / sum) : vec3(0.0);
}
