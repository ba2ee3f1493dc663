// Counters of a frame's gather, and the pixels that interpolation leaves to the full gather. Matches GatherCounts in
// rsm_gather.cpp.
#define WORK_GROUP 64
struct GatherWork {
  uint groupsX, groupsY, groupsZ;  // of the full gather, as arguments of an indirect dispatch
  uint refused;                    // pixels in the list
  uint surfaces;                   // pixels that show a surface
  uint lowSamples;                 // low-resolution samples on a surface
};
