// Our scene JSON: a model and what its file cannot say. One object; every key but "model" may be left out.
//   "description": text for people
//   "model":       path of the model, relative to the JSON
//   "scale":       millimetres a scene unit
//   "camera":      {"position": [x,y,z], "target": [x,y,z] or "direction": [x,y,z], "up": [x,y,z], "fov": vertical, degrees}
//   "cameras":     an array of such, each with a "name"; instead of "camera"
//   "sun":         {"direction": [x,y,z] along which the light travels, "irradiance": [r,g,b]}, or null for none
//   "spots":       [{"position": [x,y,z], "direction": [x,y,z] or "target": [x,y,z], "intensity": [r,g,b] on the axis, W/sr,
//                   "innerAngle", "outerAngle": half angles of the cone, degrees; SpotLight has the formula}], at most 4
//   "points":      [{"position": [x,y,z], "intensity": [r,g,b], W/sr}], at most 4
//                  Where one of these is given and "sun" is not, there is no default sun.
//   "background":  [r,g,b], radiance
//   "exposure":    factor before tone mapping
//   "keyFrames":   path of the camera path, relative to the JSON
// Unknown keys are errors. A new key is one more entry in the table in loadSceneFile.
#include "scene/scene_file.hpp"

#include "base/error.hpp"
#include "base/files.hpp"

#include <nlohmann/json.hpp>

#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace lucerna {

namespace {

using Json = nlohmann::json;

constexpr double kPi = 3.14159265358979323846;

/// A value and the place it stands at, such as "cameras[1].fov", for messages.
struct Value {
  const Json& json;
  const std::filesystem::path& file;
  std::string key;

  [[noreturn]] void fail(std::string_view expected) const {
    std::string found = json.dump(-1, ' ', false, Json::error_handler_t::replace);
    if (found.size() > 60) found = found.substr(0, 57) + "...";
    throwBadInput("{}: key \"{}\": found {}, expected {}", file.string(), key, found, expected);
  }

  Value at(std::string_view name) const { return {json.at(std::string(name)), file, key.empty() ? std::string(name) : fmt::format("{}.{}", key, name)}; }
  Value at(std::size_t index) const { return {json.at(index), file, fmt::format("{}[{}]", key, index)}; }
  bool has(std::string_view name) const { return json.contains(std::string(name)); }

  std::string text() const {
    if (!json.is_string()) fail("text");
    return json.get<std::string>();
  }

  double number(std::string_view expected = "a number") const {
    if (!json.is_number() || !std::isfinite(json.get<double>())) fail(expected);
    return json.get<double>();
  }

  double positiveNumber() const {
    const double value = number("a number above 0");
    if (!(value > 0.0)) fail("a number above 0");
    return value;
  }

  glm::dvec3 vector(std::string_view expected = "an array of 3 numbers") const {
    if (!json.is_array() || json.size() != 3) fail(expected);
    glm::dvec3 v;
    for (std::size_t i = 0; i < 3; ++i) v[static_cast<int>(i)] = at(i).number();
    return v;
  }

  glm::dvec3 unitVector() const {
    const glm::dvec3 v = vector("a direction: an array of 3 numbers");
    if (!(glm::length(v) > 0.0)) fail("a direction other than zero");
    return glm::normalize(v);
  }

  /// Radiance or irradiance: finite in float and not negative.
  glm::vec3 light() const {
    const glm::vec3 v(vector("an array of 3 numbers, 0 or more"));
    for (int c = 0; c < 3; ++c)
      if (!(v[c] >= 0.0f) || !std::isfinite(v[c])) fail("an array of 3 numbers, 0 or more");
    return v;
  }
};

struct Key {
  const char* name;
  std::function<void(const Value&)> read;
};

/// Gives each member of an object to the entry of its name.
void readObject(const Value& object, const std::vector<Key>& keys) {
  if (!object.json.is_object()) object.fail("an object {...}");
  for (const auto& [name, json] : object.json.items()) {
    const auto key = std::find_if(keys.begin(), keys.end(), [&](const Key& k) { return k.name == name; });
    if (key == keys.end()) {
      std::string known;
      for (const Key& k : keys) known += fmt::format("{}{}", known.empty() ? "" : ", ", k.name);
      throwBadInput("{}: unknown key \"{}\"; known are: {}", object.file.string(), object.key.empty() ? name : fmt::format("{}.{}", object.key, name), known);
    }
    key->read(object.at(name));
  }
}

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
      {"fov", [&](const Value& v) {
         const double degrees = v.number("degrees between 0 and 180");
         if (!(degrees > 0.0 && degrees < 180.0)) v.fail("degrees between 0 and 180");
         camera.verticalFov = degrees * kPi / 180.0;
       }},
  });
  if (!position) object.fail("a camera with \"position\"");
  if (target.has_value() == direction.has_value()) object.fail("a camera with either \"target\" or \"direction\"");
  if (target && !(glm::length(*target - *position) > 0.0)) object.fail("a camera whose \"target\" is not its \"position\"");
  camera.position = *position;
  camera.direction = direction ? *direction : glm::normalize(*target - *position);
  const glm::dvec3 right = glm::cross(camera.direction, up);
  if (!(glm::length(right) > 1e-6)) object.fail("a camera whose \"up\" (default [0,1,0]) is not parallel to its direction");
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
  readObject(object, {
      {"direction", [&](const Value& v) { direction = v.unitVector(); }},
      {"irradiance", [&](const Value& v) { irradiance = v.light(); }},
  });
  if (!direction || !irradiance) object.fail("a sun with \"direction\" and \"irradiance\"");
  return {*direction, *irradiance};
}

