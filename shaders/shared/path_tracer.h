// What the path tracer's kernel reads: uniform block 0 and the storage blocks of triangles, materials and lights
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

// Kinds of lights.
#define PATH_LIGHT_SUN 0u
#define PATH_LIGHT_SPOT 1u
#define PATH_LIGHT_POINT 2u
#define PATH_LIGHT_TRIANGLE 3u
#define PATH_LIGHT_ENVIRONMENT 4u

#define PATH_NO_TEXTURE (-1)

// Of the one pixel that is asked what lit it, behind the lanes' state in uvec4: how many records there are; places of
// the present path; records. A record: radiance and sample; scatterings, kind of the light, its number, places; the
// places, and where the light is (w: 1 at infinity, then the direction to it).
#define PATH_ASKED_PLACES 8
#define PATH_ASKED_RECORD 11
#define PATH_ASKED_MEDIUM 5u      // besides the kinds of lights: a medium that emits
#define PATH_ASKED_BACKGROUND 6u

struct PathConstants {
  vec3 cameraPosition;
  uint seed;
  vec3 pixelRight;          // one pixel to the right, at distance 1 along the view
  uint sampleTarget;        // samples that every pixel of the tile shall have
  vec3 pixelUp;             // one pixel up
  uint turns;               // of loops that a lane may take before it begins no other segment in this submission
  vec3 firstPixel;          // from the camera to the lower left corner of the picture at distance 1
  uint minScatterings;      // light counts that was scattered so often on its way to the camera
  vec3 background;
  uint maxScatterings;
  vec3 environment;         // radiance, or a factor on the picture
  float environmentPick;    // probability that a light sample goes to the environment
  vec4 environmentTurn;     // cosine and sine of its rotation
  ivec4 tile;               // its lower left pixel, its size
  ivec4 picture;            // size of the picture; z: the lanes of the state buffer, at least those of the tile
};

// Where a texture lies in the atlas; layer is PATH_NO_TEXTURE where there is none.
struct PathTexture {
  int layer;
  int x, y;                 // texel of its lower left corner
  int width, height;
  int padding0, padding1, padding2;
};

struct PathMaterial {
  vec3 albedo;              // a factor on the texture
  uint kind;
  vec3 specular;
  float roughness;          // GGX alpha
  vec3 emission;
  float metallic;           // of a MetalMap (scene/scene.hpp), whose base is `albedo`; negative where there is none
  float ior;
  uint boundary;            // which closed boundary it is of: index of the material
  float normalScale;
  float padding;
  PathTexture diffuseTexture;
  PathTexture maskTexture;  // in alpha
  PathTexture emissionTexture;
  PathTexture normalTexture, metalTexture;  // in the atlas of values that are no colours
};

// A light and, for the choice of one by one number, an entry of an alias table over all of them [Vose1991].
struct PathLight {
  vec3 a;                   // position; a triangle's first corner
  uint kind;
  vec3 b;                   // direction in which light travels; from the first corner to the second
  uint p;                   // bits of a spot's cosInner; a triangle's number in the scene
  vec3 c;                   // intensity or irradiance; from the first corner to the third
  uint q;                   // bits of a spot's cosOuter; a triangle's material
  float threshold;          // of the alias table: below it this light, else alias
  uint alias;
  float probability;        // of being picked
  float padding;
};

SHARED_END
