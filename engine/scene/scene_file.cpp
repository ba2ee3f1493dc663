// Our scene JSON: a model, and properties that its file cannot express. One object; every key but "model" is optional.
//   "description": text for people
//   "model":       path of the model, relative to the JSON; or an array of such, where only surfaces are read of the
//                  second and later ones, which stand still unless "objects" or key frames move them
//   "scale":       millimetres per scene unit
//   "camera":      {"position": [x,y,z], "target": [x,y,z] or "direction": [x,y,z], "up": [x,y,z],
//                  "fov": vertical, degrees}
//   "cameras":     an array of such, each with a "name"; instead of "camera"
//   "sun":         {"direction": [x,y,z] along which the light travels, "irradiance": [r,g,b],
//                  "angularDiameter": of its disc, degrees (0.53)}, or null for none; instead of "direction" a place
//                  and a time: "latitude", degrees, "day" of the year (172), "hour" of solar time (12 is noon), "+x"
//                  east and "-z" north; "irradiance" is then above the air, which dims and reddens it ("turbidity", 3)
//   "spots":       [{"position": [x,y,z], "direction": [x,y,z] or "target": [x,y,z],
//                   "intensity": [r,g,b] on the axis, W/sr,
//                   "innerAngle", "outerAngle": half angles of the cone, degrees; SpotLight has the formula,
//                   "radius": of its ball (0), "name": for key frames}]
//   "points":      [{"position": [x,y,z], "intensity": [r,g,b], W/sr, "radius": of its ball (0), "name": for key
//   frames}]
//                  If one of these is given and "sun" is not, there is no default sun.
//   "background":  [r,g,b], radiance visible where there is no environment
//   "exposure":    factor before tone mapping
//   "keyFrames":   path of the camera path and of what is carried (scene/key_frames.hpp), relative to the JSON
//   "environment": {"radiance": [r,g,b], constant or a factor (1) on
//                   "picture": path of a latitude-longitude hdr, exr or pfm; "rotation": degrees about +y},
//                  or {"sky": {"turbidity": 1.7 to 10 (3), "ground": albedo below the horizon (0.2)},
//                      "radiance": a factor (1)}: a clear sky for the sun's position, which must be above the horizon
//                  (scene/clear_sky.hpp); or null for none. Without the key, the default sun has its clear sky.
//   "media", "materials", "cameraMedium": see scene_media.hpp
//   "objects":     {NAME of a mesh of the model: {"translation": [x,y,z], "turn": {"axis": [x,y,z], "degrees"},
//                   "scale": a number or [x,y,z], "pivot": [x,y,z] about which it is turned and scaled (0,0,0)}}
// What moves: in cameras, sun, spots, points, background, exposure, environment, media, materials and objects a number
// or an array of numbers may be a curve, {"times": [...], "values": [...]} (scene/curve.hpp). Places are in the model's
// coordinates, also where an offset is taken off those (Scene::origin). A top-level key "scene" marks the JSON of the
// VPT original instead: see original_scene_file.cpp. Unknown keys are errors. A new key is one more entry in the table
// in loadSceneFile.
#include "scene/scene_file.hpp"

#include "base/angles.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/json.hpp"
#include "base/log.hpp"
#include "scene/clear_sky.hpp"
#include "scene/curve.hpp"
#include "scene/json_value.hpp"
#include "scene/main_bounds.hpp"
#include "scene/motion.hpp"
#include "scene/original_scene_file.hpp"
#include "scene/scene_media.hpp"

#include <fmt/ranges.h>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <set>
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

/// A sun, and its light above the air where its place is given by latitude, day and hour.
struct Sun {
  DirectionalLight light;
  double turbidity = 3.0;
  std::optional<glm::vec3> outside;
};

