// Counts of records and the indirect dispatches over them: CACHE_LANES records per group, and one path per lane for
// those to be lit, which come in parts of CACHE_PART_GROUPS groups.
struct CacheWork {
  uint allGroupsX, allGroupsY, allGroupsZ;
  uint wanted;   // records, including those that did not fit into the capacity
  uint waiting;  // records that still lack paths; those beyond the dispatch wait for the next one
  uint frame;
  uint litGroups[3 * CACHE_PARTS];
  uint traced;  // paths to be traced again in the last frame in which the scene moved
  uint tiles;   // of parts of split cells
  uint parts;   // records that belong to one
  uint claimGroups[3];
  uint claiming;  // pixels that have found an empty slot
};

// The weight in lookups of a record that has faded in. At least a quarter: times 1/8, the least share of a point's
// own cell, that is enough of a cascade for the lookup (kEnough). Otherwise coarser records would replace those with
// few paths.
float fullBlendWeight(uint paths) { return clamp(float(paths) / CACHE_FULL_PATHS, 0.25, 1.0); }

uint recordCount(uint wanted) { return min(wanted, cache.capacity); }
