// What the lookup filters: each receiver's irradiance at its cell and face, times how much it counts. A receiver counts more the more paths it has, so that new
// ones fade in among those that are there.
layout(local_size_x = 64) in;
#include "lpv/receivers/common.glsl"
#include "lpv/receivers/work.glsl"
layout(std430, binding = 0) readonly restrict buffer LpvReceivers { LpvReceiver receivers[]; };
layout(LPV_FORMAT, binding = 0) writeonly uniform image3D lpvReceived;
uniform float fullPaths;  // from which it counts fully

void main() {
  uint index = gl_GlobalInvocationID.x;
  if (index >= receiverCount()) return;
  LpvReceiver receiver = receivers[index];
  if (receiver.paths == 0u) return;
  int cascade = receiver.cell.w / LPV_FACES;
  ivec3 place = receiver.cell.xyz - receiving.firstCell[cascade].xyz;
  if (any(lessThan(place, ivec3(0))) || any(greaterThanEqual(place, ivec3(lpv.shape.x)))) return;
  // No less than a quarter: times 1/8, the least share of a point's own cell, that is still more than the lookup asks for. Else what few paths have found would stay black.
  float counts = clamp(float(receiver.paths) / fullPaths, 0.25, 1.0);
  imageStore(lpvReceived, ivec3(place.xy, receiver.cell.w * lpv.shape.x + place.z), counts * vec4(receiver.irradiance / lpv.referenceIrradiance, 1.0));
}
