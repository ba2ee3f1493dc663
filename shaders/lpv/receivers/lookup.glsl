// Irradiance at a surface from the receivers around it. For each axis, interpolates trilinearly between the existing
// receivers whose surface leans the same way as the normal, weighted by the square of the normal's component. Alpha is
// how much a receiver counts, 0 in empty cells.
#include "shared/bindings.h"
#include "lpv/receivers/common.glsl"
#include "lpv/receivers/cascade_weight.glsl"
layout(binding = UNIT_RECEIVED) uniform sampler3D lpvReceived;  // faces of cascades stacked along z

// Position for a lookup in a cascade, in cells of one face.
vec3 receivedPlace(int k, vec3 position) {
  float cells = float(lpv.shape.x);
  vec3 texel = (position - lpv.cascades[k].minimum) / lpv.cascades[k].cellSize;
  texel.z = clamp(texel.z, 0.5, cells - 0.5);  // the next face's layers follow
  return texel;
}

// xyz: irradiance in receivedUnit(), times w; w: total weight of the receivers found.
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

// Enough of a cascade: the least that a point's own receiver contributes, 1/8 of its presence of at least 1/4. A weight
// below kLeast is only the filter's rounding: its colour would be noise.
const float kEnough = 1.0 / 32.0, kLeast = 1e-5;

// From the finest cascade to the coarsest, each blended into the next near its reach and where it has few receivers.
// found: false if no cascade has any receiver.
vec3 receivedIrradiance(vec3 position, vec3 normal, out bool found) {
  vec3 irradiance = vec3(0.0);
  float left = 1.0, sum = 0.0;
  for (int k = 0; k < lpv.shape.y && left > 0.0; ++k) {
    float weight = left * receivedCascadeWeight(k, position);
    if (!(weight > 0.0)) continue;
    vec4 here = receivedInCascade(k, position, normal);
    if (!(here.w > kLeast)) continue;
    weight *= min(here.w / kEnough, 1.0);
    irradiance += weight * here.rgb / here.w;
    sum += weight;  // not 1 - left, which would cancel for a small weight
    left -= weight;
  }
  found = sum > 0.0;
  return found ? irradiance * (receivedUnit() / sum) : vec3(0.0);
}
