#include "scene/gltf_file.hpp"

#include "base/files.hpp"
#include "base/json.hpp"
#include "scene/model_parts.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

namespace lucerna {

namespace fs = std::filesystem;

namespace {

/// Maximum number of elements of an accessor without bytes of its own (all zero, or sparse).
constexpr std::size_t kMostZeroElements = 1u << 22;

/// Extensions that are read. Materials without what others describe are named by their reader.
constexpr std::string_view kSupported[] = {
    "EXT_mesh_gpu_instancing",    "KHR_lights_punctual",   "KHR_materials_emissive_strength",
    "KHR_materials_ior",          "KHR_materials_volume",  "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_transmission", "KHR_texture_transform", "KHR_mesh_quantization",
    "KHR_animation_pointer"};

bool isSupported(std::string_view name) {
  return std::find(std::begin(kSupported), std::end(kSupported), name) != std::end(kSupported);
}

/// Metadata, which changes no picture.
bool hasNoEffect(std::string_view name) { return name == "KHR_xmp" || name == "KHR_xmp_json_ld"; }

std::uint32_t glbWord(std::span<const std::uint8_t> bytes, std::size_t at) {
  return std::uint32_t{bytes[at]} | std::uint32_t{bytes[at + 1]} << 8 | std::uint32_t{bytes[at + 2]} << 16 |
         std::uint32_t{bytes[at + 3]} << 24;
}

struct Chunks {
  std::string_view json;
  std::optional<std::span<const std::uint8_t>> binary;
};

/// The JSON text: the whole file, or the first chunk of a binary one (section 4.4: 12 bytes of header, then length,
/// type and data of each chunk), whose second chunk is the first buffer.
Chunks chunksOf(const fs::path& file, std::span<const std::uint8_t> bytes) {
  const std::string_view all(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (!all.starts_with("glTF")) return {all, std::nullopt};
  if (bytes.size() < 20)
    throwBadInput("{}: {} bytes are too few for a binary glTF; is the file truncated?", file.string(), bytes.size());
  if (const std::uint32_t version = glbWord(bytes, 4); version != 2)
    throwBadInput("{}: glTF {}.0 is not supported, only glTF 2.0", file.string(), version);
  if (const std::uint32_t length = glbWord(bytes, 8); length > bytes.size())
    throwBadInput("{}: a binary glTF of {} bytes, {} are there; is the file truncated?", file.string(), length,
                  bytes.size());
  Chunks chunks;
  for (std::size_t at = 12; at + 8 <= bytes.size();) {
    const std::uint32_t length = glbWord(bytes, at);
    const std::string_view type = all.substr(at + 4, 4);
    at += 8;
    const bool isJson = type == "JSON";
    if (chunks.json.empty() && !isJson)
      throwBadInput("{}: the first chunk of a binary glTF must be JSON", file.string());
    if (length > bytes.size() - at)
      throwBadInput("{}: a {} chunk of {} bytes, {} are there; is the file truncated?", file.string(),
                    isJson ? "JSON" : "binary", length, bytes.size() - at);
    if (isJson && length == 0) throwBadInput("{}: the JSON chunk is empty", file.string());
    if (isJson && chunks.json.empty()) chunks.json = all.substr(at, length);
    else if (type == std::string_view("BIN\0", 4) && !chunks.binary) chunks.binary = bytes.subspan(at, length);
    at += length;
  }
  // Some writers pad the text with zeros.
  while (chunks.json.ends_with('\0')) chunks.json.remove_suffix(1);
  return chunks;
}

int sextet(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  return c == '+' || c == '-' ? 62 : c == '/' || c == '_' ? 63 : -1;
}

int hexDigit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

/// RFC 3986, section 2.1. A % that begins no code stands for itself.
std::string percentDecoded(std::string_view text) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const int high = text[i] == '%' && i + 2 < text.size() ? hexDigit(text[i + 1]) : -1;
    const int low = high >= 0 ? hexDigit(text[i + 2]) : -1;
    if (low >= 0) result += static_cast<char>(16 * high + low), i += 2;
    else result += text[i];
  }
  return result;
}

struct ComponentType {
  int code;
  std::size_t bytes;
  double most;  ///< what `normalized` divides by; 0: not an integer
  bool isSigned;
};

constexpr ComponentType kComponentTypes[] = {{5120, 1, 127.0, true},         {5121, 1, 255.0, false},
                                             {5122, 2, 32767.0, true},       {5123, 2, 65535.0, false},
                                             {5125, 4, 4294967295.0, false}, {5126, 4, 0.0, true}};

const ComponentType* componentType(const Json& code) {
  const auto found = std::find_if(std::begin(kComponentTypes), std::end(kComponentTypes),
                                  [&](const auto& t) { return code == t.code; });
  return found != std::end(kComponentTypes) ? found : nullptr;
}

ComponentType componentTypeOf(const Value& object) {
  if (!object.has("componentType")) object.fail("an object with a componentType");
  const ComponentType* type = componentType(object.at("componentType").json);
  if (!type) object.at("componentType").fail("5120, 5121, 5122, 5123, 5125 or 5126");
  return *type;
}

double numberAt(const std::uint8_t* bytes, const ComponentType& type) {
  std::uint32_t word = 0;  // little-endian
  for (std::size_t i = 0; i < type.bytes; ++i) word |= std::uint32_t{bytes[i]} << (8 * i);
  switch (type.code) {
    case 5120: return static_cast<std::int8_t>(word);
    case 5122: return static_cast<std::int16_t>(word);
    case 5126: return static_cast<double>(std::bit_cast<float>(word));
    default: return word;
  }
}

}  // namespace

