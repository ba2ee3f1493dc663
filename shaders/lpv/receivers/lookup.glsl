// Irradiance at a surface from the receivers around it: for each axis the receivers whose surface leans the way of the
// normal, trilinear among those that there are, weighted by the square of the normal's component. Alpha is how much a
// receiver counts, 0 in empty cells.
#include "shared/bindings.h"
#include "lpv/receivers/common.glsl"
#include "lpv/cascade_weight.glsl"
layout(binding = UNIT_RECEIVED) uniform sampler3D lpvReceived;  // faces of cascades stacked along z

// Where a cascade is looked up, in cells of one face.
vec3 receivedPlace(int k, vec3 position) {
  float cells = float(lpv.shape.x);
  vec3 texel = (position - lpv.cascades[k].minimum) / lpv.cascades[k].cellSize;
  texel.z = clamp(texel.z, 0.5, cells - 0.5);  // the next face's layers follow
  return texel;
}

// xyz: irradiance over E_ref, times w; w: how much there is to interpolate from.
vec4 receivedInCascade(int k, vec3 position, vec3 normal) {
  float cells = float(lpv.shape.x);
  vec3 uvw = receivedPlace(k, position) / vec3(cells, cells, cells * float(lpv.shape.y * LPV_FACES));
  vec4 sum = vec4(0.0);
  for (int axis = 0; axis < 3; ++axis) {
    float layer = float(k * LPV_FACES + faceOf(axis, normal[axis])) / float(lpv.shape.y * LPV_FACES);
    sum += normal[axis] * normal[axis] * textureLod(lpvReceived, uvw + vec3(0.0, 0.0, layer), 0.0);
  }
  return sum;
}

const float kEnough = 1.0 / 32.0, kLeast = 1e-5;

// From the finest cascade to the coarsest, each blended into the next near its border, and where it has little to
// interpolate from: what a point's own receiver weighs at least when it is new, 1/8 of 1/4, or more is enough. Less
// than kLeast is no more than the filter's rounding: its colour would be noise.
// found: false where none has anything.
vec3 receivedIrradiance(vec3 position, vec3 normal, out bool found) {
  vec3 irradiance = vec3(0.0);
  float left = 1.0, sum = 0.0;
  for (int k = 0; k < lpv.shape.y && left > 0.0; ++k) {
    float weight = left * lpvCascadeWeight(k, position);
    if (!(weight > 0.0)) continue;
    vec4 here = receivedInCascade(k, position, normal);
    if (!(here.w > kLeast)) continue;
    weight *= min(here.w / kEnough, 1.0);
    irradiance += weight * here.rgb / here.w;
    sum += weight;  // not 1 - left, which loses a small weight's digits
    left -= weight;
  }
  found = sum > 0.0;
  return found ? irradiance * (lpv.referenceIrradiance / sum) : vec3(0.0);
}
