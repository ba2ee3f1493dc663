// Where pixels name their patches (rays, item buffer): what each patch keeps of the delta form factors is summed, and
// patches that keep anything are listed, so that the passes after it cost what a hemicube sees, not what the scene has.
// Small sources stand at the list's beginning, whether a pixel sees them or not.
//
// Sums are of whole numbers, by atomics that do not depend on the order. A hemisphere is 2^31, so a sum fits and the
// smallest of 64 x 64 pixels, 2e-7, is off by 0.1 %.
#define KEPT_WHOLE 2147483648.0
layout(std430, binding = 4) buffer Kept { uint kept[]; };                // hemicube-major; all 0 between batches
// 1 where a patch is a small source; after all patches: which are
layout(std430, binding = 5) readonly buffer Sources { uint sources[]; };
// hemicube * patchCount + patch; then its form factor. Begins with an indirect dispatch
layout(std430, binding = 7) buffer KeptList { uint keptGroups, keptOne0, keptOne1, keptCount; uvec2 keptList[]; };

void keep(int hemicube, int patchIndex, float delta) {
  int entry = hemicube * patchCount + patchIndex;
  if (atomicAdd(kept[entry], max(uint(delta * KEPT_WHOLE + 0.5), 1u)) != 0u || sources[patchIndex] != 0u) return;
  uint slot = atomicAdd(keptCount, 1u);
  keptList[slot].x = uint(entry);
  if (slot % 64u == 0u) atomicMax(keptGroups, slot / 64u + 1u);
}
