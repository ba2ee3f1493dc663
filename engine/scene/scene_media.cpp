#include "scene/scene_media.hpp"

#include "scene/density_file.hpp"
#include "scene/media_catalogue.hpp"

#include <limits>
#include <map>

namespace lucerna {

namespace {

/// A medium in 1 / scene unit and its index in Scene::media.
struct NamedMedium {
  int index = -1;
  double ior = 1.0;
};

/// Adds media to a scene when they are first named.
class Media {
 public:
  Media(Scene& scene, std::optional<double> millimetresPerUnit)
      : scene_(scene), millimetresPerUnit_(millimetresPerUnit) {}

  void readAll(const Value& object) {
    if (!object.json.is_object()) object.fail("an object {\"name\": medium, ...}");
    for (const auto& [name, json] : object.json.items()) {
      if (name.empty()) object.fail("media with names");
      add(name, read(object.at(name), name));
    }
  }

  /// Resolves the name in "interior" or "cameraMedium": one of "media", otherwise of the catalogue.
  NamedMedium named(const Value& value) {
    const std::string name = value.text();
    const auto known = media_.find(name);
    if (known != media_.end()) return known->second;
    const CatalogueMedium* entry = findCatalogueMedium(name);
    if (!entry) value.fail("a name of \"media\" or of the catalogue (lucerna media list)");
    return add(name, {mediumOf(*entry, scaleFor(value)), entry->ior});
  }

 private:
  struct Read {
    Medium medium;
    double ior = 1.0;
  };

  double scaleFor(const Value& value) const {
    if (!millimetresPerUnit_) value.fail("a \"scale\" (millimetres a unit) in the same file: coefficients are in 1/mm");
    return *millimetresPerUnit_;
  }

  NamedMedium add(const std::string& name, Read read) {
    read.medium.name = name;
    scene_.media.push_back(std::move(read.medium));
    return media_[name] = {static_cast<int>(scene_.media.size()) - 1, read.ior};
  }

  static Read catalogued(const Value& name, double scale) {
    const CatalogueMedium* entry = findCatalogueMedium(name.text());
    if (!entry) name.fail("a name of the catalogue (lucerna media list)");
    return {mediumOf(*entry, scale), entry->ior};
  }

  Read read(const Value& value, const std::string& name) const {
    const double scale = scaleFor(value);
    if (value.json.is_string()) return catalogued(value, scale);
    if (!value.json.is_object()) value.fail("a name of the catalogue or an object {...}");
    Read result;
    if (value.has("catalogue")) result = catalogued(value.at("catalogue"), scale);
    Medium& medium = result.medium;
    double concentration = 1.0;
    readObject(value,
               {
                   {"catalogue", [](const Value&) {}},
                   {"sigma_s", [&](const Value& v) { medium.scattering = glm::vec3(readCoefficient(v) * scale); }},
                   {"sigma_a", [&](const Value& v) { medium.absorption = glm::vec3(readCoefficient(v) * scale); }},
                   {"g", [&](const Value& v) { medium.anisotropy = readAnisotropy(v); }},
                   {"ior", [&](const Value& v) { result.ior = readIor(v); }},
                   {"concentration", [&](const Value& v) { concentration = v.positiveNumber(); }},
                   {"phase",
                    [&](const Value& v) {
                      const std::string phase = v.text();
                      if (phase == "henyey-greenstein") medium.phase = PhaseFunction::henyeyGreenstein;
                      else if (phase == "rayleigh") medium.phase = PhaseFunction::rayleigh;
                      else v.fail("henyey-greenstein or rayleigh");
                    }},
                   {"emission", [&](const Value& v) { medium.emission = glm::vec3(glm::dvec3(v.light()) * scale); }},
                   {"grid", [&](const Value& v) { medium.grid = readGrid(v); }},
               });
    medium.scattering *= static_cast<float>(concentration);
    medium.absorption *= static_cast<float>(concentration);
    for (int c = 0; c < 3; ++c)
      if (!std::isfinite(medium.scattering[c] + medium.absorption[c]))
        value.fail(fmt::format("coefficients of {} that fit into a float at this scale", name));
    return result;
  }

  DensityGrid readGrid(const Value& object) const {
    std::filesystem::path file;
    std::optional<glm::ivec3> size;
    std::optional<glm::dvec3> low, high;
    double factor = 1.0;
    readObject(object, {
                           {"file", [&](const Value& v) { file = v.path(); }},
                           {"size",
                            [&](const Value& v) {
                              constexpr const char* kExpected = "an array of 3 whole numbers, 1 or more";
                              const glm::dvec3 read = v.vectorBetween(1.0, 65536.0, kExpected);
                              size = glm::ivec3(read);
                              if (glm::dvec3(*size) != read) v.fail(kExpected);
                            }},
                           {"min", [&](const Value& v) { low = v.vector(); }},
                           {"max", [&](const Value& v) { high = v.vector(); }},
                           {"factor", [&](const Value& v) { factor = v.positiveNumber(); }},
                       });
    if (file.empty() || !low || !high) object.fail("a grid with \"file\", \"min\" and \"max\"");
    if (!(low->x < high->x && low->y < high->y && low->z < high->z))
      object.fail("a grid whose \"max\" is above its \"min\" in all three");
    DensityGrid grid = readDensityGrid(file, size);
    grid.min = *low - scene_.origin;
    grid.max = *high - scene_.origin;
    for (float& density : grid.density) {
      density *= static_cast<float>(factor);
      if (!std::isfinite(density)) object.at("factor").fail("a factor that leaves densities finite");
    }
    return grid;
  }

