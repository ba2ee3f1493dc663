// SceneNeeds from a scene: one pass over the drawn meshes.
#include "scene/needs.hpp"

namespace lucerna {

namespace {
bool anyPositive(const glm::vec3& v) { return v.x > 0.0f || v.y > 0.0f || v.z > 0.0f; }
}  // namespace

std::vector<std::pair<std::string, bool>> SceneNeeds::named() const {
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
  };
}

SceneNeeds analyse(const Scene& scene) {
  SceneNeeds needs;
  bool reflects = false;
  for (const Mesh& mesh : scene.meshes) {
    if (mesh.indexCount == 0) continue;
    const Material& material = scene.materials[static_cast<std::size_t>(mesh.material)];
    needs.diffuseTextures |= material.diffuseTexture >= 0;
    needs.alphaMasks |= material.alphaMasked;
    needs.specular |= anyPositive(material.specular);
    needs.emission |= anyPositive(material.emission);
    // A texture only scales the factor down, so the factor alone tells whether anything can be reflected.
    reflects |= anyPositive(material.diffuse);
  }
  needs.directionalLight = scene.sun && anyPositive(scene.sun->irradiance);
  needs.background = anyPositive(scene.background);
  for (const SpotLight& light : scene.spots) needs.spotLights |= anyPositive(light.intensity);
  for (const PointLight& light : scene.points) needs.pointLights |= anyPositive(light.intensity);
  needs.indirect = reflects && (needs.anyLight() || needs.emission);
  return needs;
}

}  // namespace lucerna
