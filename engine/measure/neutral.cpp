#include "measure/neutral.hpp"

#include "base/error.hpp"
#include "scene/features.hpp"

#include <algorithm>

namespace lucerna::measure {

namespace {

constexpr float kNothing = 1e-30f;  // above 0, and lost in any sum

int addWhiteTexture(Scene& scene) {
  Texture& texture = scene.textures.emplace_back();
  texture.file = "neutral";
  texture.bitmap.width = texture.bitmap.height = 1;
  texture.bitmap.rgba = {255, 255, 255, 255};
  return static_cast<int>(scene.textures.size()) - 1;
}

bool isNeeded(const Scene& scene, std::string_view need) {
  const auto named = analyse(scene).named();
  const auto found = std::find_if(named.begin(), named.end(), [&](const auto& n) { return n.first == need; });
  CHECK(found != named.end(), "need {}", need);
  return found->second;
}

}  // namespace

const std::vector<std::string>& neutralFeatures() {
  static const std::vector<std::string> names{"diffuseTextures", "alphaMasks",       "specular",           "emission",
                                              "background",      "environment",      "environmentPicture", "spotLights",
                                              "pointLights",     "emissionTextures", "normalMaps",         "metalMaps"};
  return names;
}

void addNeutral(Scene& scene, std::string_view need) {
  if (scene.meshes.empty() || isNeeded(scene, need)) return;
  Material& material = scene.materials[static_cast<std::size_t>(scene.meshes.front().material)];
  if (need == "diffuseTextures") {
    material.diffuseTexture = addWhiteTexture(scene);
  } else if (need == "alphaMasks") {
    material.alphaTexture = addWhiteTexture(scene);
    material.alphaMasked = true;
  } else if (need == "specular") {
    material.specular = glm::vec3(kNothing);
  } else if (need == "emission") {
    material.emission = glm::vec3(kNothing);
  } else if (need == "emissionTextures") {
    material.emission = material.emissionScale = glm::vec3(kNothing);
    material.emissionTexture = addWhiteTexture(scene);
  } else if (need == "normalMaps") {
    material.normalTexture = addWhiteTexture(scene);
    material.normalScale = kNothing;
  } else if (need == "metalMaps") {
    material.metalMap =
        MetalMap{material.diffuse, 0.0f, -1.0f, addWhiteTexture(scene)};  // no roughness: no highlight of its own
  } else if (need == "background") {
    scene.background = glm::vec3(kNothing);
  } else if (need == "environment") {
    scene.environment = Environment{glm::vec3(kNothing), {}, 0.0};
  } else if (need == "environmentPicture") {
    if (!scene.environment) scene.environment = Environment{glm::vec3(kNothing), {}, 0.0};
    scene.environment->picture = Image(2, 1, glm::vec3(1.0f));
  } else if (need == "spotLights") {
    scene.spots.push_back({scene.bounds.centre(), {0.0, -1.0, 0.0}, glm::vec3(kNothing), 0.4, 0.6});
  } else if (need == "pointLights") {
    scene.points.push_back({scene.bounds.centre(), glm::vec3(kNothing)});
  }
}

}  // namespace lucerna::measure
