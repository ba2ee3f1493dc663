// What files leave out.
// - No light, not even of emissive surfaces: a sun. With a view that we chose too, that of the studio (studio.hpp) and
//   its sky; otherwise slanted to suit courtyards and halls, with its clear sky (set in loadScene, as the sun may still
//   be turned).
// - No camera: the first key of keyFrames/<stem>.txt if the repository has one, otherwise the studio's view.
// - Lamps far too weak or strong for an exposure of 1, since their units are arbitrary: another exposure, with a
//   warning.
#include "scene/scene_file.hpp"

#include "base/angles.hpp"
#include "base/data.hpp"
#include "base/log.hpp"
#include "scene/clear_sky.hpp"
#include "scene/key_frames.hpp"
#include "scene/motion.hpp"
#include "scene/studio.hpp"

#include <algorithm>
#include <cmath>

namespace lucerna {

namespace fs = std::filesystem;

namespace {

/// Slanted, so that walls are lit too. In Crytek Sponza it reaches a quarter of the court's floor and the curtains on
/// +z.
const glm::dvec3 kDefaultSunDirection = glm::normalize(glm::dvec3(0.12, -1.0, 0.2));
const glm::vec3 kDefaultSunIrradiance(10.0f, 9.6f, 9.0f);
/// Match that sun and its sky, some 12 W/unit^2: white stands at 0.4 * 0.8 * 12 / pi = 1.2 before the tone curve.
const float kExposureOutside = 0.4f, kExposureInside = 3.0f;

/// Whether the bounding sphere of the bounds intersects the cone around the view's corners, for a 16:9 picture; of an
/// orthographic view, the cylinder around them.
bool seesAnything(const Camera& camera, const Bounds& bounds) {
  const glm::dvec3 away = bounds.centre() - camera.position;
  const double distance = glm::length(away), radius = 0.5 * glm::length(bounds.extent());
  if (distance <= radius) return true;
  const double toCorner = camera.halfHeight() * std::hypot(1.0, 16.0 / 9.0);
  if (camera.isOrthographic()) {
    const double along = glm::dot(away, camera.direction);
    return along >= -radius && glm::length(away - along * camera.direction) <= radius + toCorner;
  }
  const double corner = std::atan(toCorner);
  return std::acos(std::clamp(glm::dot(away, camera.direction) / distance, -1.0, 1.0)) - std::asin(radius / distance) <
         corner;
}

double areaOf(const Scene& scene, const Mesh& mesh) {
  double sum = 0.0;
  for (std::uint32_t i = mesh.firstIndex; i < mesh.firstIndex + mesh.indexCount; i += 3) {
    const auto corner = [&](std::uint32_t k) { return glm::dvec3(scene.vertices[scene.indices[i + k]].position); };
    sum += 0.5 * glm::length(glm::cross(corner(1) - corner(0), corner(2) - corner(0)));
  }
  return sum;
}

double strongest(const glm::vec3& v) { return static_cast<double>(std::max({v.x, v.y, v.z})); }

/// Whether emissive surfaces are a scene's light rather than its pilot lamps. Their emission, averaged over all area,
/// is above a thousandth, and meets other surfaces, as that of a lamp in a room does. What shines outwards counts if
/// most of the area emits, or a thousandth of it and something more than white paper (1, as glTF has it without
/// KHR_materials_emissive_strength).
bool isLitByEmission(const Scene& scene) {
  double all = 0.0, emissive = 0.0, power = 0.0, most = 0.0;
  for (const Mesh& mesh : scene.meshes) {
    const Material& material = scene.materials[static_cast<std::size_t>(mesh.material)];
    const double area = areaOf(scene, mesh), emission = strongest(material.emission);
    all += area;
    most = std::max(most, emission);
    power += area * emission;
    if (emission > 0.0)
      emissive += area * (material.emissionTexture >= 0 ? emission / strongest(material.emissionScale) : 1.0);
  }
  if (!(power > 1e-3 * all)) return false;
  return emissive > 0.5 * all || (emissive > 1e-3 * all && most > 1.0) || !glowsOutwards(scene);
}

}  // namespace

std::vector<KeyFrame> keyFramesOf(const Scene& scene, const fs::path& file) {
  std::vector<KeyFrame> keys = readKeyFrames(file).camera;
  for (KeyFrame& key : keys) key.position -= scene.origin;
  return keys;
}

void setKeyFrames(Scene& scene, const fs::path& file, bool andCamera) {
  const KeyFrames keys = readKeyFrames(file);
  addMoves(scene, keys.moves, file);
  if (keys.camera.empty()) return;
  scene.keyFrames = file;
  if (!andCamera) return;
  Camera camera = Spline(keyFramesOf(scene, file)).view(0);
  camera.name = "default";
  scene.cameras = {std::move(camera)};
}

void setDefaultSun(Scene& scene) {
  if (scene.sun || !scene.spots.empty() || !scene.points.empty() || isLitByEmission(scene)) return;
  scene.sun = DirectionalLight{kDefaultSunDirection, kDefaultSunIrradiance, kSunDiameter};
  scene.defaultSun = true;
  scene.defaultExposure = true;
}

void setDefaultView(Scene& scene) {
  if (const auto data = findDataFolder()) {
    const fs::path walk = *data / "keyFrames" / (scene.name + ".txt");
    if (fs::exists(walk)) setKeyFrames(scene, walk, scene.cameras.empty());
  }
  // Cameras that animations would have turned, or that were read with the wrong handedness, may see nothing: then they
  // do not come first.
  const bool blind = !scene.cameras.empty() && !seesAnything(scene.cameras.front(), scene.main());
  if (blind)
    logWarning("{}: camera '{}' sees nothing of the scene; using the default view", scene.file.string(),
               scene.cameras.front().name);
  if (!scene.cameras.empty() && !blind) return;
  scene.cameras.insert(scene.cameras.begin(), studioView(scene));
  scene.studio = scene.defaultSun;
  if (scene.studio) scene.sun->direction = studioSun(scene.cameras.front());
}

void useChosenView(Scene& scene) {
  scene.studio = false;
  if (scene.defaultSun) scene.sun->direction = kDefaultSunDirection;
}

void setDefaultExposure(Scene& scene, const Camera& camera) {
  if (!scene.defaultExposure) return;
  const glm::bvec3 above = glm::greaterThan(camera.position, scene.main().min),
                   below = glm::lessThan(camera.position, scene.main().max);
  scene.exposure = glm::all(above) && glm::all(below) ? kExposureInside : kExposureOutside;
}

void setDefaultSky(Scene& scene) {
  if (!scene.defaultSun) return;
  scene.environment =
      Environment{glm::vec3(1.0f), scene.studio ? studioSky(*scene.sun) : clearSkyPicture({}, *scene.sun), 0.0};
}

void setExposureForLamps(Scene& scene) {
  if (scene.defaultSun) return;
  const double radius = 0.5 * glm::length(scene.main().extent());
  const auto lamp = [&](const glm::dvec3& position, const glm::vec3& intensity) {
    const double distance = std::max(glm::length(position - scene.main().centre()), radius);
    return strongest(intensity) / (distance * distance);
  };
  double irradiance = scene.sun ? strongest(scene.sun->irradiance) : 0.0;
  for (const SpotLight& light : scene.spots) irradiance += lamp(light.position, light.intensity);
  for (const PointLight& light : scene.points) irradiance += lamp(light.position, light.intensity);
  if (!(irradiance > 1e-30 && irradiance < 1e30) || (irradiance > 0.3 && irradiance < 30.0)) return;
  scene.exposure = static_cast<float>(3.0 / irradiance);
  logWarning(
      "{}: its lamps give an irradiance of about {:.2g}, so that pictures would be {} at exposure 1; {:.2g} is taken",
      scene.file.string(), irradiance, irradiance < 1.0 ? "black" : "white", scene.exposure);
}

}  // namespace lucerna
