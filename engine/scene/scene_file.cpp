// Our scene JSON: a model, and properties that its file cannot express. One object; every key but "model" is optional.
//   "description": text for people
//   "model":       path of the model, relative to the JSON
//   "scale":       millimetres per scene unit
//   "camera":      {"position": [x,y,z], "target": [x,y,z] or "direction": [x,y,z], "up": [x,y,z],
//                  "fov": vertical, degrees}
//   "cameras":     an array of such, each with a "name"; instead of "camera"
//   "sun":         {"direction": [x,y,z] along which the light travels, "irradiance": [r,g,b],
//                  "angularDiameter": of its disc, degrees (0.53)}, or null for none
//   "spots":       [{"position": [x,y,z], "direction": [x,y,z] or "target": [x,y,z],
//                   "intensity": [r,g,b] on the axis, W/sr,
//                   "innerAngle", "outerAngle": half angles of the cone, degrees; SpotLight has the formula,
//                   "radius": of its ball (0)}]
//   "points":      [{"position": [x,y,z], "intensity": [r,g,b], W/sr, "radius": of its ball (0)}]
//                  If one of these is given and "sun" is not, there is no default sun.
//   "background":  [r,g,b], radiance visible where there is no environment
//   "exposure":    factor before tone mapping
//   "keyFrames":   path of the camera path, relative to the JSON
//   "environment": {"radiance": [r,g,b], constant or a factor (1) on
//                   "picture": path of a latitude-longitude hdr, exr or pfm; "rotation": degrees about +y},
//                  or {"sky": {"turbidity": 1.7 to 10 (3), "ground": albedo below the horizon (0.2)},
//                      "radiance": a factor (1)}: a clear sky for the sun's position, which must be above the horizon
//                  (scene/clear_sky.hpp); or null for none. Without the key, the default sun has its clear sky.
//   "media", "materials", "cameraMedium": see scene_media.hpp
// Places are in the model's coordinates, also where an offset is taken off those (Scene::origin).
// A top-level key "scene" marks the JSON of the VPT original instead: see original_scene_file.cpp.
// Unknown keys are errors. A new key is one more entry in the table in loadSceneFile.
#include "scene/scene_file.hpp"

#include "base/angles.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/json.hpp"
#include "base/log.hpp"
#include "scene/clear_sky.hpp"
#include "scene/json_value.hpp"
#include "scene/original_scene_file.hpp"
#include "scene/scene_media.hpp"

#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace lucerna {