std::size_t wholeNumber(const Value& object, std::string_view key) {
  if (!object.has(key)) return 0;
  const Value value = object.at(key);
  if (!value.json.is_number_unsigned()) value.fail("an integer, 0 or more");
  return value.json.get<std::size_t>();
}

std::optional<std::vector<std::uint8_t>> dataOf(const Value& uri) {
  const std::string text = uri.text();
  if (!text.starts_with("data:")) return std::nullopt;
  const std::size_t comma = text.find(',');
  if (comma == std::string::npos) uri.fail("data:[type];base64,...");
  std::vector<std::uint8_t> bytes;
  const std::string content = percentDecoded(std::string_view(text).substr(comma + 1));
  if (!std::string_view(text).substr(0, comma).ends_with(";base64")) return {{content.begin(), content.end()}};
  bytes.reserve(content.size() / 4 * 3);
  std::uint32_t held = 0;
  int bits = 0;
  for (const char c : content) {
    if (c == '=' || c == '\n' || c == '\r' || c == ' ') continue;
    const int value = sextet(c);
    if (value < 0) uri.fail("data in base64");
    held = held << 6 | static_cast<std::uint32_t>(value);
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    bytes.push_back(static_cast<std::uint8_t>(held >> bits & 255u));
  }
  return bytes;
}

std::string fileNameOf(const Value& uri) {
  const std::string written = uri.text(), decoded = percentDecoded(written);
  const auto isThere = [&](const std::string& name) {
    std::error_code error;
    return name.find('\0') == std::string::npos && fs::exists(uri.file.parent_path() / name, error);
  };
  return !isThere(decoded) && isThere(written) ? written : decoded;
}

GltfFile::GltfFile(const fs::path& file, std::span<const std::uint8_t> bytes) : file_(file), size_(bytes.size()) {
  const Chunks chunks = chunksOf(file, bytes);
  root_ = parseJson<Json>(chunks.json, file.string());
  if (!root_.is_object()) throwBadInput("{}: expected a JSON object, a glTF", file.string());
  if (chunks.binary) binary_.emplace(chunks.binary->begin(), chunks.binary->end());
  checkVersion();
  checkExtensions();
  readParents();
}