SpotLight readSpot(const Value& object) {
  constexpr double kDegree = kPi / 180.0;
  std::optional<glm::dvec3> position, direction, target;
  std::optional<glm::vec3> intensity;
  std::optional<double> inner, outer;
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
  });
  if (!position || !intensity || !inner || !outer) object.fail("a spot with \"position\", \"intensity\", \"innerAngle\" and \"outerAngle\"");
  if (target.has_value() == direction.has_value()) object.fail("a spot with either \"target\" or \"direction\"");
  if (target && !(glm::length(*target - *position) > 0.0)) object.fail("a spot whose \"target\" is not its \"position\"");
  if (!(*outer > 0.0 && *outer <= kLargestSpotAngle * (1.0 + 1e-12))) object.at("outerAngle").fail("a half angle above 0 and at most 80 degrees");
  if (!(*inner >= 0.0 && *inner <= *outer)) object.at("innerAngle").fail("a half angle from 0 to \"outerAngle\"");
  return {*position, direction ? *direction : glm::normalize(*target - *position), *intensity, *inner, *outer};
}

PointLight readPoint(const Value& object) {
  std::optional<glm::dvec3> position;
  std::optional<glm::vec3> intensity;
  readObject(object, {
      {"position", [&](const Value& v) { position = v.vector(); }},
      {"intensity", [&](const Value& v) { intensity = v.light(); }},
  });
  if (!position || !intensity) object.fail("a point light with \"position\" and \"intensity\"");
  return {*position, *intensity};
}

template <class Light>
std::vector<Light> readLights(const Value& array, std::size_t most, Light (*read)(const Value&)) {
  const std::string expected = fmt::format("an array of at most {} lights", most);
  if (!array.json.is_array() || array.json.size() > most) array.fail(expected);
  std::vector<Light> lights;
  for (std::size_t i = 0; i < array.json.size(); ++i) lights.push_back(read(array.at(i)));
  return lights;
}

}  // namespace

Scene loadSceneFile(const std::filesystem::path& file) {
  Json json;
  try {
    json = Json::parse(readFileText(file));
  } catch (const Json::exception& e) {
    throwBadInput("{}: not valid JSON: {}", file.string(), e.what());
  }
  const Value root{json, file, ""};
  if (!json.is_object()) throwBadInput("{}: expected a JSON object with the key \"model\"", file.string());
  if (root.has("scene"))
    throwBadInput("{}: a top-level key \"scene\" marks the scene JSON of the VPT original, which this version does not read yet", file.string());

  // What is said is kept until the model is there: it overrides what the model's file says.
  std::filesystem::path model, keyFrames;
  std::optional<double> scale, exposure;
  std::vector<Camera> cameras;
  std::optional<std::optional<DirectionalLight>> sun;
  std::optional<std::vector<SpotLight>> spots;
  std::optional<std::vector<PointLight>> points;
  std::optional<glm::vec3> background;
  const auto beside = [&](const Value& v) {
    const std::string path = v.text();
    if (path.empty()) v.fail("a path");
    return file.parent_path() / path;
  };
  readObject(root, {
      {"description", [&](const Value& v) { static_cast<void>(v.text()); }},
      {"model", [&](const Value& v) { model = beside(v); }},
      {"scale", [&](const Value& v) { scale = v.positiveNumber(); }},
      {"camera", [&](const Value& v) { cameras = {readCamera(v)}; }},
      {"cameras", [&](const Value& v) { cameras = readCameras(v); }},
      {"sun", [&](const Value& v) { sun = v.json.is_null() ? std::nullopt : std::optional(readSun(v)); }},
      {"spots", [&](const Value& v) { spots = readLights(v, kMaxSpotLights, readSpot); }},
      {"points", [&](const Value& v) { points = readLights(v, kMaxPointLights, readPoint); }},
      {"background", [&](const Value& v) { background = v.light(); }},
      {"exposure", [&](const Value& v) { exposure = v.positiveNumber(); }},
      {"keyFrames", [&](const Value& v) { keyFrames = beside(v); }},
  });
  if (model.empty()) throwBadInput("{}: no key \"model\", the path of the model relative to this file", file.string());
  if (root.has("camera") && root.has("cameras")) throwBadInput("{}: both \"camera\" and \"cameras\", expected one of them", file.string());
  if (lowerExtension(model) == ".json") root.at("model").fail("a model, not another scene JSON");

  Scene scene = loadModel(model);
  scene.name = file.stem().string();
  scene.file = file;
  if (scale) scene.metresPerUnit = *scale / 1000.0;
  if (spots) scene.spots = *spots;
  if (points) scene.points = *points;
  if (sun || (scene.defaultSun && (spots || points))) {
    scene.sun = sun ? *sun : std::nullopt;
    scene.defaultSun = false;
    scene.exposure = 1.0f;  // the default exposure belongs to the default sun
  }
  if (exposure) scene.exposure = static_cast<float>(*exposure);
  if (background) scene.background = *background;
  if (!cameras.empty()) scene.cameras = std::move(cameras);
  if (!keyFrames.empty()) {
    if (!root.has("camera") && !root.has("cameras")) scene.cameras.clear();
    setKeyFrames(scene, keyFrames);
  }
  return scene;
}

}  // namespace lucerna
