// For methods whose pixels name their patches (rays, item buffer): sums each patch's visible delta form factors and
// lists the visible patches, so that later passes cost what a hemicube sees, not the size of the scene. Small sources
// come first in the list, visible or not.
//
// Sums are integer atomics, so they do not depend on the order. A hemisphere is 2^31: a sum fits, and the smallest
// delta form factor at 64 x 64 pixels, 2e-7, is off by 0.1 %.
#define KEPT_WHOLE 2147483648.0
layout(std430, binding = 4) buffer Kept { uint kept[]; };                // hemicube-major; all 0 between batches
// 1 if a patch is a small source; after these flags, the list of small sources
layout(std430, binding = 5) readonly buffer Sources { uint sources[]; };
// hemicube * patchCount + patch, then its form factor. Begins with an indirect dispatch
layout(std430, binding = 7) buffer KeptList { uint keptGroups, keptOne0, keptOne1, keptCount; uvec2 keptList[]; };

void keep(int hemicube, int patchIndex, float delta) {
  if (uint(patchIndex) >= uint(patchCount)) return;
  int entry = hemicube * patchCount + patchIndex;
  uint share = uint(delta * KEPT_WHOLE + 0.5);  // bounded: all delta form factors add up to 1
  if (atomicAdd(kept[entry], max(share, 1u)) != 0u || sources[patchIndex] != 0u) return;
  uint slot = atomicAdd(keptCount, 1u);
  if (slot >= uint(keptList.length())) return;
  keptList[slot].x = uint(entry);
  if (slot % 64u == 0u) atomicMax(keptGroups, slot / 64u + 1u);
}
