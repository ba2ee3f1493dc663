// What the lookup filters: each receiver's irradiance at its cell and face, times how much it counts. A receiver counts
// more the more paths it has, so that new ones fade in among those that are there. While it has few it takes its
// neighbours' in, those of the same face whose surfaces lean the same way, weighted by their paths: noise gives way to
// a little blur, and both to what is right, since with all its paths it stands for itself.
layout(local_size_x = 64) in;
#include "lpv/receivers/common.glsl"
#include "lpv/receivers/work.glsl"
layout(std430, binding = 0) restrict buffer LpvReceivers { LpvReceiver receivers[]; };
layout(LPV_FORMAT, binding = 0) writeonly uniform image3D lpvReceived;
layout(binding = 0) uniform usamplerBuffer lpvSlots;
uniform float fullPaths;   // from which it counts fully, and alone
uniform uint enoughPaths;  // from which one that was first does not jump any more
// of what is shown in a frame, relative to the larger of what it was and shall be; 0: at once
uniform float mostChange;
const float kFadeIn = 1.0 / 16.0;  // a frame

// Nothing that is seen jumps: the irradiance that a receiver shows moves towards what its paths and its neighbours'
// say, and a new one comes in by and by. Where nothing was seen before it shows what the paths of its first frame have
// found.
void show(uint index, inout LpvReceiver receiver, vec3 target) {
  vec3 change = target - receiver.shown;
  float largest = max(max(abs(change.x), abs(change.y)), abs(change.z));
  float scale =
      max(max(max(receiver.shown.x, receiver.shown.y), receiver.shown.z), max(max(target.x, target.y), target.z));
  bool isFirst = (receiver.state & LPV_FIRST) != 0u;
  if (isFirst && receiver.paths >= enoughPaths) receivers[index].state = receiver.state & ~LPV_FIRST;
  bool arrives = mostChange == 0.0 || isFirst || largest <= mostChange * scale;
  receiver.shown = arrives ? target : receiver.shown + change * (mostChange * scale / largest);
  float presence = mostChange == 0.0 ? LPV_PRESENT : min(receiver.presence + kFadeIn, LPV_PRESENT);
  receiver.presence = arrives ? presence : min(presence, LPV_PRESENT - 0.5 * kFadeIn);
  receivers[index].shown = receiver.shown;
  receivers[index].presence = receiver.presence;
}

vec3 withNeighbours(LpvReceiver receiver) {
  float share = 1.0 - float(receiver.paths) / fullPaths;
  if (share <= 0.0) return receiver.irradiance;
  int cascade = receiver.cell.w / LPV_FACES;
  vec3 sum = float(receiver.paths) * receiver.irradiance;
  float weights = float(receiver.paths);
  for (int i = 0; i < 27; ++i) {
    ivec3 cell = receiver.cell.xyz + ivec3(i % 3, i / 3 % 3, i / 9) - 1,
          place = cell - receiving.firstCell[cascade].xyz;
    if (i == 13 || any(lessThan(place, ivec3(0))) || any(greaterThanEqual(place, ivec3(lpv.shape.x)))) continue;
    uint holds = texelFetch(lpvSlots, slotOf(cascade, receiver.cell.w % LPV_FACES, cell)).x;
    if (holds == 0u) continue;
    uint paths = receivers[holds - 1u].paths;
    float weight = share * float(paths) * smoothstep(0.5, 1.0, dot(receivers[holds - 1u].normal, receiver.normal));
    if (paths == 0u || !(weight > 0.0)) continue;
    sum += weight * receivers[holds - 1u].irradiance;
    weights += weight;
  }
  return sum / weights;
}

void main() {
  uint index = gl_GlobalInvocationID.x;
  if (index >= receiverCount()) return;
  LpvReceiver receiver = receivers[index];
  if (receiver.paths == 0u) return;
  int cascade = receiver.cell.w / LPV_FACES;
  ivec3 place = receiver.cell.xyz - receiving.firstCell[cascade].xyz;
  if (any(lessThan(place, ivec3(0))) || any(greaterThanEqual(place, ivec3(lpv.shape.x)))) return;
  // No less than a quarter: times 1/8, the least share of a point's own cell, that is still more than the lookup asks
  // for. Else what few paths have found would stay black.
  float counts = clamp(float(receiver.paths) / fullPaths, 0.25, 1.0);
  show(index, receiver, withNeighbours(receiver));
  imageStore(lpvReceived, ivec3(place.xy, receiver.cell.w * lpv.shape.x + place.z),
             receiver.presence * counts * vec4(receiver.shown / lpv.referenceIrradiance, 1.0));
}
