// Specular reflection of a mesh's material: Blinn-Phong with this colour and exponent.
#include "lib/material.glsl"
uniform vec3 materialSpecular;
uniform float materialShininess;

struct Highlight {
  vec3 specular;
  float shininess;
};

Highlight materialHighlight(vec2 texCoord) {
#if METAL_MAPS
  vec2 map = vec2(materialRoughness, materialMetallic) * texture(metalTexture, texCoord).gb;
  if (materialRoughness >= 0.0) {
    float alpha = max(map.x, 0.03);
    alpha *= alpha;
    return Highlight(mix(vec3(0.04), materialColour(texCoord), map.y), max(2.0 / (alpha * alpha) - 2.0, 1.0));
  }
#endif
  return Highlight(materialSpecular, materialShininess);
}