void GltfFile::checkVersion() const {
  std::string version;
  if (root_.contains("meshes") && root_.at("meshes").is_object()) version = "1.0";  // arrays since 2.0
  if (root_.contains("asset")) {
    const Value asset = root().at("asset");
    if (!asset.json.is_object()) asset.fail("an object {...}");
    if (asset.has("version")) {
      const Value given = asset.at("version");
      version = given.json.is_number() ? fmt::format("{:.1f}", given.number()) : given.text();
    }
    // 2.x can be read as 2.0 unless the file says otherwise.
    const bool isReadable = version == "2" || version.starts_with("2.");
    if (isReadable && asset.has("minVersion") && asset.at("minVersion").text() != "2.0")
      version = asset.at("minVersion").text();
    else if (isReadable) return;
  }
  if (version.empty()) throwBadInput("{}: no \"version\" of an \"asset\": not a glTF", file_.string());
  throwBadInput("{}: glTF {} is not supported, only glTF 2.0", file_.string(), version);
}

void GltfFile::checkExtensions() const {
  if (!root_.contains("extensionsRequired")) return;
  const Value required = root().at("extensionsRequired");
  if (!required.json.is_array()) required.fail("an array");
  std::string unknown;
  for (std::size_t i = 0; i < required.json.size(); ++i)
    if (const std::string name = required.at(i).text(); !isSupported(name))
      unknown += (unknown.empty() ? "" : ", ") + name;
  if (!unknown.empty()) throwBadInput("{}: requires extensions that are not supported: {}", file_.string(), unknown);
}

std::vector<std::string> GltfFile::unsupported() const {
  std::set<std::string> ofMaterials;
  for (std::size_t i = 0; i < count("materials"); ++i)
    if (const Value material = at("materials", i); material.json.is_object() && material.has("extensions"))
      for (const auto& extension : material.at("extensions").json.items()) ofMaterials.insert(extension.key());
  std::vector<std::string> names;
  for (std::size_t i = 0; i < count("extensionsUsed"); ++i) {
    const std::string name = at("extensionsUsed", i).text();
    if (!isSupported(name) && !hasNoEffect(name) && !ofMaterials.contains(name)) names.push_back(name);
  }
  return names;
}

void GltfFile::readParents() {
  const std::size_t nodes = count("nodes");
  parents_.assign(nodes, -1);
  for (std::size_t i = 0; i < nodes; ++i) {
    const Value node = at("nodes", i);
    if (!node.json.is_object()) node.fail("an object {...}");
    if (!node.has("children")) continue;
    const Value children = node.at("children");
    if (!children.json.is_array()) children.fail("an array");
    for (std::size_t k = 0; k < children.json.size(); ++k) {
      const Json& child = children.json[k];
      if (!child.is_number_unsigned() || child.get<std::size_t>() >= nodes)
        throwBadInput("{}: node {}: no such node: {}", file_.string(), i, child.dump());
      int& parent = parents_[child.get<std::size_t>()];
      if (parent >= 0)
        throwBadInput("{}: node {} is a child of node {} and of node {}; nodes must be trees", file_.string(),
                      child.get<std::size_t>(), parent, i);
      parent = static_cast<int>(i);
    }
  }
  // Every node has at most one parent, so only a cycle makes the walk upwards endless.
  std::vector<int> depths(nodes, -1);
  for (std::size_t i = 0; i < nodes; ++i) {
    std::vector<std::size_t> way;
    int depth = -1;
    for (int at = static_cast<int>(i); at >= 0 && depth < 0; at = parents_[static_cast<std::size_t>(at)]) {
      depth = depths[static_cast<std::size_t>(at)];
      if (depth < 0) way.push_back(static_cast<std::size_t>(at));
      if (way.size() > static_cast<std::size_t>(kMostNodeDepth) + 1)
        throwBadInput("{}: node {} is its own descendant, or nested more than {} deep", file_.string(), i,
                      kMostNodeDepth);
    }
    for (auto step = way.rbegin(); step != way.rend(); ++step) depths[*step] = ++depth;
    if (depth > kMostNodeDepth)
      throwBadInput("{}: node {} is nested more than {} deep", file_.string(), i, kMostNodeDepth);
  }
}

std::size_t GltfFile::count(std::string_view array) const {
  if (!root().has(array)) return 0;
  const Value value = root().at(array);
  if (!value.json.is_array()) value.fail("an array");
  return value.json.size();
}

