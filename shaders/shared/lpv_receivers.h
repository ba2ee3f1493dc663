// Receivers of the light propagation volume (engine/lpv/receivers.hpp): surface points that store irradiance. Uniform
// block 6.
#pragma once
#include "shared/lpv.h"
#include "shared/types.h"

SHARED_BEGIN

#define LPV_FACES 6           // per cell: 2 * axis + (1 if the normal points down the axis)
#define LPV_UNPLACED 0xffffffffu  // a receiver's triangle before its pixel's ray was traced
#define LPV_NOWHERE 0xfffffffeu   // the ray met nothing
#define LPV_GATHERED 0xffffffu  // path count of a receiver whose light was gathered at once
#define LPV_LANES 64          // per work group, one path each
#define LPV_PART_GROUPS 1792  // work groups of a submission, at most (engine/lpv/light_gather.hpp)
#define LPV_PARTS 10          // of the list of receivers to be lit: 2^14 groups
#define LPV_MOST_OPENING 2048 // turns of a lane that may open nodes of a light tree
#define LPV_MOST_NEAR 12      // texels of a lane that give light by their outline
#define LPV_FULL_PATHS 256.0  // from here on: full weight, no averaging with neighbours
#define LPV_FRONT 1u
#define LPV_FIRST 2u
#define LPV_ALONE 4u  // of a point that keeps light of further bounces: it lights no other surface
#define LPV_BRIGHT 8u

struct LpvReceiver {
  ivec4 cell;           // cell of its cascade, counted from the origin; w: cascade * LPV_FACES + face
  uint triangle;        // index in the scene
  uint state;           // LPV_FRONT: seen from its front; LPV_FIRST: nothing was shown in its place before; LPV_BRIGHT:
                        // what was is much brighter than what a receiver beside it shows
  float second;         // weights of the second and third corner
  float third;
  vec3 irradiance;      // mean of all paths so far, W per square scene unit
  uint paths;
  vec3 position;        // among the frame's positions
  uint born;            // frame in which a pixel created it
  vec3 normal;          // for shading, unit, on the visible side
  uint pixel;           // the pixel that created it
  vec3 shown;           // irradiance used by lookups: follows `irradiance` and that of its neighbours at a bounded rate
  float presence;       // its weight in lookups: has faded in, and shows its target, where it is fullPresence()
};

struct LpvAroundPoint {
  vec3 position;        // among the frame's positions
  uint isThere;         // 0: the ray met nothing
  vec3 normal;          // for shading, unit, on the visible side
  uint padding;
};

struct LpvReceiverConstants {
  ivec4 firstCell[LPV_MAX_CASCADES];  // per cascade, counted from the origin
  vec3 rayOrigin;       // position of the ray caster's origin in the frame's coordinates
  uint frame;
  uint capacity;        // maximum number of receivers
  uint mostSegments;    // maximum per path
  uint markEvery;       // pixel stride, for pictures with more pixels than a key can tell apart
  uint around;          // points around the camera that need receivers too
};

SHARED_END
