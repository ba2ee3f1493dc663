#include "scene/gltf_file.hpp"

#include "base/json.hpp"

#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lucerna {

namespace fs = std::filesystem;

namespace {

/// Maximum number of elements of an accessor without bytes of its own (all zero, or sparse).
constexpr std::uint64_t kMostZeroElements = 1u << 24;

std::uint32_t wordAt(std::span<const std::uint8_t> bytes, std::size_t at) {
  return std::uint32_t{bytes[at]} | std::uint32_t{bytes[at + 1]} << 8 | std::uint32_t{bytes[at + 2]} << 16 |
         std::uint32_t{bytes[at + 3]} << 24;
}

/// The JSON text: the whole file, or the first chunk of a binary one (section 4.4: 12 bytes of header, then length,
/// type and data of each chunk).
std::string_view jsonText(const fs::path& file, std::span<const std::uint8_t> bytes) {
  const std::string_view all(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (!all.starts_with("glTF")) return all;
  if (bytes.size() < 20)
    throwBadInput("{}: {} bytes are too few for a binary glTF; is the file truncated?", file.string(), bytes.size());
  if (wordAt(bytes, 4) == 1) {  // version 1: length and format (0: JSON) of the scene are in the header
    const std::uint32_t length = wordAt(bytes, 12);
    if (length > bytes.size() - 20)
      throwBadInput("{}: a scene of {} bytes, {} are there; is the file truncated?", file.string(), length,
                    bytes.size() - 20);
    return all.substr(20, length);
  }
  const std::uint32_t length = wordAt(bytes, 12);
  if (all.substr(16, 4) != "JSON") throwBadInput("{}: the first chunk of a binary glTF must be JSON", file.string());
  if (length > bytes.size() - 20)
    throwBadInput("{}: a JSON chunk of {} bytes, {} are there; is the file truncated?", file.string(), length,
                  bytes.size() - 20);
  return all.substr(20, length);
}

/// Members of an array or object (glTF 1 has objects), by index or name.
std::map<std::string, const Json*> membersOf(const Json& root, const char* key) {
  std::map<std::string, const Json*> members;
  const auto found = root.find(key);
  if (found == root.end() || !found->is_structured()) return members;
  for (const auto& [name, member] : found->items()) members.emplace(name, &member);
  return members;
}

std::string nameOfReference(const Json& reference) {
  return reference.is_string() ? reference.get<std::string>() : reference.dump();
}

void checkNodes(const fs::path& file, const Json& root) {
  const std::map<std::string, const Json*> nodes = membersOf(root, "nodes");
  std::map<std::string, std::string> parents;
  for (const auto& [name, node] : nodes) {
    const auto children = node->is_object() ? node->find("children") : node->end();
    if (!node->is_object() || children == node->end()) continue;
    if (!children->is_array()) throwBadInput("{}: node {}: \"children\" must be an array", file.string(), name);
    for (const Json& child : *children) {
      const std::string childName = nameOfReference(child);
      if (!nodes.contains(childName)) throwBadInput("{}: node {}: no such node: {}", file.string(), name, childName);
      const auto [before, isNew] = parents.emplace(childName, name);
      if (!isNew)
        throwBadInput("{}: node {} is a child of node {} and of node {}; nodes must be trees", file.string(), childName,
                      before->second, name);
    }
  }
  // Every node has at most one parent, so only a cycle makes the walk upwards endless.
  std::map<std::string, int> depths;
  for (const auto& [name, node] : nodes) {
    std::vector<std::string> way;
    std::string at = name;
    for (; !depths.contains(at); at = parents.at(at)) {
      way.push_back(at);
      if (way.size() > static_cast<std::size_t>(kMostNodeDepth))
        throwBadInput("{}: node {} is its own descendant, or nested more than {} deep", file.string(), name,
                      kMostNodeDepth);
      if (parents.contains(at)) continue;
      depths[at] = 0;
      way.pop_back();
      break;
    }
    int depth = depths.at(at);
    for (auto step = way.rbegin(); step != way.rend(); ++step) depths[*step] = ++depth;
    if (depth > kMostNodeDepth)
      throwBadInput("{}: node {} is nested more than {} deep", file.string(), name, kMostNodeDepth);
  }
}

/// A non-negative integer of an object; 0 if missing. Anything else is left for Assimp to reject.
std::uint64_t wholeNumber(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_number_unsigned() ? found->get<std::uint64_t>() : 0;
}

void checkAccessors(const fs::path& file, const Json& root) {
  const std::map<std::string, const Json*> views = membersOf(root, "bufferViews");
  for (const auto& [name, accessor] : membersOf(root, "accessors")) {
    if (!accessor->is_object()) continue;
    const std::uint64_t count = wholeNumber(*accessor, "count");
    const auto view = accessor->find("bufferView");
    if (view == accessor->end()) {
      if (count > kMostZeroElements)
        throwBadInput("{}: accessor {}: {} elements without a buffer view, at most {} are supported", file.string(),
                      name, count, kMostZeroElements);
      continue;
    }
    const auto found = views.find(nameOfReference(*view));
    if (found == views.end() || !found->second->is_object())
      throwBadInput("{}: accessor {}: no such buffer view: {}", file.string(), name, nameOfReference(*view));
    const std::uint64_t bytes = wholeNumber(*found->second, "byteLength");
    if (count > bytes)
      throwBadInput("{}: accessor {}: {} elements in a buffer view of {} bytes", file.string(), name, count, bytes);
  }
}

}  // namespace

Json checkedGltf(const fs::path& file, std::span<const std::uint8_t> bytes) {
  Json root = parseJson<Json>(jsonText(file, bytes), file.string());
  if (!root.is_object()) throwBadInput("{}: expected a JSON object, a glTF", file.string());
  checkNodes(file, root);
  checkAccessors(file, root);
  return root;
}

std::vector<std::uint8_t> withNumbers(const Json& root, std::span<const std::uint8_t> bytes) {
  Json numbered = root;
  const auto putNumber = [](Json& object, std::size_t number, const std::string& nameless) {
    const auto name = object.find("name");
    if (name != object.end() && !name->is_string()) return;  // Assimp rejects it
    object["name"] = fmt::format("{}#{}", number, name == object.end() ? nameless : name->get<std::string>());
  };
  if (const auto materials = numbered.find("materials"); materials != numbered.end() && materials->is_array())
    for (std::size_t i = 0; i < materials->size(); ++i)
      if ((*materials)[i].is_object()) putNumber((*materials)[i], i, "");
  if (const auto nodes = numbered.find("nodes"); nodes != numbered.end() && nodes->is_array())
    for (std::size_t i = 0; i < nodes->size(); ++i) {
      Json& node = (*nodes)[i];
      if (!node.is_object()) continue;
      const auto camera = node.find("camera");
      if (camera != node.end() && camera->is_number_unsigned())
        putNumber(node, camera->get<std::size_t>(), fmt::format("nodes_{}", i));
    }
  std::string text = numbered.dump(-1, ' ', false, Json::error_handler_t::replace);
  const std::size_t oldLength = jsonText({}, bytes).size();
  if (oldLength == bytes.size()) return {text.begin(), text.end()};
  // Binary: header, length and type of the first chunk, the text padded with blanks, the other chunks.
  text.append((4 - text.size() % 4) % 4, ' ');
  std::vector<std::uint8_t> result(bytes.begin(), bytes.begin() + 20);
  result.insert(result.end(), text.begin(), text.end());
  result.insert(result.end(), bytes.begin() + 20 + static_cast<std::ptrdiff_t>(oldLength), bytes.end());
  const auto putWord = [&](std::size_t at, std::size_t value) {
    for (std::size_t i = 0; i < 4; ++i) result[at + i] = static_cast<std::uint8_t>(value >> (8 * i) & 255u);
  };
  putWord(8, result.size());
  putWord(12, text.size());
  return result;
}

std::optional<std::size_t> numberOf(std::string_view name) {
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
  if (error != std::errc() || end == name.data() + name.size() || *end != '#') return std::nullopt;
  return number;
}

std::string_view withoutNumber(std::string_view name) {
  return numberOf(name) ? name.substr(name.find('#') + 1) : name;
}

double gltfFieldOfView(const Json& root, std::size_t index) {
  const Json& angle = root.value(Json::json_pointer(fmt::format("/cameras/{}/perspective/yfov", index)), Json());
  return angle.is_number() ? angle.get<double>() : 0.0;
}

glm::dvec2 TextureTransform::apply(const glm::dvec2& uv) const {
  const double c = std::cos(rotation), s = std::sin(rotation);
  const glm::dvec2 scaled = scale * uv;
  return offset + glm::dvec2(c * scaled.x + s * scaled.y, c * scaled.y - s * scaled.x);
}

namespace {

glm::dvec2 pairOf(const Value& v) {
  if (!v.json.is_array() || v.json.size() != 2) v.fail("an array of 2 numbers");
  return {v.at(std::size_t{0}).number(), v.at(std::size_t{1}).number()};
}

TextureTransform transformOf(const Value& texture) {
  TextureTransform result;
  if (texture.has("texCoord"))
    result.texCoord = static_cast<unsigned>(
        texture.at("texCoord").numberBetween(0.0, 7.0, "a number of texture coordinates, 0 to 7"));
  if (!texture.has("extensions") || !texture.at("extensions").has("KHR_texture_transform")) return result;
  const Value given = texture.at("extensions").at("KHR_texture_transform");
  if (given.has("offset")) result.offset = pairOf(given.at("offset"));
  if (given.has("scale")) result.scale = pairOf(given.at("scale"));
  if (given.has("rotation")) result.rotation = given.at("rotation").number();
  if (given.has("texCoord"))
    result.texCoord =
        static_cast<unsigned>(given.at("texCoord").numberBetween(0.0, 7.0, "a number of texture coordinates, 0 to 7"));
  return result;
}

/// Whether a texture's sampler does anything but repeat.
bool clamps(const Json& root, const Value& texture) {
  constexpr int kRepeat = 10497;
  const auto member = [&](const char* array, const Json& index) -> const Json* {
    if (!root.contains(array) || !root.at(array).is_array() || !index.is_number_unsigned() ||
        index.get<std::uint64_t>() >= root.at(array).size())
      return nullptr;
    const Json& found = root.at(array).at(index.get<std::size_t>());
    return found.is_object() ? &found : nullptr;
  };
  const Json* source = texture.has("index") ? member("textures", texture.json.at("index")) : nullptr;
  const Json* sampler = source && source->contains("sampler") ? member("samplers", source->at("sampler")) : nullptr;
  if (!sampler) return false;
  return sampler->value("wrapS", Json(kRepeat)) != kRepeat || sampler->value("wrapT", Json(kRepeat)) != kRepeat;
}

}  // namespace

GltfMaterial gltfMaterial(const Json& root, const fs::path& file, std::size_t index) {
  GltfMaterial result;
  if (!root.contains("materials") || !root.at("materials").is_array() || index >= root.at("materials").size())
    return result;
  const Value material = Value{root, file, ""}.at("materials").at(index);
  if (!material.json.is_object()) material.fail("an object {...}");
  if (material.has("name") && material.at("name").json.is_string()) result.name = material.at("name").text();
  const auto lacks = [&](const std::string& what) { result.notDone += (result.notDone.empty() ? "" : ", ") + what; };

  // One set of texture coordinates serves all pictures.
  std::optional<TextureTransform> baseTransform;
  const auto read = [&](const Value& texture, const char* what) {
    const TextureTransform transform = transformOf(texture);
    result.clamped = result.clamped || clamps(root, texture);
    if (!baseTransform) baseTransform = transform;
    else if (!(transform == *baseTransform)) lacks(fmt::format("the {} texture lies as the first one does", what));
  };
  if (material.has("pbrMetallicRoughness")) {
    const Value base = material.at("pbrMetallicRoughness");
    if (!base.json.is_object()) base.fail("an object {...}");
    if (base.has("baseColorFactor")) {
      const Value factor = base.at("baseColorFactor");
      if (!factor.json.is_array() || factor.json.size() != 4) factor.fail("an array of 4 numbers");
      result.baseAlpha = factor.at(std::size_t{3}).numberBetween(0.0, 1.0, "a number from 0 to 1");
    }
    if (base.has("baseColorTexture")) read(base.at("baseColorTexture"), "base colour's");
    if (base.has("metallicRoughnessTexture")) read(base.at("metallicRoughnessTexture"), "metallic-roughness");
  }
  if (material.has("normalTexture")) {
    read(material.at("normalTexture"), "normal");
    if (material.at("normalTexture").has("scale"))
      result.normalScale = static_cast<float>(
          material.at("normalTexture").at("scale").numberBetween(-1e3, 1e3, "a number from -1000 to 1000"));
  }
  if (material.has("emissiveTexture")) read(material.at("emissiveTexture"), "emissive");
  result.transform = baseTransform.value_or(TextureTransform{});

  // Alpha.
  if (material.has("alphaMode")) {
    const std::string mode = material.at("alphaMode").text();
    if (mode != "OPAQUE" && mode != "MASK" && mode != "BLEND") material.at("alphaMode").fail("OPAQUE, MASK or BLEND");
    result.alpha = mode == "MASK"    ? GltfMaterial::Alpha::mask
                   : mode == "BLEND" ? GltfMaterial::Alpha::blend
                                     : GltfMaterial::Alpha::opaque;
    if (mode == "BLEND") lacks("not blended (BLEND) but cut out where alpha is below 0.5");
  }
  if (material.has("alphaCutoff"))
    result.alphaCutoff = material.at("alphaCutoff").numberBetween(0.0, 1e6, "a number, 0 or more");

  // Extensions; unknown ones are reported.
  if (!material.has("extensions")) return result;
  const Value extensions = material.at("extensions");
  if (!extensions.json.is_object()) extensions.fail("an object {...}");
  for (const auto& member : extensions.json.items()) {
    const std::string& name = member.key();
    const Value extension = extensions.at(name);
    if (!extension.json.is_object()) extension.fail("an object {...}");
    if (name == "KHR_materials_emissive_strength") {
      if (extension.has("emissiveStrength"))
        result.emissiveStrength =
            static_cast<float>(extension.at("emissiveStrength").numberBetween(0.0, 1e30, "a number, 0 or more"));
    } else if (name == "KHR_materials_ior") {
      if (extension.has("ior"))
        result.ior = static_cast<float>(extension.at("ior").numberBetween(1.0, 10.0, "a number from 1 to 10"));
    } else if (name == "KHR_materials_volume") {
      if (extension.has("thicknessFactor"))
        result.thickness = extension.at("thicknessFactor").numberBetween(0.0, 1e30, "a number, 0 or more");
      if (!extension.has("attenuationDistance")) continue;  // no absorption
      const double distance = extension.at("attenuationDistance").positiveNumber();
      if (!extension.has("attenuationColor")) continue;
      // Light is reduced to `colour` after `distance`. Black would be infinitely dense; a millionth is as good as
      // black.
      const glm::dvec3 colour =
          glm::max(extension.at("attenuationColor").vectorBetween(0.0, 1.0, "an array of 3 numbers from 0 to 1"),
                   glm::dvec3(1e-6));
      result.absorption = glm::vec3(-glm::log(colour) / distance);
    } else if (name == "KHR_materials_transmission") {
      if (extension.has("transmissionFactor"))
        result.transmission = extension.at("transmissionFactor").numberBetween(0.0, 1.0, "a number from 0 to 1");
      if (extension.has("transmissionTexture")) lacks("transmission without its texture");
    } else if (name != "KHR_materials_pbrSpecularGlossiness") {  // Assimp's own
      lacks("no " + name);
    }
  }
  return result;
}

std::string gltfLightsWithRange(const Json& root) {
  std::string names;
  const auto place = nlohmann::json::json_pointer("/extensions/KHR_lights_punctual/lights");
  if (!root.contains(place) || !root.at(place).is_array()) return names;
  for (const Json& light : root.at(place)) {
    if (!light.is_object() || !light.contains("range")) continue;
    const auto name = light.find("name");
    names += (names.empty() ? "" : ", ") +
             (name != light.end() && name->is_string() ? name->get<std::string>() : std::string("(no name)"));
  }
  return names;
}

}  // namespace lucerna
