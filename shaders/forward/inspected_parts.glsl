// The block to which a technique's lookup writes its contributions for the inspected pixel. One invocation. number.x of
// the first entry counts them all, including those that did not fit and were dropped.
#include "shared/inspected.h"
layout(std430, binding = INSPECTED_PARTS_BINDING) writeonly buffer InspectedParts { InspectedPart parts[]; };
int partsTold = 0;

void tellPart(InspectedPart part) {
  ++partsTold;
  if (partsTold < parts.length()) parts[partsTold] = part;
}
void endParts() { parts[0].number = ivec4(partsTold, 0, 0, 0); }
