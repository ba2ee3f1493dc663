// How many receivers there are, and dispatches over them: LPV_LANES receivers a group, and of those to be lit a path a
// lane.
layout(std430, binding = 5) restrict buffer LpvReceiverWork {
  uint allGroupsX, allGroupsY, allGroupsZ;
  uint wanted;   // receivers; those beyond the capacity found no room
  uint litGroupsX, litGroupsY, litGroupsZ;
  uint waiting;  // receivers that have not all their paths yet; those beyond the dispatch wait for the next
  uint frame;
} work;

uint receiverCount() { return min(work.wanted, receiving.capacity); }
