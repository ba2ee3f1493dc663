// Participating media and the closed boundaries that contain them, as the path tracer reads them: storage buffers
// (std430).
#pragma once
#include "shared/types.h"

SHARED_BEGIN

// Lengths in scene units.
struct MediumRecord {
  vec3 extinction;   // 1/unit
  // with a density grid: multiplied by the density's bound, the rate of tentative collisions; > 0 unless the medium is
  // void
  float majorant;
  vec3 albedo;       // scattering over extinction; 0 if the extinction is 0
  int phase;         // 0 Henyey-Greenstein, 1 Rayleigh
  vec3 emission;     // radiance per unit
  int grid;          // index of its DensityRecord, -1: homogeneous
  vec3 oneMinusG;
  int greyExtinction;  // equal channels, and the rate: a free flight's weight is the albedo itself
  vec3 onePlusG;
  int greyPhase;       // likewise: the direction's weight is 1
  vec3 rate;         // 1/unit, at which collisions are drawn: the extinction, or what scatters where most is absorbed
  int splits;        // 1: camera paths follow both what passes it and what scatters in it
};

// A density grid: cell centres in `densities` starting at firstDensity, x fastest; bounds of blocks of cells in
// `bounds` starting at firstBound.
struct DensityRecord {
  vec3 min;          // of the box
  int firstDensity;
  vec3 cellsPerUnit;
  int firstBound;
  ivec4 size;        // cells; w: cells along a block's edge
  ivec4 blocks;      // blocks; w unused
};

// The interior of a closed boundary, indexed by its rank in the order of priorities.
struct InteriorRecord {
  float ior;        // of a dielectric; otherwise unused
  int medium;       // -1: vacuum
  int clearance;    // index of its clearance grid's first cell; -1: none
  float cell;       // edge of that grid's cells
  vec3 min;         // corner of its first cell
  int unused;
  ivec4 size;       // cells, x fastest; w unused
};

SHARED_END
