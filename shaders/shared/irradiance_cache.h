// Records of the irradiance cache (engine/irradiance_cache/irradiance_cache.hpp): surface points that store irradiance.
// Uniform block 6.
#pragma once
#include "shared/cascades.h"
#include "shared/types.h"

SHARED_BEGIN

// Storage blocks
#define CACHE_RECORDS_BUFFER 0
#define CACHE_FOUND_BUFFER 0  // points around the camera, when rays find them
#define CACHE_SEEN_BUFFER 0
#define CACHE_NODES_BUFFER 0
#define CACHE_LIST_BUFFER 1
#define CACHE_SLOTS_BUFFER 1
#define CACHE_KEYS_BUFFER 1
#define CACHE_KEPT_BUFFER 2
#define CACHE_PREFETCH_BUFFER 2
#define CACHE_WORK_BEFORE_BUFFER 3
#define CACHE_CLAIMING_BUFFER 3
#define CACHE_MOVED_BUFFER 4
#define CACHE_WORK_BUFFER 5
#define CACHE_LINKS_BUFFER 6
#define CACHE_BOUNCED_BUFFER 7
#define CACHE_HITS_BUFFER 6
#define CACHE_HITS_BEFORE_BUFFER 7
#define CACHE_SLOTS_OF_PATHS_BUFFER 7
#define CACHE_TILES_BUFFER 6
#define CACHE_PARTS_BUFFER 6

// Texture units; where rays are traced, 0 has the materials
#define UNIT_CACHE_KEYS 1
#define UNIT_CACHE_SEEN 6
#define UNIT_CACHE_SLOTS 7
#define UNIT_CACHE_TREE 7
#define UNIT_CACHE_BOUNCE_SLOTS 8
#define UNIT_CACHE_BOUNCED 9
#define UNIT_CACHE_MAP 10  // and the next two: with rays, the texture atlas has the usual ones
#define UNIT_CACHE_BOUNCE_PLACES 13
#define UNIT_CACHE_LIGHT 8
#define UNIT_CACHE_MOVED 9
#define UNIT_CACHE_TILES 9
#define UNIT_CACHE_PARTS 6
#define UNIT_CACHE_PART_SLOTS 10

#define CACHE_FACES 6           // per cell: 2 * axis + (1 if the normal points down the axis)
#define CACHE_UNPLACED 0xffffffffu  // a record's triangle before its pixel's ray was traced
#define CACHE_NOWHERE 0xfffffffeu   // the ray met nothing
#define CACHE_GATHERED 0xffffffu  // path count of a record whose light was gathered at once
#define CACHE_LANES 64          // per work group, one path each
#define CACHE_PART_GROUPS 1792  // work groups of a submission, at most (engine/irradiance_cache/light_gather.hpp)
#define CACHE_PARTS 10          // of the list of records to be lit: 2^14 groups
#define CACHE_MOST_OPENING 2048 // iterations of a lane that may open nodes of a light tree
#define CACHE_MOST_NEAR 12      // texels of a lane that give light by their outline
#define CACHE_MOST_SMALL_LAMPS 64  // connected emissive surfaces
#define CACHE_CELLS_NEAR_LAMP 4.0
#define CACHE_FULL_PATHS 256.0  // from here on: full weight, no averaging with neighbours
#define CACHE_FRONT 1u
#define CACHE_FIRST 2u
#define CACHE_ALONE 4u  // of a point that keeps light of further bounces: it lights no other surface
#define CACHE_BRIGHT 8u
#define CACHE_KEPT 16u   // what its paths hit is kept: CacheHit
#define CACHE_NARROW 32u  // another surface is much nearer than its cell is wide
#define CACHE_CLOSE 64u   // others are nearer than its cell is wide: the cell is split in finished pictures

// What a path has hit
#define CACHE_HITS 64        // paths of a record whose hits are kept
#define CACHE_KEEPING 16384  // records that keep their hits, at most
#define CACHE_MOST_LAMPS 16  // sun and lamps
#define CACHE_FAR 0x40000000u    // in CacheHit::slot: its light goes further than to a record; traced in each frame
#define CACHE_STALE 0x80000000u  // to be traced anew, when the budget allows
#define CACHE_SLOT_MASK 0x3fffffffu
#define CACHE_CLAIMED 0xffffffffu  // in a slot, until its record's number is known
#define CACHE_HOLE 0xffffffffu   // in the list of paths to be traced

struct CacheRecord {
  ivec4 cell;           // cell of its cascade, counted from the origin; w: cascade * CACHE_FACES + face. Part of a
                        // split cell: counted in parts; w: (cascade + cascades) * CACHE_FACES + face
  uint triangle;        // index in the scene
  uint state;           // CACHE_FRONT: seen from its front; CACHE_FIRST: nothing was shown in its place before;
                        // CACHE_BRIGHT: what was is much brighter than what a record beside it shows
  float second;         // weights of the second and third corner
  float third;
  vec3 irradiance;      // mean of all paths so far, W per square scene unit
  uint paths;
  vec3 position;        // among the frame's positions
  uint born;            // frame in which a pixel created it
  vec3 normal;          // for shading, unit, on the visible side
  uint pixel;           // the pixel that created it
  vec3 shown;           // irradiance used by lookups: follows `irradiance` and that of its neighbours at a bounded rate
  float blendWeight;       // its weight in lookups: has faded in, and shows its target, where it is fullBlendWeight()
  float squares;        // sum of squared differences between its rounds of paths and their mean, in cacheUnit()
  float padding0, padding1, padding2;
};

// A path of a record in a scene that moves, as far as it is kept. Colours: packColour.
struct CacheHit {
  uint slot;            // 1 + that of the record that stands for the surface it hits, or 0: none
  uint reflectance;     // of that surface
  uint light;           // all other light of this path: radiance, over cacheUnit()
  float t;              // distance of the hit
};

struct PrefetchPoint {
  vec3 position;        // among the frame's positions
  uint isThere;         // 0: the ray met nothing
  vec3 normal;          // for shading, unit, on the visible side
  uint padding;
};

// Where surfaces are, or were before they moved: among the frame's positions.
struct MovedBox {
  vec3 least;
  float padding0;
  vec3 most;
  float padding1;
};

struct CacheConstants {
  ivec4 firstCell[MAX_CASCADES];  // per cascade, counted from the origin
  vec3 rayOrigin;       // position of the ray caster's origin in the frame's coordinates
  uint frame;
  uint capacity;        // maximum number of records
  uint mostSegments;    // maximum per path
  uint markEvery;       // pixel stride, for pictures with more pixels than a key can tell apart
  uint prefetch;        // points around the camera that need records too
  uint smallLamps;      // how many of these there are
  uint padding0;
  uint padding1;
  uint padding2;
  vec4 smallLamp[CACHE_MOST_SMALL_LAMPS];  // balls around them, in the ray caster's coordinates; w: radius
};
SHARED_BLOCK(CacheConstants)

SHARED_END
