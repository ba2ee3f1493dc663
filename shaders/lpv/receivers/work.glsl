// Counts of receivers and the indirect dispatches over them: LPV_LANES receivers per group, and one path per lane for
// those to be lit.
layout(std430, binding = 5) restrict buffer LpvReceiverWork {
  uint allGroupsX, allGroupsY, allGroupsZ;
  uint wanted;   // receivers, including those that did not fit into the capacity
  uint litGroupsX, litGroupsY, litGroupsZ;
  uint waiting;  // receivers that still lack paths; those beyond the dispatch wait for the next one
  uint frame;
} work;

uint receiverCount() { return min(work.wanted, receiving.capacity); }