Sun readSun(const Value& object) {
  std::optional<glm::dvec3> direction;
  std::optional<glm::vec3> irradiance;
  std::optional<double> latitude, hour;
  double diameter = kSunDiameter, day = 172.0;
  Sun sun;
  readObject(
      object,
      {
          {"direction", [&](const Value& v) { direction = v.unitVector(); }},
          {"irradiance", [&](const Value& v) { irradiance = v.light(); }},
          {"angularDiameter", [&](const Value& v) { diameter = v.number("degrees") * kDegree; }},
          {"latitude", [&](const Value& v) { latitude = v.numberBetween(-90.0, 90.0, "degrees from -90 to 90"); }},
          {"day", [&](const Value& v) { day = v.numberBetween(1.0, 366.0, "a day from 1 to 366"); }},
          {"hour", [&](const Value& v) { hour = v.number("hours"); }},
          {"turbidity",
           [&](const Value& v) {
             sun.turbidity =
                 v.numberBetween(ClearSky::kLeastTurbidity, ClearSky::kMostTurbidity, "a turbidity from 1.7 to 10");
           }},
      });
  if (latitude && hour && !direction) {
    const glm::dvec3 toSun = directionToSun(*latitude, day, *hour);
    direction = -toSun;
    sun.outside = irradiance;
    if (irradiance) irradiance = sunThroughAir(sun.turbidity, toSun, *irradiance);
  } else if (latitude || hour || object.has("day") || object.has("turbidity")) {
    object.fail("a sun with either \"direction\", or \"latitude\" and \"hour\" (with \"day\", \"turbidity\")");
  }
  if (!direction || !irradiance) object.fail("a sun with \"direction\" and \"irradiance\"");
  if (!(diameter >= 0.0 && diameter <= 90.0 * kDegree)) object.at("angularDiameter").fail("degrees from 0 to 90");
  sun.light = {*direction, *irradiance, diameter};
  return sun;
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
  std::string name;
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
                         {"name", [&](const Value& v) { name = v.text(); }},
                     });
  if (!position || !intensity || !inner || !outer)
    object.fail("a spot with \"position\", \"intensity\", \"innerAngle\" and \"outerAngle\"");
  if (target.has_value() == direction.has_value()) object.fail("a spot with either \"target\" or \"direction\"");
  if (target && !(glm::length(*target - *position) > 0.0))
    object.fail("a spot whose \"target\" is not its \"position\"");
  if (!(*outer > 0.0 && *outer <= kLargestSpotAngle * (1.0 + 1e-12)))
    object.at("outerAngle").fail("a half angle above 0 and at most 80 degrees");
  if (!(*inner >= 0.0 && *inner <= *outer)) object.at("innerAngle").fail("a half angle from 0 to \"outerAngle\"");
  return {*position, direction ? *direction : glm::normalize(*target - *position), *intensity, *inner, *outer, radius,
          name};
}