std::size_t GltfFile::indexOf(const Value& value, std::string_view array) const {
  const std::size_t there = count(array);
  if (!value.json.is_number_unsigned() || value.json.get<std::size_t>() >= there)
    value.fail(fmt::format("the number of one of {} {}", there, array));
  return value.json.get<std::size_t>();
}

std::optional<Value> GltfFile::extension(const Value& object, std::string_view name) {
  if (!object.json.is_object() || !object.has("extensions")) return std::nullopt;
  const Value extensions = object.at("extensions");
  if (!extensions.json.is_object()) extensions.fail("an object {...}");
  if (!extensions.has(name)) return std::nullopt;
  Value found = extensions.at(name);
  if (!found.json.is_object()) found.fail("an object {...}");
  return found;
}

std::span<const std::uint8_t> GltfFile::bytesOfBuffer(std::size_t index) const {
  const Value buffer = at("buffers", index);
  const std::size_t length = wholeNumber(buffer, "byteLength");
  const auto checked = [&](std::span<const std::uint8_t> bytes) {
    if (bytes.size() < length)
      throwBadInput("{}: buffer {}: {} bytes, {} are there; is it truncated?", file_.string(), index, length,
                    bytes.size());
    return bytes.first(length);
  };
  if (const auto known = buffers_.find(index); known != buffers_.end()) return checked(known->second);
  if (!buffer.has("uri")) {
    if (index == 0 && binary_) return checked(*binary_);
    throwBadInput("{}: buffer {} has neither a uri nor a binary chunk", file_.string(), index);
  }
  const Value uri = buffer.at("uri");
  std::optional<std::vector<std::uint8_t>> bytes = dataOf(uri);
  if (!bytes) {
    const std::string name = withForwardSlashes(fileNameOf(uri));
    try {
      bytes = readFileBytes(file_.parent_path() / name);
    } catch (const Error& error) {
      throw Error(error.kind(), fmt::format("{}: buffer {}: {}", file_.string(), index, error.what()));
    }
  }
  return checked(buffers_.emplace(index, std::move(*bytes)).first->second);
}

std::size_t GltfFile::bytesRead() const {
  std::size_t bytes = size_;
  for (const auto& [index, buffer] : buffers_) bytes += buffer.size();
  return bytes;
}

std::span<const std::uint8_t> GltfFile::bytesOfView(std::size_t index) const {
  const Value view = at("bufferViews", index);
  if (!view.json.is_object() || !view.has("buffer")) view.fail("an object with a buffer");
  const std::span<const std::uint8_t> buffer = bytesOfBuffer(indexOf(view.at("buffer"), "buffers"));
  const std::size_t offset = wholeNumber(view, "byteOffset"), length = wholeNumber(view, "byteLength");
  if (offset > buffer.size() || length > buffer.size() - offset)
    throwBadInput("{}: buffer view {}: {} bytes from byte {} of a buffer of {} bytes", file_.string(), index, length,
                  offset, buffer.size());
  return buffer.subspan(offset, length);
}

/// `place`: an accessor, or indices or values of a sparse one; `component`: bytes of a number.
GltfNumbers::Elements GltfFile::elementsAt(std::size_t accessor, const Value& place, std::size_t count,
                                           std::size_t component, std::size_t width) const {
  const std::size_t index = indexOf(place.at("bufferView"), "bufferViews");
  const std::span<const std::uint8_t> view = bytesOfView(index);
  const std::size_t element = component * width, offset = wholeNumber(place, "byteOffset"),
                    given = wholeNumber(at("bufferViews", index), "byteStride"), stride = given > 0 ? given : element;
  if (stride < element || stride > 65536)
    throwBadInput("{}: buffer view {}: byteStride {} of elements of {} bytes", file_.string(), index, stride, element);
  if (count > view.size() || offset > view.size() || element + (count - 1) * stride > view.size() - offset)
    throwBadInput("{}: accessor {}: {} elements of {} bytes from byte {} of a buffer view of {} bytes", file_.string(),
                  accessor, count, stride, offset, view.size());
  return {view.subspan(offset), stride};
}

