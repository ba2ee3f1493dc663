// Runs after the cascades have moved: keeps the receivers whose cell is still inside, and registers their slots again.
layout(local_size_x = 64) in;
#include "lpv/receivers/common.glsl"
#include "lpv/receivers/work.glsl"
layout(std430, binding = 5) restrict buffer LpvWork { LpvReceiverWork work; };
layout(std430, binding = 0) readonly restrict buffer LpvReceivers { LpvReceiver before[]; };
layout(std430, binding = 1) writeonly restrict buffer LpvSlots { uint slots[]; };
layout(std430, binding = 2) writeonly restrict buffer LpvKept { LpvReceiver receivers[]; };
layout(std430, binding = 3) readonly restrict buffer LpvWorkBefore { uint workBefore[]; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= min(workBefore[3], receiving.capacity)) return;
  LpvReceiver r = before[i];
  int cascade = r.cell.w / LPV_FACES;
  ivec3 place = r.cell.xyz - receiving.firstCell[cascade].xyz;
  if (r.triangle == LPV_NOWHERE || any(lessThan(place, ivec3(0))) || any(greaterThanEqual(place, ivec3(lpv.shape.x))))
    return;
  uint index = atomicAdd(work.wanted, 1u);
  atomicMax(work.allGroupsX, index / uint(LPV_LANES) + 1u);
  receivers[index] = r;
  slots[slotOf(cascade, r.cell.w % LPV_FACES, r.cell.xyz)] = index + 1u;
}
