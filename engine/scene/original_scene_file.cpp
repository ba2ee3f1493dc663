#include "scene/original_scene_file.hpp"

#include "base/angles.hpp"
#include "base/files.hpp"
#include "scene/media_catalogue.hpp"
#include "scene/mtl_file.hpp"
#include "scene/scene_file.hpp"
#include "scene/scene_media.hpp"

#include <charconv>
#include <map>
#include <optional>
#include <set>
#include <sstream>

namespace lucerna {

namespace fs = std::filesystem;

namespace {

bool isComment(const std::string& key) { return key.rfind("//", 0) == 0; }

struct SceneKeys {
  Camera camera;
  PointLight light;
  double scale = 1.0;
};

SceneKeys readSceneKeys(const Value& object) {
  SceneKeys keys;
  std::optional<glm::dvec3> position, target, lightPosition;
  std::optional<glm::vec3> lightColor;
  std::optional<double> fov, lightIntensity;
  readObject(object, {
                         {"camera", [&](const Value& v) { position = v.vector(); }},
                         {"cameraLookAt", [&](const Value& v) { target = v.vector(); }},
                         {"fov",
                          [&](const Value& v) {
                            fov = v.number("degrees between 0 and 180");
                            if (!(*fov > 0.0 && *fov < 180.0)) v.fail("degrees between 0 and 180");
                          }},
                         {"lightPos", [&](const Value& v) { lightPosition = v.vector(); }},
                         {"lightColor", [&](const Value& v) { lightColor = v.light(); }},
                         {"lightIntensity",
                          [&](const Value& v) { lightIntensity = v.numberBetween(0.0, 1e30, "a number, 0 or more"); }},
                         {"scale", [&](const Value& v) { keys.scale = v.positiveNumber(); }},
                     });
  const std::pair<const char*, bool> needed[] = {{"camera", position.has_value()},
                                                 {"cameraLookAt", target.has_value()},
                                                 {"fov", fov.has_value()},
                                                 {"lightPos", lightPosition.has_value()},
                                                 {"lightColor", lightColor.has_value()},
                                                 {"lightIntensity", lightIntensity.has_value()}};
  for (const auto& [name, given] : needed)
    if (!given) throwBadInput("{}: key \"scene\": no \"{}\"", object.file.string(), name);
  if (!(glm::length(*target - *position) > 0.0)) object.at("cameraLookAt").fail("a point other than \"camera\"");
  keys.camera.name = "default";
  keys.camera.position = *position;
  keys.camera.direction = glm::normalize(*target - *position);
  const glm::dvec3 up =
      std::abs(keys.camera.direction.y) < 0.99999 ? glm::dvec3(0.0, 1.0, 0.0) : glm::dvec3(0.0, 0.0, -1.0);
  keys.camera.up = glm::normalize(glm::cross(glm::cross(keys.camera.direction, up), keys.camera.direction));
  keys.camera.verticalFov = *fov * kPi / 180.0;
  keys.light = {*lightPosition, *lightColor * static_cast<float>(*lightIntensity)};
  return keys;
}

struct PublishedMedium {
  Medium medium;  ///< in 1/mm
  float ior = 1.0f;
};

PublishedMedium readMedium(const Value& object) {
  PublishedMedium result;
  std::set<std::string> given;
  readObject(object, {
                         {"sigma_s", [&](const Value& v) { result.medium.scattering = glm::vec3(readCoefficient(v)); }},
                         {"sigma_a", [&](const Value& v) { result.medium.absorption = glm::vec3(readCoefficient(v)); }},
                         {"g", [&](const Value& v) { result.medium.anisotropy = readAnisotropy(v); }},
                         {"ior", [&](const Value& v) { result.ior = static_cast<float>(readIor(v)); }},
                     });
  for (const char* name : {"sigma_s", "sigma_a", "g", "ior"})
    if (!object.has(name)) throwBadInput("{}: key \"{}\": no \"{}\"", object.file.string(), object.key, name);
  return result;
}

fs::path modelBeside(const fs::path& json) {
  fs::path sameStem = json;
  sameStem.replace_extension(".obj");
  if (fs::exists(sameStem)) return sameStem;
  std::vector<fs::path> models;
  const fs::path folder = json.has_parent_path() ? json.parent_path() : fs::path(".");
  for (const auto& entry : fs::directory_iterator(folder))
    if (lowerExtension(entry.path()) == ".obj") models.push_back(entry.path());
  if (models.size() == 1) return models.front();
  throwBadInput("{}: no {} beside it, and {} other .obj files in its folder, where one would do", json.string(),
                sameStem.filename().string(), models.size());
}

/// The words of a line, split at blanks.
std::vector<std::string> wordsOf(const std::string& line) {
  std::istringstream stream(line);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

/// The rest of a line after its first word, trimmed: names may contain blanks.
std::string restOf(const std::string& line, const std::string& firstWord) {
  const std::size_t from = line.find_first_not_of(" \t", line.find(firstWord) + firstWord.size());
  const std::size_t to = line.find_last_not_of(" \t\r");
  return from == std::string::npos || to < from ? std::string() : line.substr(from, to - from + 1);
}

/// The materials of all libraries named by an OBJ, in order; unreadable ones are left out (the loader has warned).
std::vector<MtlMaterial> materialsBeside(const fs::path& obj) {
  std::istringstream text(readFileText(obj));
  std::vector<MtlMaterial> materials;
  for (std::string line; std::getline(text, line);) {
    if (line.rfind("mtllib", 0) != 0) continue;
    const fs::path library = obj.parent_path() / restOf(line, "mtllib");
    if (!fs::is_regular_file(library)) continue;
    std::set<std::string> ignored;
    for (MtlMaterial& material : readMtl(readFileText(library), ignored)) materials.push_back(std::move(material));
  }
  return materials;
}

/// The material for an ID; empty if there is none.
std::string materialOfId(const std::string& id, const std::vector<std::string>& names) {
  if (std::find(names.begin(), names.end(), id) != names.end()) return id;
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(id.data(), id.data() + id.size(), number);
  return error == std::errc() && end == id.data() + id.size() && number < names.size() ? names[number] : std::string();
}

}  // namespace

Scene loadOriginalScene(const Value& root) {
  const SceneKeys keys = readSceneKeys(root.at("scene"));
  std::map<std::string, PublishedMedium> media;
  for (const auto& [id, json] : root.json.items())
    if (id != "scene" && !isComment(id)) media[id] = readMedium(root.at(id));

  const fs::path model = modelBeside(root.file);
  Scene scene = loadModel(model);
  scene.name = root.file.stem().string();
  scene.file = root.file;
  scene.metresPerUnit = keys.scale / 1000.0;
  scene.sun.reset();
  scene.defaultSun = scene.studio = false;
  scene.exposure = 1.0f;
  scene.spots.clear();
  scene.points = {keys.light};
  scene.cameras = {keys.camera};
  scene.points[0].position -= scene.origin;
  scene.cameras[0].position -= scene.origin;
  scene.keyFrames.clear();
  for (Material& material : scene.materials) {
    material.bsdf = Bsdf::diffuse;
    material.opacity = 1.0f;
    material.emission = glm::vec3(0.0f);
    material.specular = glm::vec3(0.0f);
  }
  std::vector<std::string> names;
  for (const MtlMaterial& mtl : materialsBeside(model)) {
    names.push_back(mtl.name);
    for (Material& material : scene.materials)  // Lambert's surfaces, without a coat
      if (material.name == mtl.name && mtl.diffuse)
        material.diffuse = glm::clamp(*mtl.diffuse, glm::vec3(0.0f), glm::vec3(1.0f));
  }
  if (names.empty())  // no MTL: only the names in the OBJ are known
    for (const Material& material : scene.materials) names.push_back(material.name);
  for (const auto& [id, published] : media) {
    const std::string name = materialOfId(id, names);
    if (name.empty()) {
      std::string known;
      for (const std::string& n : names) known += (known.empty() ? "" : ", ") + n;
      throwBadInput("{}: key \"{}\": {} has no material of that name or number; it has {}", root.file.string(), id,
                    model.string(), known);
    }
    Medium medium = published.medium;
    medium.name = name;
    medium.scattering *= static_cast<float>(keys.scale);
    medium.absorption *= static_cast<float>(keys.scale);
    for (int c = 0; c < 3; ++c)
      if (!std::isfinite(medium.scattering[c] + medium.absorption[c]))
        root.at(id).fail("coefficients that fit into a float at this scale");
    for (Material& material : scene.materials) {
      if (material.name != name) continue;
      material.bsdf = Bsdf::dielectric;
      material.roughness = 0.0f;
      material.ior = published.ior;
      material.interior = static_cast<int>(scene.media.size());
    }
    scene.media.push_back(std::move(medium));
  }
  return scene;
}

std::vector<MtlEntry> readMtl(const fs::path& file) {
  std::istringstream text(readFileText(file));
  std::vector<MtlEntry> entries;
  int lineNumber = 0;
  for (std::string line; std::getline(text, line);) {
    ++lineNumber;
    const std::vector<std::string> words = wordsOf(line);
    if (words.empty()) continue;
    const auto number = [&]() {
      double value = 0.0;
      const std::string& word = words.back();
      const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
      if (words.size() < 2 || error != std::errc() || end != word.data() + word.size() || !std::isfinite(value))
        throwBadInput("{}:{}: '{}', expected {} and a number", file.string(), lineNumber, line.substr(0, 60), words[0]);
      return value;
    };
    if (words[0] == "newmtl") {
      const std::string name = restOf(line, "newmtl");
      if (name.empty()) throwBadInput("{}:{}: newmtl without a name", file.string(), lineNumber);
      entries.push_back({name});
    } else if (!entries.empty()) {
      if (words[0] == "Ni") entries.back().ior = number();
      if (words[0] == "d") entries.back().opacity = number();
      if (words[0] == "Tr") entries.back().opacity = 1.0 - number();
    }
  }
  if (entries.empty()) throwBadInput("{}: no material (no line newmtl NAME); is it an MTL?", file.string());
  return entries;
}

std::pair<std::string, std::vector<std::string>> draftOriginalScene(const fs::path& mtl) {
  const std::vector<MtlEntry> entries = readMtl(mtl);
  std::vector<std::string> report;

  Camera camera;
  camera.position = {0.0, 1.0, 4.0};
  camera.verticalFov = 50.0 * kPi / 180.0;
  glm::dvec3 target(0.0);
  double radius = 1.0;
  fs::path model = mtl;
  model.replace_extension(".obj");
  if (fs::exists(model)) {
    const Scene scene = loadModel(model);
    camera = scene.cameras.front();
    camera.position += scene.origin;
    target = scene.bounds.centre() + scene.origin;
    radius = 0.5 * glm::length(scene.bounds.extent());
    report.push_back(fmt::format("camera and light look at {}", model.string()));
  } else {
    report.push_back(fmt::format("no {}: camera and light look at the origin", model.string()));
  }
  const glm::dvec3 light = target + 2.0 * radius * glm::normalize(glm::dvec3(0.5, 1.5, 1.0));
  const double intensity = 10.0 * glm::dot(light - target, light - target);  // 10 W/m^2 in the centre

  const auto vector = [](const glm::dvec3& v) { return fmt::format("[{:.6g}, {:.6g}, {:.6g}]", v.x, v.y, v.z); };
  const auto quoted = [](const std::string& text) {
    return Json(text).dump(-1, ' ', false, Json::error_handler_t::replace);
  };
  std::string text = fmt::format(
      "{{\n  \"scene\": {{\n    \"camera\": {},\n    \"cameraLookAt\": {},\n    \"fov\": {:.6g},\n    \"lightPos\": "
      "{},\n",
      vector(camera.position), vector(target), camera.verticalFov * 180.0 / kPi, vector(light));
  text += fmt::format("    \"lightColor\": [1, 1, 1],\n    \"lightIntensity\": {:.6g},\n    \"scale\": 1.0\n  }}",
                      intensity);
  std::set<std::string> written = {"scene"};
  for (const MtlEntry& entry : entries) {
    const CatalogueMedium* medium = resemblingMedium(entry.name);
    std::string key = entry.name;
    double ior = 1.0;
    if (key == "scene" || isComment(key))
      throwBadInput("{}: a material named {}, which the scene JSON cannot name", mtl.string(), key);
    if (medium) {
      ior = medium->ior;
      report.push_back(fmt::format("{}: {}", entry.name, medium->name));
    } else {
      medium = findCatalogueMedium("glass");
      ior = entry.ior > 1.0 ? entry.ior : medium->ior;
      key = "// " + key;
      report.push_back(fmt::format(
          "{}: resembles no medium, diffuse{}; commented out as glass of ior {:g}", entry.name,
          entry.opacity < 1.0 || entry.ior > 1.0 ? ", although the MTL makes it transparent or gives it an ior" : "",
          ior));
    }
    if (!written.insert(key).second) continue;  // occurs twice in the MTL
    text += fmt::format(
        ",\n  {}: {{\n    \"sigma_s\": {},\n    \"sigma_a\": {},\n    \"g\": {},\n    \"ior\": {:g}\n  }}", quoted(key),
        vector(medium->scattering), vector(medium->absorption), vector(medium->anisotropy), ior);
  }
  return {text + "\n}\n", report};
}

}  // namespace lucerna
