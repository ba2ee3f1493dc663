#include "measure/light_kinds.hpp"

#include <algorithm>

namespace lucerna::measure {

namespace {

bool shines(const glm::vec3& v) { return v.x > 0.0f || v.y > 0.0f || v.z > 0.0f; }

}  // namespace

LightKinds operator&(LightKinds a, LightKinds b) {
  return {a.sun && b.sun, a.lamps && b.lamps, a.surfaces && b.surfaces, a.environment && b.environment};
}

LightKinds without(LightKinds a, LightKinds b) {
  return {a.sun && !b.sun, a.lamps && !b.lamps, a.surfaces && !b.surfaces, a.environment && !b.environment};
}

std::string nameOf(LightKinds kinds) {
  std::string text;
  const auto add = [&](bool has, const char* name) {
    if (has) text += (text.empty() ? "" : ", ") + std::string(name);
  };
  add(kinds.sun, "sun");
  add(kinds.lamps, "lamps");
  add(kinds.surfaces, "emissive surfaces");
  add(kinds.environment, "environment");
  return text.empty() ? "none" : text;
}

LightKinds kindsOf(const Scene& scene) {
  LightKinds kinds;
  kinds.sun = scene.sun && shines(scene.sun->irradiance);
  kinds.lamps =
      std::any_of(scene.spots.begin(), scene.spots.end(), [](const SpotLight& l) { return shines(l.intensity); }) ||
      std::any_of(scene.points.begin(), scene.points.end(), [](const PointLight& l) { return shines(l.intensity); });
  kinds.surfaces =
      std::any_of(scene.materials.begin(), scene.materials.end(),
                  [](const Material& m) { return shines(m.emission); }) ||
      std::any_of(scene.media.begin(), scene.media.end(), [](const Medium& m) { return shines(m.emission); });
  kinds.environment = scene.environment && shines(scene.environment->radiance);
  return kinds;
}

Scene litBy(const Scene& scene, LightKinds kinds) {
  Scene result = scene;
  if (!kinds.sun) result.sun.reset();
  if (!kinds.lamps) {
    result.spots.clear();
    result.points.clear();
  }
  if (!kinds.surfaces) {
    for (Material& m : result.materials) {
      m.emission = m.emissionScale = glm::vec3(0.0f);
      m.emissionTexture = -1;
    }
    for (Medium& m : result.media) m.emission = glm::vec3(0.0f);
  }
  if (!kinds.environment) result.environment.reset();
  return result;
}

}  // namespace lucerna::measure