GltfNumbers GltfFile::numbers(std::size_t index, std::string_view types) const {
  const Value accessor = at("accessors", index);
  if (!accessor.json.is_object() || !accessor.has("type")) accessor.fail("an object with a type");
  constexpr std::pair<std::string_view, std::size_t> kWidths[] = {
      {"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT4", 16}};
  const std::string type = accessor.at("type").text();
  GltfNumbers numbers;
  for (const auto& [name, width] : kWidths)
    if (type == name && types.find(type) != std::string_view::npos) numbers.width = width;
  if (numbers.width == 0) accessor.at("type").fail(types);
  numbers.count = wholeNumber(accessor, "count");
  if (numbers.count == 0) throwBadInput("{}: accessor {}: no elements", file_.string(), index);
  const ComponentType component = componentTypeOf(accessor);
  numbers.componentType_ = component.code;
  numbers.normalized_ = accessor.has("normalized") && accessor.at("normalized").json == true && component.most > 0.0;
  if (accessor.has("bufferView"))
    numbers.elements_ = elementsAt(index, accessor, numbers.count, component.bytes, numbers.width);
  else if (numbers.count > kMostZeroElements)
    throwBadInput("{}: accessor {}: {} elements without a buffer view, at most {} are supported", file_.string(), index,
                  numbers.count, kMostZeroElements);

  if (!accessor.has("sparse")) return numbers;
  const Value sparse = accessor.at("sparse");
  for (const char* part : {"indices", "values"})
    if (!sparse.json.is_object() || !sparse.has(part) || !sparse.at(part).json.is_object() ||
        !sparse.at(part).has("bufferView"))
      sparse.fail("an object with indices and values, each of a bufferView");
  const std::size_t changed = wholeNumber(sparse, "count");
  if (changed == 0) return numbers;
  const ComponentType indexType = componentTypeOf(sparse.at("indices"));
  if (indexType.isSigned) sparse.at("indices").at("componentType").fail("5121, 5123 or 5125");
  const GltfNumbers::Elements places = elementsAt(index, sparse.at("indices"), changed, indexType.bytes, 1);
  numbers.replacements_ = elementsAt(index, sparse.at("values"), changed, component.bytes, numbers.width);
  for (std::size_t i = 0; i < changed; ++i) {
    const auto to = static_cast<std::size_t>(numberAt(places.bytes.data() + i * places.stride, indexType));
    if (to >= numbers.count)
      throwBadInput("{}: accessor {}: a sparse element {}, it holds {}", file_.string(), index, to, numbers.count);
    numbers.replaced_[to] = i;
  }
  return numbers;
}

double GltfNumbers::at(std::size_t element, std::size_t k) const {
  const Elements* from = &elements_;
  if (const auto found = replaced_.find(element); found != replaced_.end())
    from = &replacements_, element = found->second;
  if (from->bytes.empty()) return 0.0;
  for (const ComponentType& type : kComponentTypes) {
    if (type.code != componentType_) continue;
    const double value = numberAt(from->bytes.data() + element * from->stride + k * type.bytes, type);
    return normalized_ ? std::max(value / type.most, -1.0) : value;
  }
  return 0.0;
}

std::vector<std::uint32_t> GltfFile::indices(std::size_t index) const {
  const Value accessor = at("accessors", index);
  if (!accessor.json.is_object()) accessor.fail("an object {...}");
  if (componentTypeOf(accessor).isSigned) accessor.at("componentType").fail("5121, 5123 or 5125, as of indices");
  if (accessor.has("normalized") && accessor.at("normalized").json == true)
    accessor.at("normalized").fail("false, as of indices");
  const GltfNumbers read = numbers(index, "SCALAR");
  std::vector<std::uint32_t> result;
  result.reserve(read.count);
  for (std::size_t i = 0; i < read.count; ++i) result.push_back(static_cast<std::uint32_t>(read.at(i, 0)));
  return result;
}

}  // namespace lucerna
