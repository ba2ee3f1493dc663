// A mesh's material. Flags leave out features that no mesh of the scene uses.
// Textures are sampled first in a fragment shader, before `discard` and outside any branch: the mip level is chosen by
// derivatives, which are undefined after non-uniform control flow, and discarding counts as such [GLSL 4.30, 8.13.1,
// 8.9].
#include "shared/bindings.h"
uniform vec3 materialDiffuse;
#if DIFFUSE_TEXTURES
layout(binding = UNIT_DIFFUSE) uniform sampler2D diffuseTexture;  // white where a material has none
#endif
#if ALPHA_MASK
layout(binding = UNIT_MASK) uniform sampler2D maskTexture;
#endif

vec3 materialColour(vec2 texCoord) {
#if DIFFUSE_TEXTURES
  return materialDiffuse * texture(diffuseTexture, texCoord).rgb;
#else
  return materialDiffuse;
#endif
}

#if METAL_MAPS
// roughness in green, metallic in blue; white where a material has none
layout(binding = UNIT_METAL_MAP) uniform sampler2D metalTexture;
uniform float materialMetallic;                       // 0 where a material has no MetalMap (scene/scene.hpp)
uniform float materialRoughness;                      // negative if it has no MetalMap
#endif

vec3 materialAlbedo(vec2 texCoord) {
  vec3 colour = materialColour(texCoord);
#if METAL_MAPS
  colour *= 1.0 - materialMetallic * texture(metalTexture, texCoord).b;
#endif
  return colour;
}

#if NORMAL_MAPS
#include "lib/normal_map.glsl"
layout(binding = UNIT_NORMAL_MAP) uniform sampler2D normalTexture;
uniform float materialNormalScale;  // 0 if the material has no normal map
#endif

// Applies the material's normal map to an interpolated normal. The result lies on the same side of the face.
vec3 materialNormal(vec3 normal, vec3 position, vec2 texCoord) {
#if NORMAL_MAPS
  vec3 e1 = dFdx(position), e2 = dFdy(position);
  vec2 t1 = dFdx(texCoord), t2 = dFdy(texCoord);
  vec3 mapped = decodedNormal(texture(normalTexture, texCoord).xyz, materialNormalScale);
  if (materialNormalScale != 0.0) return normalFromMap(normalize(normal), e1, e2, t1, t2, mapped);
#endif
  return normal;
}

bool materialCutOut(vec2 texCoord) {
#if ALPHA_MASK
  return texture(maskTexture, texCoord).r < 0.5;
#else
  return false;
#endif
}
