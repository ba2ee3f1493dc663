// What shading records for the inspected pixel (engine/forward/inspected_pixel.hpp): indices in a storage block of
// vec4. The forward and the radiosity shader write it if compiled with the flag INSPECTED.
#pragma once
#include "shared/types.h"

SHARED_BEGIN

#define INSPECTED_BINDING 3      // a storage block
#define INSPECTED_POSITION 0     // of the surface, among the frame's positions; w: 1 where there is a surface
#define INSPECTED_NORMAL 1       // for shading
#define INSPECTED_MESH_NORMAL 2  // on the viewer's side
#define INSPECTED_ALBEDO 3
#define INSPECTED_RADIANCE 4     // total
#define INSPECTED_EMISSION 5     // radiance
#define INSPECTED_INDIRECT 6     // irradiance that the technique adds to direct light
#define INSPECTED_CORNERS 7      // of radiosity: weights of the patch's corners; w: the patch
#define INSPECTED_GLOSSY 7  // of forward shading: radiance reflected from the volume
#define INSPECTED_LIGHTS 8       // radiance per light. Forward shading: as below; radiosity: the order of DirectLights
#define INSPECTED_SUN 8
#define INSPECTED_SPOTS 9
#define INSPECTED_POINTS 25
#define INSPECTED_PLAIN_LAMPS 41

#define INSPECTED_PARTS_BINDING 1

// A contribution to the irradiance at that pixel: from a texel of a reflective shadow map, a cell or a cache record.
struct InspectedPart {
  vec3 irradiance;
  float weight;   // of a cell or record in the lookup
  vec3 place;     // where the light comes from, among the frame's positions
  float padding;
  ivec4 number;   // x, y and layer of a texel; x, y, z and cascade of a cell, or of a part of one plus all cascades
  vec4 red;       // coefficients of a cell's light, as stored
  vec4 green;
  vec4 blue;
};

SHARED_END