namespace {

Camera readCamera(const Value& object) {
  Camera camera;
  camera.name = "default";
  std::optional<glm::dvec3> position, target, direction;
  glm::dvec3 up(0.0, 1.0, 0.0);
  readObject(object, {
                         {"name", [&](const Value& v) { camera.name = v.text(); }},
                         {"position", [&](const Value& v) { position = v.vector(); }},
                         {"target", [&](const Value& v) { target = v.vector(); }},
                         {"direction", [&](const Value& v) { direction = v.unitVector(); }},
                         {"up", [&](const Value& v) { up = v.unitVector(); }},
                         {"fov",
                          [&](const Value& v) {
                            const double degrees = v.number("degrees between 0 and 180");
                            if (!(degrees > 0.0 && degrees < 180.0)) v.fail("degrees between 0 and 180");
                            camera.verticalFov = degrees * kPi / 180.0;
                          }},
                     });
  if (!position) object.fail("a camera with \"position\"");
  if (target.has_value() == direction.has_value()) object.fail("a camera with either \"target\" or \"direction\"");
  if (target && !(glm::length(*target - *position) > 0.0))
    object.fail("a camera whose \"target\" is not its \"position\"");
  camera.position = *position;
  camera.direction = direction ? *direction : glm::normalize(*target - *position);
  const glm::dvec3 right = glm::cross(camera.direction, up);
  if (!(glm::length(right) > 1e-6))
    object.fail("a camera whose \"up\" (default [0,1,0]) is not parallel to its direction");
  camera.up = glm::normalize(glm::cross(right, camera.direction));
  return camera;
}

std::vector<Camera> readCameras(const Value& array) {
  if (!array.json.is_array() || array.json.empty()) array.fail("an array of at least one camera");
  std::vector<Camera> cameras;
  for (std::size_t i = 0; i < array.json.size(); ++i) {
    const Value entry = array.at(i);
    Camera camera = readCamera(entry);
    if (!entry.has("name")) entry.fail("a camera with \"name\"");
    for (const Camera& other : cameras)
      if (other.name == camera.name) entry.at("name").fail("a name that no other camera has");
    cameras.push_back(std::move(camera));
  }
  return cameras;
}

DirectionalLight readSun(const Value& object) {
  std::optional<glm::dvec3> direction;
  std::optional<glm::vec3> irradiance;
  double diameter = kSunDiameter;
  readObject(object, {
                         {"direction", [&](const Value& v) { direction = v.unitVector(); }},
                         {"irradiance", [&](const Value& v) { irradiance = v.light(); }},
                         {"angularDiameter", [&](const Value& v) { diameter = v.number("degrees") * kDegree; }},
                     });
  if (!direction || !irradiance) object.fail("a sun with \"direction\" and \"irradiance\"");
  if (!(diameter >= 0.0 && diameter <= 90.0 * kDegree)) object.at("angularDiameter").fail("degrees from 0 to 90");
  return {*direction, *irradiance, diameter};
}

/// The radius of a lamp's ball.
auto radiusOf(double& radius) {
  return [&radius](const Value& v) {
    radius = v.number("a radius");
    if (!(radius >= 0.0)) v.fail("a radius, not below 0");
  };
}

SpotLight readSpot(const Value& object) {
  std::optional<glm::dvec3> position, direction, target;
  std::optional<glm::vec3> intensity;
  std::optional<double> inner, outer;
  double radius = 0.0;
  const auto angle = [](std::optional<double>& result) {
    return [&result](const Value& v) { result = v.number("a half angle in degrees") * kDegree; };
  };
  readObject(object, {
                         {"position", [&](const Value& v) { position = v.vector(); }},
                         {"direction", [&](const Value& v) { direction = v.unitVector(); }},
                         {"target", [&](const Value& v) { target = v.vector(); }},
                         {"intensity", [&](const Value& v) { intensity = v.light(); }},
                         {"innerAngle", angle(inner)},
                         {"outerAngle", angle(outer)},
                         {"radius", radiusOf(radius)},
                     });
  if (!position || !intensity || !inner || !outer)
    object.fail("a spot with \"position\", \"intensity\", \"innerAngle\" and \"outerAngle\"");
  if (target.has_value() == direction.has_value()) object.fail("a spot with either \"target\" or \"direction\"");
  if (target && !(glm::length(*target - *position) > 0.0))
    object.fail("a spot whose \"target\" is not its \"position\"");
  if (!(*outer > 0.0 && *outer <= kLargestSpotAngle * (1.0 + 1e-12)))
    object.at("outerAngle").fail("a half angle above 0 and at most 80 degrees");
  if (!(*inner >= 0.0 && *inner <= *outer)) object.at("innerAngle").fail("a half angle from 0 to \"outerAngle\"");
  return {*position, direction ? *direction : glm::normalize(*target - *position), *intensity, *inner, *outer, radius};
}

PointLight readPoint(const Value& object) {
  std::optional<glm::dvec3> position;
  std::optional<glm::vec3> intensity;
  double radius = 0.0;
  readObject(object, {
                         {"position", [&](const Value& v) { position = v.vector(); }},
                         {"intensity", [&](const Value& v) { intensity = v.light(); }},
                         {"radius", radiusOf(radius)},
                     });
  if (!position || !intensity) object.fail("a point light with \"position\" and \"intensity\"");
  return {*position, *intensity, radius};
}

template <class Light>
std::vector<Light> readLights(const Value& array, Light (*read)(const Value&)) {
  if (!array.json.is_array()) array.fail("an array of lights");
  std::vector<Light> lights;
  for (std::size_t i = 0; i < array.json.size(); ++i) lights.push_back(read(array.at(i)));
  return lights;
}

/// Whether the picture lights anything; throws if a texel is not a valid radiance.
bool checkRadiance(const Image& picture, const std::filesystem::path& file, const glm::vec3& factor) {
  bool lights = false;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const glm::vec3& texel = picture.at(x, y);
      const auto isRadiance = [](float v) { return v >= 0.0f && static_cast<double>(v) <= kMostLight; };
      for (int c = 0; c < 3; ++c)
        if (!isRadiance(texel[c]) || !isRadiance(texel[c] * factor[c]))
          throwBadInput(
              "{}: texel {}, {} (column and row, from the upper left) is {} {} {}: radiance must be from 0 to {:g}{}",
              file.string(), x, y, texel.x, texel.y, texel.z, kMostLight,
              factor == glm::vec3(1.0f) ? "" : ", also times the environment's \"radiance\"");
      lights = lights || texel * factor != glm::vec3(0.0f);
    }
  return lights;
}

ClearSky readSky(const Value& object) {
  ClearSky sky;
  readObject(object,
             {
                 {"turbidity",
                  [&](const Value& v) {
                    sky.turbidity = v.numberBetween(ClearSky::kLeastTurbidity, ClearSky::kMostTurbidity,
                                                    "a turbidity from 1.7 to 10");
                  }},
                 {"ground", [&](const Value& v) { sky.ground = v.numberBetween(0.0, 1.0, "an albedo from 0 to 1"); }},
             });
  return sky;
}

