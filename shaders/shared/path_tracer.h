// Inputs of the path tracer's kernel: uniform block 0 and the storage blocks of triangles, materials and lights
// (std430).
// Space: that of the ray caster, the world moved by -origin (engine/rays/ray_scene.hpp).
#pragma once
#include "shared/types.h"

SHARED_BEGIN

// Kinds of surfaces.
#define PATH_DIFFUSE 0u
#define PATH_MIRROR 1u
#define PATH_CONDUCTOR 2u
#define PATH_DIELECTRIC 3u
#define PATH_NONE 4u
#define PATH_COATED 5u  // Lambert under a rough coat

// Kinds of lights.
#define PATH_LIGHT_SUN 0u
#define PATH_LIGHT_SPOT 1u
#define PATH_LIGHT_POINT 2u
#define PATH_LIGHT_TRIANGLE 3u
#define PATH_LIGHT_ENVIRONMENT 4u

#define PATH_NO_TEXTURE (-1)

// What lies beyond a texture's picture: TextureWrap (scene/scene.hpp).
#define PATH_WRAP_REPEAT 0
#define PATH_WRAP_EDGE 1
#define PATH_WRAP_MIRROR 2

// Data of the inspected pixel, stored after the lanes' state, in uvec4: number of records; vertices of the current
// path; records. A record: radiance and sample; scatterings, kind of light, its number, number of vertices; the
// vertices, and the light's position (w: 1 at infinity, then the direction to it).
#define PATH_INSPECTED_PLACES 8
#define PATH_INSPECTED_RECORD 11
#define PATH_INSPECTED_MEDIUM 5u      // in addition to the kinds of lights: an emissive medium
#define PATH_INSPECTED_BACKGROUND 6u

struct PathConstants {
  vec3 cameraPosition;      // where rays of a perspective view start; the centre of an orthographic one's picture
  uint seed;
  vec3 pixelRight;          // one pixel to the right, at distance 1 along the view
  uint sampleTarget;        // samples that every pixel of the tile should have
  vec3 pixelUp;             // one pixel up
  uint iterations;             // loop iterations after which a lane starts no further segment in this submission
  vec3 firstPixel;          // from the camera to the lower left corner of the picture at distance 1; along an
                            // orthographic view
  uint minScatterings;      // light with fewer scatterings on its way to the camera is not counted
  vec3 background;
  uint maxScatterings;
  vec3 environment;         // radiance, or a factor that scales the picture
  float environmentPick;    // probability that a light sample goes to the environment
  vec4 environmentTurn;     // cosine and sine of its rotation
  ivec4 tile;               // its lower left pixel, its size
  ivec4 picture;            // size of the picture; z: the lanes of the state buffer, at least those of the tile
  int isOrthographic;
  float lampPick;           // probability that a light sample goes to the hierarchy of lamps
  uint lampPairs;           // of siblings in it
  int padding0;
  vec4 filterQuantiles[16]; // of the pixel filter (engine/base/pixel_filter.hpp), four in each
};
SHARED_BLOCK(PathConstants)

// Position of a texture in the atlas; layer is PATH_NO_TEXTURE if there is none.
struct PathTexture {
  int layer;
  int x, y;                 // texel of its lower left corner
  int width, height;
  int wrapU, wrapV;         // PATH_WRAP_; read with TEXTURE_WRAPS
  int padding0;
};

struct PathMaterial {
  vec3 albedo;              // scales the texture
  uint kind;
  vec3 specular;
  float roughness;          // GGX alpha
  vec3 emission;
  float metallic;           // of a MetalMap (scene/scene.hpp), whose base is `albedo`; negative: none
  float ior;
  uint boundary;            // the closed boundary it belongs to: index of the material
  float normalScale;
  float mapRoughness;       // of a MetalMap, the square root of alpha; negative: `roughness` holds
  PathTexture diffuseTexture;
  PathTexture maskTexture;  // in alpha
  PathTexture emissionTexture;
  PathTexture normalTexture, metalTexture;  // in the atlas of non-colour values
};

// A light, combined with an entry of an alias table over all of them for picking one with a single number [Vose1991].
struct PathLight {
  vec3 a;                   // position; a triangle's first corner
  uint kind;
  vec3 b;                   // direction in which light travels; from the first corner to the second
  uint p;                   // bits of a spot's cosInner; a triangle's number in the scene
  vec3 c;                   // intensity or irradiance; from the first corner to the third
  uint q;                   // bits of a spot's cosOuter; a triangle's material
  float threshold;          // of the alias table: below it this light is picked, otherwise alias
  uint alias;
  float probability;        // of being picked
  float size;               // radius of a lamp's ball; 1 - cosine of half the sun's angular diameter
};

SHARED_END
