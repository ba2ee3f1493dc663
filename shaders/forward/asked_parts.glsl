// The block to which a technique's lookup writes its contributions for the queried pixel. One invocation. number.x of
// the first entry counts them all, including those that did not fit and were dropped.
#include "shared/asked.h"
layout(std430, binding = ASKED_PARTS_BINDING) writeonly buffer AskedParts { AskedPart parts[]; };
int partsTold = 0;

void tellPart(AskedPart part) {
  ++partsTold;
  if (partsTold < parts.length()) parts[partsTold] = part;
}
void endParts() { parts[0].number = ivec4(partsTold, 0, 0, 0); }
