// SceneFeatures from a scene: one pass over the drawn meshes.
#include "scene/features.hpp"

#include "scene/coat.hpp"

#include <algorithm>
#include <cmath>

namespace lucerna {

namespace {
bool anyPositive(const glm::vec3& v) { return v.x > 0.0f || v.y > 0.0f || v.z > 0.0f; }
bool anyPositive(const Image& picture) {
  return std::any_of(picture.pixels.begin(), picture.pixels.end(), [](const glm::vec3& v) { return anyPositive(v); });
}

/// Whether a texture of the material does not repeat.
bool hasWraps(const Scene& scene, const Material& material) {
  const int textures[] = {material.diffuseTexture, material.alphaTexture, material.emissionTexture,
                          material.normalTexture, material.metalMap ? material.metalMap->texture : -1};
  return std::any_of(std::begin(textures), std::end(textures), [&](int texture) {
    return texture >= 0 && static_cast<std::size_t>(texture) < scene.textures.size() &&
           !scene.textures[static_cast<std::size_t>(texture)].wraps.repeat();
  });
}

/// Whether a corner's normal differs from the triangle's by more than rounding. Its orientation counts too, since
/// surfaces are flipped by the triangle's side.
bool isSmooth(const Scene& scene, const Mesh& mesh) {
  if (mesh.firstIndex + std::size_t{mesh.indexCount} > scene.indices.size())
    return false;  // a scene without geometry, used only for its settings
  for (std::uint32_t i = mesh.firstIndex; i < mesh.firstIndex + mesh.indexCount; i += 3) {
    const auto corner = [&](std::uint32_t k) -> const Vertex& { return scene.vertices[scene.indices[i + k]]; };
    const glm::dvec3 a(corner(0).position);
    const glm::dvec3 cross = glm::cross(glm::dvec3(corner(1).position) - a, glm::dvec3(corner(2).position) - a);
    const double length = glm::length(cross);
    if (!(length > 0.0)) continue;
    for (std::uint32_t k = 0; k < 3; ++k)
      if (!(glm::length(glm::dvec3(corner(k).normal) - cross / length) < 1e-5)) return true;
  }
  return false;
}
double anisotropy(const Medium& medium, int channel) {
  return medium.phase == PhaseFunction::rayleigh ? 0.0 : static_cast<double>(medium.anisotropy[channel]);
}
}  // namespace

bool isDense(const Medium& medium, double extent) {
  if (medium.grid) return false;
  for (int c = 0; c < 3; ++c) {
    const double scattering = medium.scattering[c], absorption = medium.absorption[c],
                 depth = (scattering + absorption) * extent;
    // Mean numbers of collisions before absorption, and before leaving by a random walk.
    if (scattering > 31.0 * absorption && depth * std::max(1.0, depth * (1.0 - anisotropy(medium, c))) > 32.0)
      return true;
  }
  return false;
}

std::vector<std::pair<std::string, bool>> SceneFeatures::named() const {
  return {
      {"diffuseTextures", diffuseTextures},
      {"alphaMasks", alphaMasks},
      {"specular", specular},
      {"emission", emission},
      {"directionalLight", directionalLight},
      {"background", background},
      {"indirect", indirect},
      {"spotLights", spotLights},
      {"pointLights", pointLights},
      {"environment", environment},
      {"environmentPicture", environmentPicture},
      {"emissionTextures", emissionTextures},
      {"normalMaps", normalMaps},
      {"metalMaps", metalMaps},
      {"textureWraps", textureWraps},
      {"smoothNormals", smoothNormals},
      {"mirrors", mirrors},
      {"conductors", conductors},
      {"dielectrics", dielectrics},
      {"roughDielectrics", roughDielectrics},
      {"nullBoundaries", nullBoundaries},
      {"media", media},
      {"denseMedia", denseMedia},
      {"heterogeneousMedia", heterogeneousMedia},
      {"volumeEmission", volumeEmission},
  };
}

SceneFeatures analyse(const Scene& scene) {
  SceneFeatures features;
  bool reflects = false;
  const auto addMedium = [&](int index) {
    if (index < 0 || index >= static_cast<int>(scene.media.size())) return;
    const Medium& medium = scene.media[static_cast<std::size_t>(index)];
    const bool emits = anyPositive(medium.emission);
    if (!emits && !anyPositive(medium.scattering) && !anyPositive(medium.absorption)) return;
    features.media = true;
    features.volumeEmission |= emits;
    features.heterogeneousMedia |= medium.grid.has_value();
  };
  addMedium(scene.cameraMedium);
  for (const Mesh& mesh : scene.meshes) {
    if (mesh.indexCount == 0) continue;
    const Material& material = scene.materials[static_cast<std::size_t>(mesh.material)];
    features.diffuseTextures |= material.diffuseTexture >= 0;
    features.alphaMasks |= material.alphaMasked;
    features.specular |= hasCoat(material) || (material.bsdf != Bsdf::diffuse && material.bsdf != Bsdf::none);
    features.emission |= anyPositive(material.emission);
    features.emissionTextures |= anyPositive(material.emission) && material.emissionTexture >= 0;
    features.normalMaps |= material.normalTexture >= 0 && material.normalScale != 0.0f;
    features.metalMaps |= material.metalMap.has_value();
    features.textureWraps = features.textureWraps || hasWraps(scene, material);
    features.smoothNormals = features.smoothNormals || isSmooth(scene, mesh);
    features.mirrors |= material.bsdf == Bsdf::mirror;
    features.conductors |= material.bsdf == Bsdf::conductor;
    features.dielectrics |= material.bsdf == Bsdf::dielectric;
    features.roughDielectrics |= material.bsdf == Bsdf::dielectric && material.roughness > 0.0f;
    features.nullBoundaries |= material.bsdf == Bsdf::none;
    if (material.bsdf == Bsdf::dielectric || material.bsdf == Bsdf::none) addMedium(material.interior);
    if (material.bsdf == Bsdf::dielectric && material.interior >= 0 &&
        material.interior < static_cast<int>(scene.media.size()))
      features.denseMedia = features.denseMedia || isDense(scene.media[static_cast<std::size_t>(material.interior)],
                                                           glm::length(mesh.bounds.extent()));
    // A texture only scales the factor down, so the factor alone decides whether anything can be reflected.
    reflects |= anyPositive(material.diffuse) || anyPositive(material.specular);
  }
  features.directionalLight = scene.sun && anyPositive(scene.sun->irradiance);
  features.background = anyPositive(scene.background);
  for (const SpotLight& light : scene.spots) features.spotLights |= anyPositive(light.intensity);
  for (const PointLight& light : scene.points) features.pointLights |= anyPositive(light.intensity);
  features.environment = scene.environment && anyPositive(scene.environment->radiance) &&
                         (!scene.environment->picture || anyPositive(*scene.environment->picture));
  features.environmentPicture = features.environment && scene.environment->picture.has_value();
  features.indirect = reflects && (features.anyLight() || features.emission);
  return features;
}

}  // namespace lucerna
