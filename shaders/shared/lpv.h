// Layout of the light propagation volume's cascades: uniform block 1. Cascade 0 is the finest.
#pragma once
#include "shared/types.h"

SHARED_BEGIN

#define LPV_MAX_CASCADES 4
#define LPV_LOBES_ANGLES 64  // texels of the table of glossy lobes
#define LPV_LOBES_ALPHAS 32
#define LPV_GLOSSY_RAYS 8  // directions of a lobe

struct LpvCascade {
  vec3 minimum;        // world: minimum corner of cell (0,0,0); an exact multiple of cellSize
  float cellSize;      // world units
  vec3 blendCentre;    // world: the unsnapped centre, so that the blend moves smoothly with the camera
  float blendHalf;     // world: from the centre to where this cascade has faded out; huge for the coarsest
};

struct LpvConstants {
  LpvCascade cascades[LPV_MAX_CASCADES];
  ivec4 shape;  // x: cells per side, y: cascades, z: steps of glossy reflection, w unused
  float referenceIrradiance;  // E_ref: coefficients are stored as c / (E_ref cellSize^2)
  float blendBand;      // fraction of blendHalf over which a cascade fades into the next
  float lookupOffset;   // a receiver is moved by this many cells along its normal before the lookup
  float padding;
};

SHARED_END
