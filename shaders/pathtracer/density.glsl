// Heterogeneous media: a density on a grid scales a medium's coefficients. It is interpolated trilinearly between cell
// centres and is 0 outside its box. Each block of cells stores an upper bound of its interpolated density, neighbouring
// cells included. Tentative collisions are drawn at that bound's rate and classified as real or null at random
// [Woodcock1965; Novak2018]. The channel that decides is chosen as in media.glsl, so that here too no weight exceeds
// the number of channels.
#include "lib/clamped_int.glsl"
#include "pathtracer/media.glsl"

layout(std430, binding = 0) restrict readonly buffer DensityRecords { DensityRecord densityRecords[]; };
layout(std430, binding = 1) restrict readonly buffer Densities { float densities[]; };

float cellDensity(DensityRecord g, ivec3 cell) {
  ivec3 c = clamp(cell, ivec3(0), g.size.xyz - 1);
  return densities[g.firstDensity + c.x + g.size.x * (c.y + g.size.y * c.z)];
}

// p: in cells from the box's minimum corner, within the box.
float densityInside(DensityRecord g, vec3 p) {
  vec3 base = floor(p - 0.5), f = p - 0.5 - base;
  ivec3 c = clampedInt(base, ivec3(-1), g.size.xyz);
  float z0 = mix(mix(cellDensity(g, c), cellDensity(g, c + ivec3(1, 0, 0)), f.x),
                 mix(cellDensity(g, c + ivec3(0, 1, 0)), cellDensity(g, c + ivec3(1, 1, 0)), f.x), f.y);
  float z1 = mix(mix(cellDensity(g, c + ivec3(0, 0, 1)), cellDensity(g, c + ivec3(1, 0, 1)), f.x),
                 mix(cellDensity(g, c + ivec3(0, 1, 1)), cellDensity(g, c + ivec3(1, 1, 1)), f.x), f.y);
  return mix(z0, z1, f.z);
}

float densityAt(DensityRecord g, vec3 p) {
  if (any(lessThan(p, vec3(0.0))) || any(greaterThan(p, vec3(g.size.xyz)))) return 0.0;
  return densityInside(g, p);
}

// The integral over t of the density from `near` to `far` along origin + t direction, in cells and inside the box.
// Exact but for rounding: between two planes through cell centres the density is a cubic in t, for which Simpson's rule
// is exact. The number of iterations is bounded by the number of planes crossed plus one.
float densityIntegral(DensityRecord g, vec3 origin, vec3 direction, float near, float far) {
  vec3 start = origin + near * direction, towards = mix(vec3(-1.0), vec3(1.0), greaterThanEqual(direction, vec3(0.0)));
  // the last plane passed
  vec3 plane = mix(ceil(start - 0.5), floor(start - 0.5), greaterThanEqual(direction, vec3(0.0))) + 0.5;
  float from = near, sum = 0.0, atFrom = densityInside(g, start);
  int most = g.size.x + g.size.y + g.size.z + 3;
  for (int i = 0; i < most && from < far; ++i) {  // ends: as many as a grid has planes
    ++loopIterations;
    float to = far;
    int axis = -1;
    for (int k = 0; k < 3; ++k) {
      if (abs(direction[k]) < 1e-20) continue;
      float t = (plane[k] + towards[k] - origin[k]) / direction[k];
      if (t < to) {
        to = t;
        axis = k;
      }
    }
    if (axis >= 0) plane[axis] += towards[axis];
    to = max(to, from);
    float atTo = densityInside(g, origin + to * direction);
    sum += (to - from) * (atFrom + 4.0 * densityInside(g, origin + 0.5 * (from + to) * direction) + atTo) / 6.0;
    from = to;
    atFrom = atTo;
  }
  return sum;
}

// Divides a ray into the segments within which one bound applies, front to back. Distances along the ray in scene
// units, positions in cells.
struct DensityMarch {
  vec3 origin, direction;  // in cells; cells per unit of distance
  float near, far;         // of the current segment
  float last;              // where the ray leaves the box, or ends
  ivec3 block;
};

// Segments of a ray, at most: it enters each layer of blocks once.
int densityMostBlocks(DensityRecord g) { return g.blocks.x + g.blocks.y + g.blocks.z; }

// False if the ray misses the box.
bool densityMarchStart(DensityRecord g, vec3 origin, vec3 direction, float tMax, out DensityMarch march) {
  march = DensityMarch((origin - g.min) * g.cellsPerUnit, vec3(0.0), 0.0, 0.0, 0.0, ivec3(0));
  march.direction = direction * g.cellsPerUnit;
  vec3 size = vec3(g.size.xyz);
  float near = 0.0, far = tMax;
  bool meets = true;
  for (int axis = 0; axis < 3; ++axis) {
    float o = march.origin[axis], d = march.direction[axis];
    if (abs(d) < 1e-20) {
      meets = meets && o >= 0.0 && o <= size[axis];
      continue;
    }
    float a = -o / d, b = (size[axis] - o) / d;
    near = max(near, min(a, b));
    far = min(far, max(a, b));
  }
  march.near = near;
  march.far = near;
  march.last = far;
  march.block =
      clampedInt(floor((march.origin + near * march.direction) / float(g.size.w)), ivec3(0), g.blocks.xyz - 1);
  return meets && near < far;
}

// The next segment [near, far] and its bound. False after the last one.
bool densityMarchNext(DensityRecord g, inout DensityMarch march, out float bound) {
  bound = 0.0;
  if (march.far >= march.last || any(lessThan(march.block, ivec3(0))) ||
      any(greaterThanEqual(march.block, g.blocks.xyz)))
    return false;
  bound = densities[g.firstBound + march.block.x + g.blocks.x * (march.block.y + g.blocks.y * march.block.z)];
  march.near = march.far;
  float edge = float(g.size.w), far = march.last;
  int leaving = -1;
  for (int axis = 0; axis < 3; ++axis) {
    float d = march.direction[axis];
    if (abs(d) < 1e-20) continue;
    float t = (edge * float(march.block[axis] + (d > 0.0 ? 1 : 0)) - march.origin[axis]) / d;
    if (t < far) {
      far = t;
      leaving = axis;
    }
  }
  march.far = max(far, march.near);
  if (leaving < 0) march.far = march.last;
  else march.block[leaving] += march.direction[leaving] > 0.0 ? 1 : -1;
  return true;
}
