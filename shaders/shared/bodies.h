// Bodies with a medium inside, as previews see them: one record per material. Density grids are in storage blocks 0
// and 1 (shared/media.h). Lengths in scene units.
#pragma once
#include "shared/types.h"

SHARED_BEGIN

#define BODY_RECORDS_BUFFER 5

#define BODY_NONE 0     // no closed boundary
#define BODY_CLEAR 1    // a dielectric without a medium
#define BODY_MEDIUM 2   // a dielectric with a homogeneous medium
#define BODY_CLOUD 3    // a medium within a boundary that does not refract

// Isotropic scattering by similarity: scattering times 1 - g.
struct BodyRecord {
  vec3 extinction;   // 1/unit; of a cloud with a grid, where its density is 1
  float ior;
  vec3 albedo;       // scattering over extinction
  int kind;
  vec3 reflectance;  // light let out over light from all sides, both diffuse, without the way out's Fresnel factor
  int priority;
  int grid;          // index of its DensityRecord, -1: none
  int padding0, padding1, padding2;
};

SHARED_END