  Scene& scene_;
  std::optional<double> millimetresPerUnit_;
  std::map<std::string, NamedMedium> media_;
};

Bsdf readBsdf(const Value& value) {
  const std::string name = value.text();
  if (name == "diffuse") return Bsdf::diffuse;
  if (name == "mirror") return Bsdf::mirror;
  if (name == "conductor") return Bsdf::conductor;
  if (name == "dielectric") return Bsdf::dielectric;
  if (name == "none") return Bsdf::none;
  value.fail("diffuse, mirror, conductor, dielectric or none");
}

void readMaterial(const Value& object, Media& media, Material& material) {
  const Bsdf before = material.bsdf;
  bool hasIor = false;
  std::optional<NamedMedium> interior;
  constexpr const char* kReflectance = "an array of 3 numbers from 0 to 1";
  readObject(
      object,
      {
          {"bsdf", [&](const Value& v) { material.bsdf = readBsdf(v); }},
          {"ior", [&](const Value& v) { material.ior = static_cast<float>(readIor(v)), hasIor = true; }},
          {"roughness",
           [&](const Value& v) {
             material.roughness = static_cast<float>(v.numberBetween(0.0, 1.0, "a number from 0 to 1"));
           }},
          {"interior", [&](const Value& v) { interior = v.json.is_null() ? NamedMedium{} : media.named(v); }},
          {"priority",
           [&](const Value& v) {
             constexpr const char* kExpected = "a whole number from -1000 to 1000";
             const double priority = v.numberBetween(-1000.0, 1000.0, kExpected);
             if (priority != std::floor(priority)) v.fail(kExpected);
             material.priority = static_cast<int>(priority);
           }},
          {"diffuse", [&](const Value& v) { material.diffuse = glm::vec3(v.vectorBetween(0.0, 1.0, kReflectance)); }},
          {"specular", [&](const Value& v) { material.specular = glm::vec3(v.vectorBetween(0.0, 1.0, kReflectance)); }},
          {"emission", [&](const Value& v) { material.emission = v.light(); }},
      });
  if (interior && !object.has("bsdf")) material.bsdf = Bsdf::dielectric;
  // The roughness of a model's coat is not that of a mirror, metal or glass in its place.
  if (before == Bsdf::diffuse && material.bsdf != Bsdf::diffuse && !object.has("roughness")) material.roughness = 0.0f;
  if (interior && material.bsdf != Bsdf::dielectric && material.bsdf != Bsdf::none)
    object.at("interior").fail("no interior, as only \"dielectric\" and \"none\" have an inside");
  if (!interior) return;
  material.interior = interior->index;
  if (!hasIor && interior->index >= 0) material.ior = static_cast<float>(interior->ior);
}

}  // namespace

glm::dvec3 readCoefficient(const Value& value) {
  return value.vectorBetween(0.0, std::numeric_limits<float>::max(), "an array of 3 numbers in 1/mm, 0 or more");
}

glm::vec3 readAnisotropy(const Value& value) {
  constexpr const char* kExpected = "g above -1 and below 1: a number, or an array of 3";
  glm::vec3 g(0.0f);
  if (value.json.is_number()) g = glm::vec3(static_cast<float>(value.numberBetween(-1.0, 1.0, kExpected)));
  else g = glm::vec3(value.vectorBetween(-1.0, 1.0, kExpected));
  for (int c = 0; c < 3; ++c)
    if (!(std::abs(g[c]) < 1.0f)) value.fail(kExpected);
  return g;
}

double readIor(const Value& value) {
  return value.numberBetween(0.01, 100.0, "an index of refraction from 0.01 to 100");
}

void readSceneMedia(const Value& root, std::optional<double> millimetresPerUnit, Scene& scene) {
  Media media(scene, millimetresPerUnit);
  if (root.has("media")) media.readAll(root.at("media"));
  if (root.has("materials")) {
    const Value object = root.at("materials");
    if (!object.json.is_object()) object.fail("an object {\"name of a material of the model\": {...}, ...}");
    for (const auto& [name, json] : object.json.items()) {
      bool found = false;
      std::string known;
      for (Material& material : scene.materials) {
        known += (known.empty() ? "" : ", ") + material.name;
        if (material.name != name) continue;
        readMaterial(object.at(name), media, material);
        found = true;
      }
      if (!found)
        throwBadInput("{}: key \"materials.{}\": the model has no material of that name; it has {}", root.file.string(),
                      name, known);
    }
  }
  if (root.has("cameraMedium") && !root.at("cameraMedium").json.is_null())
    scene.cameraMedium = media.named(root.at("cameraMedium")).index;
}

}  // namespace lucerna
