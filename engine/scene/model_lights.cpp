// Lights and cameras of models.
// - A directional light's colour is its irradiance, that of a spot or point light its radiant intensity in W/sr, as in
//   the file; if it gives a quadratic attenuation q, colour / q. Constant and linear attenuation are unphysical and
//   ignored.
#include "scene/model_parts.hpp"

#include "base/angles.hpp"
#include "base/log.hpp"

#include <algorithm>
#include <cmath>

namespace lucerna {

std::vector<int> appendLights(Scene& scene, std::span<const ModelLight> lights) {
  std::vector<int> places(lights.size(), -1);
  unsigned others = 0;
  for (std::size_t i = 0; i < lights.size(); ++i) {
    const ModelLight& light = lights[i];
    const glm::vec3 colour = glm::max(light.colour, glm::vec3(0.0f));
    if (colour == glm::vec3(0.0f)) continue;  // no light: keep the default sun
    const bool aimed = isFinite(light.direction) && glm::length(light.direction) > 0.0;
    const glm::vec3 intensity = colour / (light.attenuation > 0.0f ? light.attenuation : 1.0f);
    const bool placed = isFinite(light.position) && isFinite(intensity);
    if (light.kind == ModelLight::Kind::directional && aimed && isFinite(colour) && !scene.sun) {
      places[i] = 0;
      scene.sun = DirectionalLight{glm::normalize(light.direction), colour, kSunDiameter};
    } else if (light.kind == ModelLight::Kind::point && placed) {
      places[i] = static_cast<int>(scene.points.size());
      scene.points.push_back({light.position, intensity, 0.0, light.name});
    } else if (light.kind == ModelLight::Kind::spot && placed && aimed && light.outerAngle > 0.0) {
      const double outer = std::min(light.outerAngle, kLargestSpotAngle);
      if (light.outerAngle > kLargestSpotAngle)
        logWarning("{}: spot light '{}' is wider than 80 degrees from its axis; clamped to that", scene.file.string(),
                   light.name);
      const double inner = std::clamp(light.innerAngle, 0.0, outer);
      places[i] = static_cast<int>(scene.spots.size());
      scene.spots.push_back(
          {light.position, glm::normalize(light.direction), intensity, inner, outer, 0.0, light.name});
    } else {
      ++others;
    }
  }
  if (others > 0)
    logWarning(
        "{}: {} lights ignored; supported are one directional light, spot and point lights and emissive surfaces",
        scene.file.string(), others);
  return places;
}

std::vector<int> appendCameras(Scene& scene, std::span<const Camera> cameras) {
  std::vector<int> places;
  for (Camera camera : cameras) {
    const glm::dvec3 right = glm::cross(camera.direction, camera.up);
    const bool opens = camera.isOrthographic() ? std::isfinite(camera.orthographicHeight)
                                               : camera.verticalFov > 0.0 && camera.verticalFov < kPi;
    const bool usable = isFinite(camera.position) && glm::length(right) > 0.0 && opens;
    if (!usable) {
      logWarning("{}: camera '{}' has an invalid direction, up or field of view; ignored", scene.file.string(),
                 camera.name);
      places.push_back(-1);
      continue;
    }
    camera.direction = glm::normalize(camera.direction);
    camera.up = glm::normalize(glm::cross(right, camera.direction));
    places.push_back(static_cast<int>(scene.cameras.size()));
    scene.cameras.push_back(std::move(camera));
  }
  return places;
}

}  // namespace lucerna
