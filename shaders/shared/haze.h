// A homogeneous medium in a box, for light shafts: uniform block 2.
#pragma once
#include "shared/types.h"

SHARED_BEGIN

struct HazeConstants {
  vec3 low;           // its box, world
  float isRayleigh;   // 1: Rayleigh's phase function; 0: that of Henyey and Greenstein
  vec3 high;
  float padding0;
  vec3 scattering;    // sigma_s, 1 / world unit
  float padding1;
  vec3 extinction;    // sigma_s + sigma_a
  float padding2;
  vec3 anisotropy;    // g, mean cosine; 0 for Rayleigh
  float padding3;
};
SHARED_BLOCK(HazeConstants)

SHARED_END