Environment readEnvironment(const Value& object, const std::optional<DirectionalLight>& sun) {
  Environment environment;
  std::optional<glm::vec3> radiance;
  std::optional<ClearSky> sky;
  std::filesystem::path file;
  readObject(object,
             {
                 {"radiance", [&](const Value& v) { radiance = v.light(); }},
                 {"picture", [&](const Value& v) { environment.picture = readImage(file = v.path()); }},
                 {"sky", [&](const Value& v) { sky = readSky(v); }},
                 {"rotation", [&](const Value& v) { environment.rotation = v.number("degrees") * kPi / 180.0; }},
             });
  if (!radiance && !environment.picture && !sky)
    object.fail("an environment with \"radiance\", \"picture\" or \"sky\"");
  environment.radiance = radiance.value_or(glm::vec3(1.0f));
  if (sky) {
    if (environment.picture || object.has("rotation"))
      object.fail("a \"sky\" without \"picture\" and \"rotation\": the sun determines its orientation");
    if (!sun || !(sun->direction.y <= 0.0)) object.at("sky").fail("a scene with a sun above the horizon, for its sky");
    environment.picture = clearSkyPicture(*sky, *sun);
    file = object.file;
  }
  if (environment.picture && !checkRadiance(*environment.picture, file, environment.radiance))
    logWarning("{}: the environment is black: it lights nothing", file.string());
  return environment;
}

}  // namespace

Json readJson(const std::filesystem::path& file) { return parseJson(readFileText(file), file.string()); }

Scene loadSceneFile(const std::filesystem::path& file) {
  const Json json = readJson(file);
  const Value root{json, file, ""};
  if (!json.is_object()) throwBadInput("{}: expected a JSON object with the key \"model\"", file.string());
  if (root.has("scene")) return loadOriginalScene(root);

  // Values given here are kept until the model is loaded: they override those of the model's file.
  std::filesystem::path model, keyFrames;
  std::optional<double> scale, exposure;
  std::vector<Camera> cameras;
  std::optional<std::optional<DirectionalLight>> sun;
  std::optional<std::vector<SpotLight>> spots;
  std::optional<std::vector<PointLight>> points;
  std::optional<glm::vec3> background;
  readObject(root,
             {
                 {"description", [&](const Value& v) { static_cast<void>(v.text()); }},
                 {"model", [&](const Value& v) { model = v.path(); }},
                 {"scale", [&](const Value& v) { scale = v.positiveNumber(); }},
                 {"camera", [&](const Value& v) { cameras = {readCamera(v)}; }},
                 {"cameras", [&](const Value& v) { cameras = readCameras(v); }},
                 {"sun", [&](const Value& v) { sun = v.json.is_null() ? std::nullopt : std::optional(readSun(v)); }},
                 {"spots", [&](const Value& v) { spots = readLights(v, readSpot); }},
                 {"points", [&](const Value& v) { points = readLights(v, readPoint); }},
                 {"background", [&](const Value& v) { background = v.light(); }},
                 {"exposure", [&](const Value& v) { exposure = v.positiveNumber(); }},
                 {"keyFrames", [&](const Value& v) { keyFrames = v.path(); }},
                 {"environment", [](const Value&) {}},  // once it is known where the sun stands
                 {"media", [](const Value&) {}},  // these three by readSceneMedia, once the model is there
                 {"materials", [](const Value&) {}},
                 {"cameraMedium", [](const Value&) {}},
             });
  if (model.empty()) throwBadInput("{}: no key \"model\", the path of the model relative to this file", file.string());
  if (root.has("camera") && root.has("cameras"))
    throwBadInput("{}: both \"camera\" and \"cameras\", expected one of them", file.string());
  if (lowerExtension(model) == ".json") root.at("model").fail("a model, not another scene JSON");

  Scene scene = loadModel(model);
  scene.name = file.stem().string();
  scene.file = file;
  // Places in the file are as in the model's.
  for (Camera& camera : cameras) camera.position -= scene.origin;
  if (scale) scene.metresPerUnit = *scale / 1000.0;
  if (spots) {
    scene.spots = *spots;
    for (SpotLight& light : scene.spots) light.position -= scene.origin;
  }
  if (points) {
    scene.points = *points;
    for (PointLight& light : scene.points) light.position -= scene.origin;
  }
  if (sun || (scene.defaultSun && (spots || points))) {
    scene.sun = sun ? *sun : std::nullopt;
    scene.defaultSun = false;
    scene.defaultExposure = false;  // it belongs to the default sun
    scene.exposure = 1.0f;
  }
  if (exposure) {
    scene.defaultExposure = false;
    scene.exposure = static_cast<float>(*exposure);
  }
  if (background) scene.background = *background;
  readSceneMedia(root, scale, scene);
  if (!cameras.empty() || !keyFrames.empty()) useChosenView(scene);
  if (!cameras.empty()) scene.cameras = std::move(cameras);
  if (!keyFrames.empty()) {
    if (!root.has("camera") && !root.has("cameras")) scene.cameras.clear();
    setKeyFrames(scene, keyFrames);
  }
  if (!root.has("environment")) setDefaultSky(scene);
  else if (const Value environment = root.at("environment"); !environment.json.is_null())
    scene.environment = readEnvironment(environment, scene.sun);
  setDefaultExposure(scene, scene.cameras.front());
  return scene;
}

}  // namespace lucerna
