// Receivers that are in no cell: one at the surface that each of these pixels shows. For measurements.
layout(local_size_x = 64) in;
#include "shared/bindings.h"
#include "shared/path_tracer.h"
layout(std140, binding = BLOCK_RECEIVER_PATHS) uniform PathBlock { PathConstants tracer; };
#include "rays/random.glsl"
#include "rays/bsdf.glsl"
#include "rays/materials.glsl"
#include "rays/bvh.glsl"
#include "lpv/receivers/common.glsl"
#include "lpv/receivers/work.glsl"
layout(std430, binding = 5) restrict buffer LpvWork { LpvReceiverWork work; };
#include "lpv/receivers/seen.glsl"
layout(std430, binding = 0) writeonly restrict buffer LpvReceivers { LpvReceiver receivers[]; };
layout(std430, binding = 1) writeonly restrict buffer LpvLit { uint lit[]; };
uniform uint first, pixels;
uniform int round;  // gives other random numbers

void main() {
  uint index = gl_GlobalInvocationID.x, pixel = first + index;
  if (index >= pixels) return;
  LpvReceiver receiver;
  receiver.cell = ivec4(pixel, round, 0, 0);
  receiver.triangle = LPV_NOWHERE;
  receiver.state = 0u;
  receiver.second = receiver.third = receiver.presence = 0.0;
  receiver.irradiance = receiver.shown = receiver.position = receiver.normal = vec3(0.0);
  receiver.paths = receiver.born = 0u;
  receiver.pixel = pixel;
  Hit hit;
  Surface surface;
  if (seenAt(int(pixel), hit, surface)) {
    receiver.triangle = hit.triangle;
    receiver.position = surface.position + receiving.rayOrigin;
    receiver.normal = surface.normal;
    receiver.second = hit.barycentrics.x;
    receiver.third = hit.barycentrics.y;
    receiver.state = surface.front ? LPV_FRONT : 0u;
    uint place = atomicAdd(work.waiting, 1u);
    uint group = place / uint(LPV_LANES / PATHS);
    atomicMax(work.litGroups[3u * (group / uint(LPV_PART_GROUPS))], group % uint(LPV_PART_GROUPS) + 1u);
    if (place < uint(lit.length())) lit[place] = index;
  }
  receivers[index] = receiver;
}
