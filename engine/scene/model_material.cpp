// The parts of a material that formats share.
// - Metallic-roughness (glTF 2.0, appendix B): diffuse = base (1 - metallic), specular = mix(0.04, base, metallic),
//   alpha = roughness^2. Code that treats a material as a whole uses the mean of its pictures, which preserves a
//   surface's total. Transmission above 0.5 is a dielectric of index 1.5.
// - Ks and Ns of MTL are a coat: Ks its reflectance at normal incidence, the lobe as wide as Blinn-Phong's of that
//   exponent. Kd stays what the surface reflects diffusely (scene/coat.hpp, baseUnderCoat).
#include "scene/model_import.hpp"
#include "scene/coat.hpp"
#include "scene/texture_mean.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lucerna {

float clampedNumber(float value, float low, float high, float fallback) {
  return std::isfinite(value) ? std::clamp(value, low, high) : fallback;
}

void setMetallicRoughness(Material& material, const glm::vec3& base, float metallic, float roughness,
                          float transmission) {
  material.diffuse = base * (1.0f - metallic);
  material.specular = glm::mix(glm::vec3(0.04f), base, metallic);
  material.roughness = roughness * roughness;
  if (transmission > 0.5f) material.bsdf = Bsdf::dielectric;
}

void setEmission(Material& material, const glm::vec3& radiance, int texture, const TextureLoader& textures) {
  for (int c = 0; c < 3; ++c)
    material.emissionScale[c] = clampedNumber(radiance[c], 0.0f, std::numeric_limits<float>::max(), 0.0f);
  material.emissionTexture = texture;
  material.emission = material.emissionScale;
  if (texture >= 0) material.emission *= glm::vec3(meanColour(textures[texture]));
}

Material colours(const aiMaterial& source) {
  Material material;
  material.name = source.GetName().C_Str();
  material.diffuse = colourOf(source, AI_MATKEY_COLOR_DIFFUSE).value_or(material.diffuse);
  material.specular = colourOf(source, AI_MATKEY_COLOR_SPECULAR).value_or(material.specular);
  material.emission =
      colourOf(source, AI_MATKEY_COLOR_EMISSIVE, std::numeric_limits<float>::max()).value_or(material.emission);
  material.diffuse = baseUnderCoat(material.diffuse, material.specular);
  material.roughness =
      alphaOfExponent(clampedNumber(numberOf(source, AI_MATKEY_SHININESS).value_or(1.0f), 0.0f, 1e6f, 1.0f));
  return material;
}

void setMetallicRoughness(Material& material, const aiMaterial& source, const glm::vec3& map) {
  // glTF's picture: roughness in green, metallic in blue.
  const float metallic =
      clampedNumber(numberOf(source, AI_MATKEY_METALLIC_FACTOR).value_or(0.0f) * map.z, 0.0f, 1.0f, 0.0f);
  const float roughness =
      clampedNumber(numberOf(source, AI_MATKEY_ROUGHNESS_FACTOR).value_or(1.0f) * map.y, 0.0f, 1.0f, 1.0f);
  const std::optional<glm::vec3> base = colourOf(source, AI_MATKEY_BASE_COLOR);
  setMetallicRoughness(material, base.value_or(colourOf(source, AI_MATKEY_COLOR_DIFFUSE).value_or(glm::vec3(1.0f))),
                       metallic, roughness, numberOf(source, AI_MATKEY_TRANSMISSION_FACTOR).value_or(0.0f));
}

void setEmission(Material& material, const aiMaterial& source, TextureLoader& textures) {
  if (material.emission == glm::vec3(0.0f)) return;
  const float strength = numberOf(source, AI_MATKEY_EMISSIVE_INTENSITY).value_or(1.0f);
  setEmission(material, material.emission * clampedNumber(strength, 0.0f, 1e30f, 1.0f),
              textures.optional(pictureOf(source, {aiTextureType_EMISSIVE, aiTextureType_EMISSION_COLOR})), textures);
}

void setAlbedoAndMask(Material& material, const aiMaterial& source, TextureLoader& textures) {
  material.diffuseTexture = textures.albedo(pictureOf(source, {aiTextureType_DIFFUSE, aiTextureType_BASE_COLOR}));
  material.alphaTexture = textures.optional(pictureOf(source, {aiTextureType_OPACITY}));
  // A colour picture named as its own mask means its alpha channel; without one it masks nothing.
  if (material.alphaTexture >= 0 && material.alphaTexture == material.diffuseTexture) material.alphaTexture = -1;
  material.alphaMasked =
      material.alphaTexture >= 0 || (material.diffuseTexture >= 0 && textures[material.diffuseTexture].hasAlpha);
}

}  // namespace lucerna
