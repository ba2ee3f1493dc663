// Marks the slots that the camera needs. Each pixel names those of its cell, in every cascade that contributes there,
// for each axis that its normal leans to. The points around the camera do so too, in the coarsest cascades; they come
// after the picture's pixels. Slots with a receiver keep it. An empty slot goes to the pixel nearest to its
// cell's centre and most aligned with its axis: an actual point, because the mean of several would lie buried in edges
// and corners.
// First pass: the best key of each empty slot. Second pass, CLAIM: the winner creates the receiver.
layout(local_size_x = 8, local_size_y = 8) in;
#include "lib/clamped_int.glsl"
#include "lpv/receivers/common.glsl"
#include "lpv/receivers/work.glsl"
layout(std430, binding = 5) restrict buffer LpvWork { LpvReceiverWork work; };
#include "lpv/receivers/cascade_weight.glsl"
#include "forward/visible.glsl"
layout(binding = 7) uniform usamplerBuffer lpvSlots;  // 0: empty, else the receiver's index + 1
#if CLAIM
layout(binding = 1) uniform usamplerBuffer lpvKeys;
layout(std430, binding = 0) writeonly restrict buffer LpvReceivers { LpvReceiver receivers[]; };
// aliased LpvSlots: only the winner of an empty slot changes it; all others skip the slot with either value
layout(std430, binding = 1) writeonly restrict buffer LpvSlots { uint slots[]; };
#else
layout(std430, binding = 0) writeonly restrict buffer LpvSeen { uint seen[]; };
layout(std430, binding = 1) restrict buffer LpvKeys { uint keys[]; };
#endif
layout(std430, binding = 2) readonly restrict buffer LpvAround { LpvAroundPoint around[]; };

const float kLeans = 0.02;  // squared component of the normal from which the slot is filled
const int kCascadesAround = 2;

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy), size = textureSize(visibleDepth, 0);
  if (pixel.x >= size.x) return;
  int number = pixel.y * size.x + pixel.x, beyond = number - size.x * size.y;
  bool isAround = beyond >= 0;
  vec3 position, normal;
  uint name;  // in a key
  if (isAround) {
    if (beyond >= int(receiving.around) || around[beyond].isThere == 0u) return;
    position = around[beyond].position;
    normal = around[beyond].normal;
    name = uint(number - beyond - 1) / receiving.markEvery + 1u + uint(beyond);
  } else {
    if (uint(number) % receiving.markEvery != 0u || !isVisibleSurface(pixel)) return;
    position = visiblePosition(pixel);
    normal = visibleUnitNormal(pixel);
    name = uint(number) / receiving.markEvery;
  }
  float left = 1.0;
  for (int k = isAround ? max(lpv.shape.y - kCascadesAround, 0) : 0; k < lpv.shape.y && left > 0.0; ++k) {
    float weight = left * receivedCascadeWeight(k, position);
    if (!(weight > 0.0)) continue;
    if (!isAround) left -= weight;
    vec3 inCells = (position - lpv.cascades[k].minimum) / lpv.cascades[k].cellSize;
    ivec3 cell = clampedInt(floor(inCells), ivec3(-1), ivec3(lpv.shape.x));
    if (any(lessThan(cell, ivec3(0))) || any(greaterThanEqual(cell, ivec3(lpv.shape.x)))) continue;
    float offCentre = length(inCells - vec3(cell) - 0.5);
    cell += receiving.firstCell[k].xyz;
    for (int axis = 0; axis < 3; ++axis) {
      float lean = normal[axis] * normal[axis];
      if (lean < kLeans) continue;
      int face = faceOf(axis, normal[axis]);
      int slot = slotOf(k, face, cell);
      uint holds = texelFetch(lpvSlots, slot).x;
      uint score = uint(clampedInt((offCentre + 0.5 * (1.0 - lean)) * (511.0 / 1.5), 0, 511));
      uint key = score << 23u | name;
#if CLAIM
      if (holds != 0u || texelFetch(lpvKeys, slot).x != key) continue;
      uint index = atomicAdd(work.wanted, 1u);
      if (index >= receiving.capacity) continue;
      atomicMax(work.allGroupsX, index / uint(LPV_LANES) + 1u);
      receivers[index] = LpvReceiver(ivec4(cell, k * LPV_FACES + face), LPV_UNPLACED, 0u, 0.0, 0.0, vec3(0.0), 0u,
                                     position, receiving.frame, normal, uint(number), vec3(0.0), 0.0);
      slots[slot] = index + 1u;
#else
      if (holds == 0u)
        atomicMin(keys[slot], key);
      else if (!isAround && holds <= uint(seen.length()))
        seen[holds - 1u] = receiving.frame;
#endif
    }
  }
}
