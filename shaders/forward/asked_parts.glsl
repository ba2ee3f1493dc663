// The block into which a technique's lookup writes its parts, for the pixel that is asked for: one invocation. The
// first entry's number.x says how many there were; beyond the block's room they are counted, not kept.
#include "shared/asked.h"
layout(std430, binding = ASKED_PARTS_BINDING) writeonly buffer AskedParts { AskedPart parts[]; };
int partsTold = 0;

void tellPart(AskedPart part) {
  ++partsTold;
  if (partsTold < parts.length()) parts[partsTold] = part;
}
void endParts() { parts[0].number = ivec4(partsTold, 0, 0, 0); }
