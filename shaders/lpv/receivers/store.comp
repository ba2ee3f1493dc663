// Writes the texture that the lookup filters: each receiver's irradiance at its cell and face, times its weight. The
// weight grows to what its number of paths is worth, slowly, so that new receivers fade in among others. A receiver
// with few paths is averaged with its neighbours (same face, surfaces that lean the same way), weighted by their paths.
// This trades noise for a little blur, and both vanish once the receiver has all its paths and stands for itself.
layout(local_size_x = 64) in;
#include "lpv/receivers/common.glsl"
#include "lpv/receivers/work.glsl"
layout(std430, binding = 5) readonly restrict buffer LpvWork { LpvReceiverWork work; };
layout(std430, binding = 0) restrict buffer LpvReceivers { LpvReceiver receivers[]; };
layout(LPV_FORMAT, binding = 0) writeonly uniform image3D lpvReceived;
#include "lpv/receivers/neighbours.glsl"
uniform uint enoughPaths;  // an LPV_FIRST receiver follows its estimate without limit until it has this many
// largest change per frame of the shown irradiance, relative to what it is or a quarter of its target; 0: no limit
uniform float mostChange;
// A new receiver's weight grows per frame by kGrowth of what it is and of what those beside it may have at least. What
// it takes away from a much brighter one then darkens a surface by at most kGrowth per frame. It takes 522 frames. One
// that is itself much brighter than one beside it (LPV_BRIGHT) starts with less, since what it adds is many times that.
const float kGrowth = 0.008, kBeside = 1.0 / 64.0, kBesideDark = 1.0 / 128.0, kNearly = 127.0 / 128.0;

// Avoids visible jumps: the irradiance that a receiver shows moves gradually towards the estimate from its own and its
// neighbours' paths, and a new receiver fades in. Where nothing was shown before, it starts with the estimate of its
// first frame.
void show(uint index, inout LpvReceiver receiver, vec3 target) {
  vec3 change = target - receiver.shown;
  float largest = max(max(abs(change.x), abs(change.y)), abs(change.z));
  float scale = max(max(max(receiver.shown.x, receiver.shown.y), receiver.shown.z),
                    0.25 * max(max(target.x, target.y), target.z));
  scale = max(scale, 1e-3 * receivedUnit());  // otherwise it never reaches black
  bool isFirst = (receiver.state & LPV_FIRST) != 0u;
  if (isFirst && receiver.paths >= enoughPaths) receivers[index].state = receiver.state & ~LPV_FIRST;
  bool arrives = mostChange == 0.0 || isFirst || largest <= mostChange * scale;
  receiver.shown = arrives ? target : receiver.shown + change * (mostChange * scale / largest);
  float beside = (receiver.state & LPV_BRIGHT) != 0u ? kBesideDark : kBeside;
  float grown = receiver.presence + kGrowth * (receiver.presence + beside);
  float full = fullPresence(receiver.paths);
  receiver.presence = min(mostChange == 0.0 ? full : grown, arrives ? full : kNearly * full);
  receivers[index].shown = receiver.shown;
  receivers[index].presence = receiver.presence;
}

vec3 withNeighbours(LpvReceiver receiver) {
  float share = 1.0 - float(receiver.paths) / LPV_FULL_PATHS;
  if (share <= 0.0) return receiver.irradiance;
  vec3 sum = float(receiver.paths) * receiver.irradiance;
  float weights = float(receiver.paths);
  for (int i = 0; i < kNeighbours; ++i) {
    uint other;
    if (!neighbourAt(receiver.cell, i, other)) continue;
    uint paths = receivers[other].paths;
    float weight = share * float(paths) * smoothstep(0.5, 1.0, dot(receivers[other].normal, receiver.normal));
    if (paths == 0u || !(weight > 0.0)) continue;
    sum += weight * receivers[other].irradiance;
    weights += weight;
  }
  return sum / weights;
}

void main() {
  uint index = gl_GlobalInvocationID.x;
  if (index >= receiverCount(work.wanted)) return;
  LpvReceiver receiver = receivers[index];
  if (receiver.paths == 0u) return;
  int cascade = receiver.cell.w / LPV_FACES;
  ivec3 place = receiver.cell.xyz - receiving.firstCell[cascade].xyz;
  if (any(lessThan(place, ivec3(0))) || any(greaterThanEqual(place, ivec3(lpv.shape.x)))) return;
  show(index, receiver, withNeighbours(receiver));
  imageStore(lpvReceived, ivec3(place.xy, receiver.cell.w * lpv.shape.x + place.z),
             receiver.presence * vec4(receiver.shown / receivedUnit(), 1.0));
}
