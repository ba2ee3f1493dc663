// Counts of receivers and the indirect dispatches over them: LPV_LANES receivers per group, and one path per lane for
// those to be lit, which come in parts of LPV_PART_GROUPS groups.
struct LpvReceiverWork {
  uint allGroupsX, allGroupsY, allGroupsZ;
  uint wanted;   // receivers, including those that did not fit into the capacity
  uint waiting;  // receivers that still lack paths; those beyond the dispatch wait for the next one
  uint frame;
  uint litGroups[3 * LPV_PARTS];
};

// The weight in lookups of a receiver that has faded in. At least a quarter: times 1/8, the least share of a point's
// own cell, that is enough of a cascade for the lookup (kEnough). Otherwise coarser receivers would replace those with
// few paths.
float fullPresence(uint paths) { return clamp(float(paths) / LPV_FULL_PATHS, 0.25, 1.0); }

uint receiverCount(uint wanted) { return min(wanted, receiving.capacity); }
