// Nested grids around the camera: uniform block 1. Cascade 0 is the finest.
#pragma once
#include "shared/types.h"

SHARED_BEGIN

#define MAX_CASCADES 4

struct CascadeGrid {
  vec3 minimum;        // world: minimum corner of cell (0,0,0); an exact multiple of cellSize
  float cellSize;      // world units
  vec3 blendCentre;    // world: the unsnapped centre, so that the blend moves smoothly with the camera
  float blendHalf;     // world: from the centre to where this cascade has faded out; huge for the coarsest
};

struct CascadeConstants {
  CascadeGrid cascades[MAX_CASCADES];
  ivec4 shape;  // x: cells per side, y: cascades, z: steps of glossy reflection, w unused
  float referenceIrradiance;  // E_ref, of the order of the irradiance: only scales stored values
  float blendBand;      // fraction of blendHalf over which a cascade fades into the next
  float lookupOffset;   // a surface point is moved by this many cells along its normal before the lookup
  float padding;
};
SHARED_BLOCK(CascadeConstants)

SHARED_END
