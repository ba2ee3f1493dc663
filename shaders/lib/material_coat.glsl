// The coat of a mesh's material.
#include "lib/material.glsl"
#include "lib/coat.glsl"
uniform vec3 materialSpecular;
uniform float materialAlpha;

Coat materialCoat(vec2 texCoord) {
#if METAL_MAPS
  if (materialRoughness >= 0.0) {
    vec2 map = vec2(materialRoughness, materialMetallic) * texture(metalTexture, texCoord).gb;
    return Coat(mix(vec3(0.04), materialColour(texCoord), map.y), clamp(map.x * map.x, COAT_LEAST_ALPHA, 1.0));
  }
#endif
  return Coat(materialSpecular, materialAlpha);
}
