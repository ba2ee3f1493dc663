// Triangles that span more than kMostPixels of a face, listed for a pass with a work group each.
// slots of form factors (hemicube_sum.comp); begins with an indirect dispatch
#if LARGE
layout(std430, binding = 3) readonly buffer LargeList { uint largeGroups, one0, one1, largeCount; uint large[]; };
#else
layout(std430, binding = 3) buffer LargeList { uint largeGroups, one0, one1, largeCount; uint large[]; };
const uint kMostGroups = 65535u;

void listLarge(int place) {
  uint slot = atomicAdd(largeCount, 1u);
  if (slot < uint(large.length())) large[slot] = uint(place);
  atomicMax(largeGroups, min(slot + 1u, kMostGroups));
}
#endif