PointLight readPoint(const Value& object) {
  std::optional<glm::dvec3> position;
  std::optional<glm::vec3> intensity;
  double radius = 0.0;
  std::string name;
  readObject(object, {
                         {"position", [&](const Value& v) { position = v.vector(); }},
                         {"intensity", [&](const Value& v) { intensity = v.light(); }},
                         {"radius", radiusOf(radius)},
                         {"name", [&](const Value& v) { name = v.text(); }},
                     });
  if (!position || !intensity) object.fail("a point light with \"position\" and \"intensity\"");
  return {*position, *intensity, radius, name};
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
      const auto isRadiance = [](float v) { return v >= 0.0f && v <= static_cast<float>(kMostLight); };
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

ClearSky readSky(const Value& object, double turbidity) {
  ClearSky sky;
  sky.turbidity = turbidity;
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

/// `known`: its picture, where it has been read before.
Environment readEnvironment(const Value& object, const std::optional<Sun>& sun, const Image* known = nullptr) {
  Environment environment;
  std::optional<glm::vec3> radiance;
  std::optional<ClearSky> sky;
  std::filesystem::path file;
  readObject(
      object,
      {
          {"radiance", [&](const Value& v) { radiance = v.light(); }},
          {"picture", [&](const Value& v) { environment.picture = known ? *known : readImage(file = v.path()); }},
          {"sky", [&](const Value& v) { sky = readSky(v, sun ? sun->turbidity : 3.0); }},
          {"rotation", [&](const Value& v) { environment.rotation = v.number("degrees") * kPi / 180.0; }},
      });
  if (!radiance && !environment.picture && !sky)
    object.fail("an environment with \"radiance\", \"picture\" or \"sky\"");
  environment.radiance = radiance.value_or(glm::vec3(1.0f));
  if (sky) {
    if (environment.picture || object.has("rotation"))
      object.fail("a \"sky\" without \"picture\" and \"rotation\": the sun determines its orientation");
    if (!sun || !(sun->outside || sun->light.direction.y <= 0.0))
      object.at("sky").fail("a scene with a sun above the horizon, for its sky");
    environment.picture =
        sun->outside ? skyOfDay(*sky, -sun->light.direction, *sun->outside) : clearSkyPicture(*sky, sun->light);
    file = object.file;
  }
  if (environment.picture && !known && !sun.value_or(Sun{}).outside &&
      !checkRadiance(*environment.picture, file, environment.radiance))
    logWarning("{}: the environment is black: it lights nothing", file.string());
  return environment;
}

/// Each object's matrix, by the model's mesh.
std::map<std::size_t, glm::dmat4> readObjects(const Value& objects, const Scene& scene) {
  if (!objects.json.is_object()) objects.fail("an object {\"mesh\": {...}}");
  std::map<std::size_t, glm::dmat4> matrices;
  for (const auto& [name, json] : objects.json.items()) {
    const Value object = objects.at(name);
    glm::dvec3 translation(0.0), scale(1.0), pivot(0.0), axis(0.0, 1.0, 0.0);
    double degrees = 0.0;
    readObject(object, {{"translation", [&](const Value& v) { translation = v.vector(); }},
                        {"turn",
                         [&](const Value& v) {
                           readObject(v, {{"axis", [&](const Value& a) { axis = a.unitVector(); }},
                                          {"degrees", [&](const Value& d) { degrees = d.number("degrees"); }}});
                           if (!v.has("axis") || !v.has("degrees")) v.fail("a turn with \"axis\" and \"degrees\"");
                         }},
                        {"scale",
                         [&](const Value& v) {
                           const bool isCurve = v.isCurve() && v.json.contains("values");
                           const Json& sample = isCurve ? v.json.at("values") : v.json;
                           const bool isVector = isCurve ? sample.is_array() && !sample.empty() && sample[0].is_array()
                                                         : sample.is_array();
                           scale = isVector ? v.vector("a factor, or an array of 3") : glm::dvec3(v.number("a factor"));
                         }},
                        {"pivot", [&](const Value& v) { pivot = v.vector(); }}});
    pivot -= scene.origin;
    glm::dmat4 matrix = glm::translate(glm::dmat4(1.0), translation + pivot);
    matrix = glm::rotate(matrix, degrees * kDegree, axis);
    matrix = glm::translate(glm::scale(matrix, scale), -pivot);
    bool found = false;
    for (std::size_t i = 0; i < scene.meshes.size(); ++i)
      if (scene.meshes[i].name == name) matrices[i] = matrix, found = true;
    if (!found) {
      std::set<std::string> names;
      for (const Mesh& mesh : scene.meshes)
        if (names.size() < 12) names.insert(fmt::format("'{}'", mesh.name));
      object.fail(fmt::format("the name of a mesh of the model, of which it has {} ({}{})", scene.meshes.size(),
                              fmt::join(names, ", "), names.size() < 12 ? "" : ", ..."));
    }
  }
  return matrices;
}

/// A scene's JSON, whose parts are read as they are at a time.
struct SceneJson {
  Json json;
  std::filesystem::path file;
  std::optional<double> millimetresPerUnit;
  std::vector<Material> materials;  ///< the model's own
  std::vector<Medium> media;

  Value root(double seconds) const { return {json, file, "", seconds}; }
  bool has(const char* key) const { return json.contains(key) && !json.at(key).is_null(); }
  bool moves(const char* key) const { return json.contains(key) && !keyTimesIn(json.at(key)).empty(); }

  std::optional<Sun> sunAt(double seconds) const {
    return has("sun") ? std::optional(readSun(root(seconds).at("sun"))) : std::nullopt;
  }
  /// The file's sun, or else the scene's.
  std::optional<Sun> sunOf(const Scene& scene, double seconds) const {
    if (has("sun")) return sunAt(seconds);
    return scene.sun ? std::optional(Sun{*scene.sun, 3.0, {}}) : std::nullopt;
  }
  template <class Light>
  std::vector<Light> lightsAt(const char* key, Light (*read)(const Value&), const Scene& scene, double seconds) const {
    std::vector<Light> lights = readLights(root(seconds).at(key), read);
    for (Light& light : lights) light.position -= scene.origin;
    return lights;
  }
  std::vector<Camera> camerasAt(const Scene& scene, double seconds) const {
    const Value at = root(seconds);
    std::vector<Camera> cameras =
        at.has("camera") ? std::vector{readCamera(at.at("camera"))} : readCameras(at.at("cameras"));
    for (Camera& camera : cameras) camera.position -= scene.origin;
    return cameras;
  }
  void setMedia(Scene& scene, double seconds) const {
    scene.materials = materials;
    scene.media = media;
    scene.cameraMedium = -1;
    readSceneMedia(root(seconds), millimetresPerUnit, scene);
  }
};

/// What its curves move.
void addMotion(const std::shared_ptr<const SceneJson>& json, Scene& scene) {
  using Part = SceneMotion::Part;
  const auto add = [&](Part part, const char* name, SceneMotion::Pose pose) {
    SceneMotion& motion = motionOf(scene);
    motion[part] = std::move(pose);
    motion.names.emplace_back(name);
  };
  const std::vector<double> times = keyTimesIn(json->json);
  for (const char* key : {"model", "scale", "description", "keyFrames", "cameraMedium"})
    if (json->moves(key)) json->root(0.0).at(key).fail("something that does not move");
  if (json->moves("objects")) {
    const Value objects = json->root(0.0).at("objects");
    for (const auto& [mesh, matrix] : readObjects(objects, scene))
      if (!keyTimesIn(objects.json.at(scene.meshes[mesh].name)).empty()) motionOf(scene).meshes.push_back(mesh);
    // Others are placed already: key frames may move them from there.
    add(Part::objects, "objects", [json, moving = motionOf(scene).meshes](Scene& posed, double t) {
      for (const auto& [mesh, matrix] : readObjects(json->root(t).at("objects"), posed))
        if (std::ranges::find(moving, mesh) != moving.end()) transformMesh(posed, posed.meshes[mesh], matrix);
    });
  }
  if (json->moves("sun")) add(Part::sun, "sun", [json](Scene& posed, double t) { posed.sun = json->sunAt(t)->light; });
  if (json->moves("spots"))
    add(Part::spots, "spots",
        [json](Scene& posed, double t) { posed.spots = json->lightsAt("spots", readSpot, posed, t); });
  if (json->moves("points"))
    add(Part::points, "points",
        [json](Scene& posed, double t) { posed.points = json->lightsAt("points", readPoint, posed, t); });
  if (json->moves("materials") || json->moves("media"))
    add(Part::media, "materials", [json](Scene& posed, double t) { json->setMedia(posed, t); });
  const bool followsSun =
      json->moves("sun") && json->has("environment") && json->json.at("environment").contains("sky");
  if (json->moves("environment") || followsSun)
    add(Part::environment, "environment", [json, followsSun](Scene& posed, double t) {
      const bool isKnown = !followsSun && posed.environment && posed.environment->picture;
      posed.environment = readEnvironment(json->root(t).at("environment"), json->sunOf(posed, t),
                                          isKnown ? &*posed.environment->picture : nullptr);
    });
  const bool viewMoves = json->moves("camera") || json->moves("cameras");
  if (viewMoves || json->moves("exposure") || json->moves("background"))
    add(Part::views, "views", [json, viewMoves](Scene& posed, double t) {
      if (viewMoves) posed.cameras = json->camerasAt(posed, t);
      if (json->moves("exposure")) posed.exposure = static_cast<float>(json->root(t).at("exposure").positiveNumber());
      if (json->moves("background")) posed.background = json->root(t).at("background").light();
    });
  if (!scene.motion || times.empty()) return;
  SceneMotion& motion = *scene.motion;
  motion.end = std::max(motion.end, times.back());
  // A value that is out of range is found now, not when its time has come.
  for (const double t : times)
    for (const Part part : {Part::sun, Part::spots, Part::points, Part::media, Part::views})
      if (motion[part]) motion[part](scene, t);
  for (const double t : times)
    if (json->moves("objects")) readObjects(json->root(t).at("objects"), scene);
  if (followsSun && !json->sunAt(0.0)->outside)
    for (const double t : times) readEnvironment(json->root(t).at("environment"), json->sunAt(t));
}

}  // namespace

Json readJson(const std::filesystem::path& file) { return parseJson(readFileText(file), file.string()); }

Scene loadSceneFile(const std::filesystem::path& file) {
  const auto json = std::make_shared<SceneJson>();
  json->json = readJson(file);
  json->file = file;
  const Value root = json->root(0.0);
  if (!root.json.is_object()) throwBadInput("{}: expected a JSON object with the key \"model\"", file.string());
  if (root.has("scene")) return loadOriginalScene(root);

  // Values given here are kept until the model is loaded: they override those of the model's file.
  std::vector<std::filesystem::path> models;
  std::filesystem::path keyFrames;
  std::optional<double> exposure;
  std::optional<glm::vec3> background;
  const auto later = [](const Value&) {};
  readObject(root, {{"description", [&](const Value& v) { static_cast<void>(v.text()); }},
                    {"model",
                     [&](const Value& v) {
                       if (!v.json.is_array()) models = {v.path()};
                       else
                         for (std::size_t i = 0; i < v.json.size(); ++i) models.push_back(v.at(i).path());
                       for (const std::filesystem::path& model : models)
                         if (lowerExtension(model) == ".json") v.fail("a model, not another scene JSON");
                     }},
                    {"scale", [&](const Value& v) { json->millimetresPerUnit = v.positiveNumber(); }},
                    {"background", [&](const Value& v) { background = v.light(); }},
                    {"exposure", [&](const Value& v) { exposure = v.positiveNumber(); }},
                    {"keyFrames", [&](const Value& v) { keyFrames = v.path(); }},
                    {"camera", later},
                    {"cameras", later},
                    {"sun", later},
                    {"spots", later},
                    {"points", later},
                    {"environment", later},
                    {"media", later},
                    {"materials", later},
                    {"cameraMedium", later},
                    {"objects", later}});
  if (models.empty()) throwBadInput("{}: no key \"model\", the path of the model relative to this file", file.string());
  const bool hasCameras = root.has("camera") || root.has("cameras");
  if (root.has("camera") && root.has("cameras"))
    throwBadInput("{}: both \"camera\" and \"cameras\", expected one of them", file.string());

  Scene scene = loadModel(models.front());
  for (std::size_t i = 1; i < models.size(); ++i) addModel(scene, models[i]);
  scene.name = file.stem().string();
  scene.file = file;
  json->materials = scene.materials;
  json->media = scene.media;
  if (json->millimetresPerUnit) scene.metresPerUnit = *json->millimetresPerUnit / 1000.0;
  // Places in the file are as in the model's. What it gives replaces what moves in the model.
  const auto replace = [&](SceneMotion::Part part) {
    if (scene.motion) (*scene.motion)[part] = nullptr;
  };
  const std::optional<Sun> sun = json->sunAt(0.0);
  if (root.has("spots")) scene.spots = json->lightsAt("spots", readSpot, scene, 0.0), replace(SceneMotion::Part::spots);
  if (root.has("points"))
    scene.points = json->lightsAt("points", readPoint, scene, 0.0), replace(SceneMotion::Part::points);
  if (root.has("sun") || (scene.defaultSun && (root.has("spots") || root.has("points")))) {
    scene.sun = sun ? std::optional(sun->light) : std::nullopt;
    replace(SceneMotion::Part::sun);
    scene.defaultSun = scene.studio = false;
    scene.defaultExposure = false;  // it belongs to the default sun
    scene.exposure = 1.0f;
  }
  if (exposure) {
    scene.defaultExposure = false;
    scene.exposure = static_cast<float>(*exposure);
  }
  if (background) scene.background = *background;
  readSceneMedia(root, json->millimetresPerUnit, scene);
  if (root.has("objects")) {
    const Value objects = root.at("objects");
    for (const auto& [mesh, matrix] : readObjects(objects, scene)) {
      if (!keyTimesIn(objects.json.at(scene.meshes[mesh].name)).empty()) continue;
      transformMesh(scene, scene.meshes[mesh], matrix);
      updateBounds(scene, mesh);
    }
    scene.bounds = {};
    for (const Mesh& mesh : scene.meshes) scene.bounds.add(mesh.bounds);
    findMainBounds(scene);
  }
  if (hasCameras) scene.cameras = json->camerasAt(scene, 0.0), replace(SceneMotion::Part::views);
  if (!keyFrames.empty()) setKeyFrames(scene, keyFrames, !hasCameras);
  if (hasCameras || !scene.keyFrames.empty()) useChosenView(scene);
  if (root.has("environment")) scene.studio = false;
  if (!root.has("environment")) setDefaultSky(scene);
  else if (const Value environment = root.at("environment"); !environment.json.is_null())
    scene.environment = readEnvironment(environment, sun         ? sun
                                                     : scene.sun ? std::optional(Sun{*scene.sun, 3.0, {}})
                                                                 : std::nullopt);
  setDefaultExposure(scene, scene.cameras.front());
  addMotion(json, scene);
  return scene;
}

}  // namespace lucerna
