// Receivers of the light propagation volume (engine/lpv/receivers.hpp): points of surfaces at which irradiance is kept.
// Uniform block 6.
#pragma once
#include "shared/lpv.h"
#include "shared/types.h"

SHARED_BEGIN

#define LPV_FACES 6           // of a cell: 2 * axis + (1 where the normal points down the axis)
#define LPV_UNPLACED 0xffffffffu  // a receiver's triangle before the ray of its pixel was traced
#define LPV_NOWHERE 0xfffffffeu   // where that ray met nothing
#define LPV_GATHERED 0xffffffu  // paths of a receiver whose light was gathered at once
#define LPV_LANES 64          // of a work group, a path each
#define LPV_PRESENT 1.0
#define LPV_FRONT 1u
#define LPV_FIRST 2u

struct LpvReceiver {
  ivec4 cell;           // which cell of its cascade, counted from the origin; w: cascade * LPV_FACES + face
  uint triangle;        // of the scene; its place there, and whether it is seen from its front
  uint state;           // LPV_FRONT: it is seen from its front; LPV_FIRST: nothing was seen in its place before
  float second;         // weights of the second and third corner
  float third;
  vec3 irradiance;      // mean of all paths so far, W per square scene unit
  uint paths;
  vec3 position;        // among the frame's positions
  uint born;            // frame in which a pixel found it
  vec3 normal;          // for shading, unit, on the side that is seen
  uint pixel;           // that found it
  vec3 shown;           // irradiance that is looked up: follows `irradiance`, and its neighbours', at a bounded rate
  // how much of it is faded in, 0 to LPV_PRESENT; LPV_PRESENT alone says that `shown` has arrived too
  float presence;
};

struct LpvReceiverConstants {
  ivec4 firstCell[LPV_MAX_CASCADES];  // each cascade's, counted from the origin
  vec3 rayOrigin;       // where the ray caster's origin lies among the frame's positions
  uint frame;
  uint capacity;        // receivers at most
  uint mostSegments;    // of a path
  uint markEvery;       // pixels: of pictures with more pixels than a key can tell apart
  uint padding;
};

SHARED_END
