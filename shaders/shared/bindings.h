// Bindings shared by programs of more than one folder: uniform blocks and texture units. Storage blocks, and units of a
// single program, are listed with that program. OpenGL 4.3 guarantees 36 uniform blocks and 80 units for all stages
// together, and 16 units per stage.
#pragma once

// Uniform blocks
#define BLOCK_FRAME 0
#define BLOCK_CASCADES 1
#define BLOCK_HAZE 2
#define BLOCK_LIGHTS 3
#define BLOCK_SUN_CASCADES 4
#define BLOCK_CACHE_PATHS 5
#define BLOCK_CACHE 6

// Texture units of shading
#define UNIT_DIFFUSE 0
#define UNIT_MASK 1
#define UNIT_SUN_SHADOW 2
#define UNIT_VISIBLE_LIGHTS 15  // by rays
#define UNIT_LPV_RED 4
#define UNIT_LPV_GREEN 5
#define UNIT_LPV_BLUE 6
#define UNIT_CACHE 5
#define UNIT_GATHERED 7
#define UNIT_LPV_LOBES 8
#define UNIT_REFLECTED 8
#define UNIT_LPV_GEOMETRY 9
#define UNIT_SPOT_SHADOWS 10
#define UNIT_POINT_SHADOWS 11
#define UNIT_NORMAL_MAP 12
#define UNIT_METAL_MAP 13
#define UNIT_EMISSION_MAP 14

// Programs that read a reflective shadow map or the visible surfaces
#define UNIT_RSM_POSITION 0
#define UNIT_RSM_NORMAL 1
#define UNIT_RSM_FLUX 2
#define UNIT_RSM_ALBEDO 3
#define UNIT_VISIBLE_DEPTH 3
#define UNIT_VISIBLE_NORMAL 4

// Programs that trace rays
#define UNIT_LIGHT_HIERARCHY 55
#define UNIT_BVH_NODES 60
#define UNIT_BVH_TRIANGLES 61
#define UNIT_VALUE_ATLAS 62

// Programs that shade surfaces with a coat
#define UNIT_COAT 63
