// Polygon File Format (PLY), led by its header. Source: G. Turk, "The PLY polygon file format", 1994; texture
// coordinates of faces and "comment TextureFile" as MeshLab writes them; tristrips as Stanford's vrip does.
// - Elements are read in the order of the header, whatever they are; other than vertex, face and tristrips their values
//   are skipped, with a warning.
// - Integer colours are of their type's range; all colours are sRGB-encoded, as scanners write them.
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/log.hpp"
#include "scene/polygon_mesh.hpp"
#include "scene/text_lines.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

namespace lucerna {

namespace {

enum class Format { ascii, little, big };

struct Type {
  std::size_t bytes = 0;
  bool isFloat = false, isSigned = false;
  double highest = 1.0;  ///< what a colour of 1 is written as
};

std::optional<Type> typeOf(std::string_view name) {
  static constexpr std::pair<std::string_view, int> kNames[] = {
      {"char", 0},   {"int8", 0},    {"uchar", 1}, {"uint8", 1}, {"short", 2},  {"int16", 2}, {"ushort", 3},
      {"uint16", 3}, {"int", 4},     {"int32", 4}, {"uint", 5},  {"uint32", 5}, {"float", 6}, {"float32", 6},
      {"double", 7}, {"float64", 7}, {"long", 4},  {"ulong", 5}, {"int64", 8},  {"uint64", 9}};
  static constexpr Type kTypes[] = {{1, false, true, 127.0},
                                    {1, false, false, 255.0},
                                    {2, false, true, 32767.0},
                                    {2, false, false, 65535.0},
                                    {4, false, true, 2147483647.0},
                                    {4, false, false, 4294967295.0},
                                    {4, true, true, 1.0},
                                    {8, true, true, 1.0},
                                    {8, false, true, 9.2233720368e18},
                                    {8, false, false, 1.8446744074e19}};
  for (const auto& [known, index] : kNames)
    if (known == name) return kTypes[index];
  return std::nullopt;
}

struct Property {
  std::string name;
  Type type;
  std::optional<Type> count;  ///< of a list
};

struct Element {
  std::string name;
  std::size_t count = 0;
  std::vector<Property> properties;

  int find(std::initializer_list<std::string_view> names) const {
    for (const std::string_view wanted : names)
      for (std::size_t i = 0; i < properties.size(); ++i)
        if (properties[i].name == wanted) return static_cast<int>(i);
    return -1;
  }
};

class PlyReader {
 public:
  PlyReader(Scene& scene, std::span<const std::uint8_t> bytes) : scene_(scene), bytes_(bytes) {}

  void run() {
    readHeader();
    for (const Element& element : elements_) {
      if (element.name == "vertex") readVertices(element);
      else if (element.name == "face") readFaces(element);
      else if (element.name == "tristrips") readStrips(element);
      else skip(element);
    }
    if (mesh_.ends.empty())
      throwBadInput("{}: nothing to draw: {}", file(),
                    mesh_.positions.empty() ? std::string("no vertices")
                                            : fmt::format("points alone ({}), no face", mesh_.positions.size()));
    for (const unsigned v : mesh_.corners)
      if (v >= mesh_.positions.size())
        throwBadInput("{}: a face refers to vertex {}, the file holds {}; is it cut off?", file(), v,
                      mesh_.positions.size());
    if (!skipped_.empty()) logWarning("{}: not read: element {}", file(), skipped_);
    addMeshes();
  }

 private:
  // ---------------------------------------------------------------------------------------------------------------
  // Header

  void readHeader() {
    const std::string_view all(reinterpret_cast<const char*>(bytes_.data()), bytes_.size());
    TextLines lines(all);
    if (!lines.next() || lines.word() != "ply") fail("no PLY file: it does not begin with 'ply'");
    bool ended = false;
    while (!ended && lines.next()) {
      const std::string_view keyword = lines.word();
      if (keyword == "format") {
        const std::string_view format = lines.word();
        if (format == "ascii") format_ = Format::ascii;
        else if (format == "binary_little_endian") format_ = Format::little;
        else if (format == "binary_big_endian") format_ = Format::big;
        else fail(fmt::format("'format {}', expected ascii, binary_little_endian or binary_big_endian", format));
      } else if (keyword == "element") {
        Element& element = elements_.emplace_back();
        element.name = lines.word();
        const std::string_view count = lines.word();
        const auto [stop, error] = std::from_chars(count.data(), count.data() + count.size(), element.count);
        if (error != std::errc() || stop != count.data() + count.size())
          fail(fmt::format("element {} has the count '{}'", element.name, count));
      } else if (keyword == "property") {
        property(lines);
      } else if (keyword == "comment") {
        if (lines.word() == "TextureFile") pictures_.emplace_back(lines.rest());
      } else if (keyword == "end_header") {
        ended = true;
      }  // else obj_info, or a comment that lacks its keyword
    }
    if (!ended) fail("its header has no end_header; is it cut off?");
    // One line end of the header's kind, not more: the first value may begin with such a byte.
    at_ = all.find_first_of("\r\n", lines.position());
    if (at_ == std::string_view::npos) at_ = all.size();
    const bool pairs = all.substr(3, 2) == "\r\n";
    at_ = std::min(at_ + (pairs && all.substr(at_, 2) == "\r\n" ? 2 : 1), all.size());
  }

  void property(TextLines& lines) {
    if (elements_.empty()) fail("a property before any element");
    Property& property = elements_.back().properties.emplace_back();
    const auto type = [&] {
      const std::string_view name = lines.word();
      const std::optional<Type> known = typeOf(name);
      if (!known) fail(fmt::format("a property of the type '{}'", name));
      return *known;
    };
    std::string_view first = lines.word();
    if (first == "list") {
      property.count = type();
      property.type = type();
    } else {
      const std::optional<Type> known = typeOf(first);
      if (!known) fail(fmt::format("a property of the type '{}'", first));
      property.type = *known;
    }
    property.name = lines.word();
  }

  // ---------------------------------------------------------------------------------------------------------------
  // Values

  double value(const Type& type) {
    if (format_ == Format::ascii) {
      const auto isBlank = [](std::uint8_t c) { return c == ' ' || (c >= '\t' && c <= '\r'); };
      while (at_ < bytes_.size() && isBlank(bytes_[at_])) ++at_;
      const std::size_t begin = at_;
      while (at_ < bytes_.size() && !isBlank(bytes_[at_])) ++at_;
      const std::string_view text(reinterpret_cast<const char*>(bytes_.data()) + begin, at_ - begin);
      if (text.empty()) throwCutOff();
      const std::optional<double> number = numberIn(text);
      if (!number) fail(fmt::format("'{}' in element {}, expected a number", text.substr(0, 40), inElement_));
      return *number;
    }
    if (type.bytes > bytes_.size() - at_) throwCutOff();
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < type.bytes; ++i)
      bits |= std::uint64_t{bytes_[at_ + i]} << 8 * (format_ == Format::little ? i : type.bytes - 1 - i);
    at_ += type.bytes;
    if (type.isFloat)
      return type.bytes == 4 ? static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(bits)))
                             : std::bit_cast<double>(bits);
    const int unused = 64 - 8 * static_cast<int>(type.bytes);
    if (type.isSigned) return static_cast<double>(static_cast<std::int64_t>(bits << unused) >> unused);
    return static_cast<double>(bits);
  }

  /// One element's values; those of property i to row_[i], a list or a single one.
  void readRow(const Element& element) {
    row_.resize(element.properties.size());
    for (std::size_t i = 0; i < row_.size(); ++i) {
      const Property& property = element.properties[i];
      row_[i].clear();
      double count = 1.0;
      if (property.count) count = value(*property.count);
      if (!(count >= 0.0) || count > static_cast<double>(bytes_.size()))
        fail(fmt::format("a list {} of {} values in element {}", property.name, count, element.name));
      for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k) row_[i].push_back(value(property.type));
    }
  }

  /// Whether to read its rows. An element without properties takes no bytes.
  bool begin(const Element& element) {
    inElement_ = element.name;
    return !element.properties.empty();
  }

  double number(int property) const {
    const std::vector<double>& values = row_[static_cast<std::size_t>(property)];
    return values.empty() ? 0.0 : values[0];
  }

  /// sRGB-encoded to linear.
  glm::vec3 colour(const Element& element, const std::array<int, 3>& properties) const {
    glm::vec3 read;
    for (int c = 0; c < 3; ++c) {
      const int property = properties[static_cast<std::size_t>(c)];
      const double encoded = number(property) / element.properties[static_cast<std::size_t>(property)].type.highest;
      read[c] = linearFromSrgb(clampedNumber(static_cast<float>(encoded), 0.0f, 1.0f, 1.0f));
    }
    return read;
  }

  static std::array<int, 3> colourOf(const Element& element) {
    std::array<int, 3> found = {element.find({"red", "r", "diffuse_red"}),
                                element.find({"green", "g", "diffuse_green"}),
                                element.find({"blue", "b", "diffuse_blue"})};
    return found[0] >= 0 && found[1] >= 0 && found[2] >= 0 ? found : std::array<int, 3>{-1, -1, -1};
  }

  void readVertices(const Element& element) {
    const int x = element.find({"x"}), y = element.find({"y"}), z = element.find({"z"});
    if (x < 0 || y < 0 || z < 0) fail("its vertices have no x, y and z");
    const int nx = element.find({"nx"}), ny = element.find({"ny"}), nz = element.find({"nz"});
    const int s = element.find({"s", "u", "texture_u", "texture_s"}),
              t = element.find({"t", "v", "texture_v", "texture_t"});
    const std::array<int, 3> colours = colourOf(element);
    if (!begin(element)) return;
    for (std::size_t i = 0; i < element.count; ++i) {
      readRow(element);
      mesh_.positions.emplace_back(number(x), number(y), number(z));
      if (nx >= 0 && ny >= 0 && nz >= 0) mesh_.normals.emplace_back(number(nx), number(ny), number(nz));
      if (s >= 0 && t >= 0) mesh_.texCoords.emplace_back(number(s), number(t));
      if (colours[0] >= 0) mesh_.colours.push_back(colour(element, colours));
    }
  }

  unsigned index(double value) const {
    if (!(value >= 0.0 && value < 4294967295.0)) fail(fmt::format("a face refers to vertex {}", value));
    return static_cast<unsigned>(value);
  }

  void readFaces(const Element& element) {
    const int list = element.find({"vertex_indices", "vertex_index"}), texCoords = element.find({"texcoord"}),
              picture = element.find({"texnumber"});
    const std::array<int, 3> colours = colourOf(element);
    if (list < 0) fail("its faces have no list vertex_indices");
    if (!begin(element)) return;
    for (std::size_t i = 0; i < element.count; ++i) {
      readRow(element);
      const std::vector<double>& vertices = row_[static_cast<std::size_t>(list)];
      if (vertices.size() < 3) continue;
      for (const double v : vertices) mesh_.corners.push_back(index(v));
      mesh_.endFace();
      if (texCoords >= 0) {
        const std::vector<double>& uv = row_[static_cast<std::size_t>(texCoords)];
        for (std::size_t k = 0; k < vertices.size(); ++k)
          cornerTexCoords_.push_back(2 * k + 1 < uv.size() ? glm::vec2(uv[2 * k], uv[2 * k + 1]) : glm::vec2(0.0f));
      }
      if (colours[0] >= 0) cornerColours_.resize(mesh_.corners.size(), colour(element, colours));
      if (picture >= 0) pictureOfFace_.push_back(number(picture));
    }
  }

  /// Strips of triangles one after another, apart by an index of -1; every other triangle is wound backwards.
  void readStrips(const Element& element) {
    const int list = element.find({"vertex_indices", "vertex_index"});
    if (list < 0) fail("its tristrips have no list vertex_indices");
    if (!begin(element)) return;
    for (std::size_t i = 0; i < element.count; ++i) {
      readRow(element);
      const std::vector<double>& strip = row_[static_cast<std::size_t>(list)];
      std::size_t length = 0;
      for (std::size_t k = 0; k < strip.size(); ++k) {
        length = strip[k] < 0.0 ? 0 : length + 1;
        if (length < 3) continue;
        const std::size_t swap = length % 2 == 0 ? 1 : 0;
        for (const std::size_t v : {k - 2 + swap, k - 1 - swap, k}) mesh_.corners.push_back(index(strip[v]));
        const std::size_t n = mesh_.corners.size();
        const bool thin = mesh_.corners[n - 3] == mesh_.corners[n - 2] ||
                          mesh_.corners[n - 2] == mesh_.corners[n - 1] || mesh_.corners[n - 3] == mesh_.corners[n - 1];
        if (thin) mesh_.corners.resize(n - 3);  // it only turns the strip
        else mesh_.endFace();
      }
    }
  }

  void skip(const Element& element) {
    if (element.count == 0) return;
    skipped_ += (skipped_.empty() ? "" : ", ") + element.name;
    if (!begin(element)) return;
    for (std::size_t i = 0; i < element.count; ++i) readRow(element);
  }

  // ---------------------------------------------------------------------------------------------------------------
  // Meshes

  /// One vertex a corner, where corners have values of their own.
  void separateCorners() {
    PolygonMesh to;
    to.ends = mesh_.ends;
    for (std::size_t i = 0; i < mesh_.corners.size(); ++i) {
      const unsigned v = mesh_.corners[i];
      to.corners.push_back(static_cast<unsigned>(i));
      to.positions.push_back(mesh_.positions[v]);
      if (!mesh_.normals.empty()) to.normals.push_back(mesh_.normals[v]);
      if (!cornerTexCoords_.empty()) to.texCoords.push_back(cornerTexCoords_[i]);
      else if (!mesh_.texCoords.empty()) to.texCoords.push_back(mesh_.texCoords[v]);
      if (!mesh_.colours.empty()) to.colours.push_back(mesh_.colours[v]);
      else if (!cornerColours_.empty()) to.colours.push_back(cornerColours_[i]);
    }
    mesh_ = std::move(to);
  }

  void addMeshes() {
    cornerTexCoords_.resize(cornerTexCoords_.empty() ? 0 : mesh_.corners.size(), glm::vec2(0.0f));
    cornerColours_.resize(cornerColours_.empty() ? 0 : mesh_.corners.size(), glm::vec3(1.0f));
    if (!cornerTexCoords_.empty() || (!cornerColours_.empty() && mesh_.colours.empty())) separateCorners();
    TextureLoader textures(scene_, [](const std::string&, const std::filesystem::path&) { return std::nullopt; });
    const auto material = [&](const std::string& picture) {
      Material m;
      m.name = picture.empty() ? "DefaultMaterial" : picture;
      m.diffuseTexture = mesh_.texCoords.empty() ? -1 : textures.albedo({picture});
      m.diffuse = glm::vec3(m.diffuseTexture >= 0 || !mesh_.colours.empty() ? 1.0f : kDefaultAlbedo);
      scene_.materials.push_back(std::move(m));
      return static_cast<int>(scene_.materials.size()) - 1;
    };
    // With its picture, a vertex colour is what remains of a scan where the picture has none.
    if (!pictures_.empty() && !mesh_.texCoords.empty()) mesh_.colours.clear();
    std::vector<PolygonMesh> meshes;
    if (pictures_.size() > 1 && pictureOfFace_.size() == mesh_.ends.size()) {
      for (std::size_t p = 0; p < pictures_.size(); ++p) {
        PolygonMesh part = mesh_;
        part.corners.clear(), part.ends.clear();
        for (std::size_t f = 0; f < mesh_.ends.size(); ++f) {
          const double chosen = pictureOfFace_[f];
          const bool isKnown = chosen >= 0.0 && chosen < static_cast<double>(pictures_.size());
          if ((isKnown ? static_cast<std::size_t>(chosen) : 0) != p) continue;
          const auto corner = [&](std::size_t i) { return mesh_.corners.begin() + static_cast<std::ptrdiff_t>(i); };
          part.corners.insert(part.corners.end(), corner(f == 0 ? 0 : mesh_.ends[f - 1]), corner(mesh_.ends[f]));
          part.endFace();
        }
        part.material = material(pictures_[p]);
        meshes.push_back(std::move(part));
      }
    } else {
      mesh_.material = material(pictures_.empty() ? std::string() : pictures_[0]);
      meshes.push_back(std::move(mesh_));
    }
    appendPolygons(scene_, std::move(meshes));
  }

  std::string file() const { return scene_.file.string(); }
  [[noreturn]] void fail(const std::string& what) const { throwBadInput("{}: {}", file(), what); }
  [[noreturn]] void throwCutOff() const { fail(fmt::format("it ends within element {}: it is cut off", inElement_)); }

  Scene& scene_;
  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0;
  Format format_ = Format::ascii;
  std::vector<Element> elements_;
  std::string inElement_, skipped_;
  std::vector<std::vector<double>> row_;
  std::vector<std::string> pictures_;
  std::vector<double> pictureOfFace_;  ///< which of them
  PolygonMesh mesh_;
  std::vector<glm::vec2> cornerTexCoords_;  ///< those that faces have; empty, or one a corner
  std::vector<glm::vec3> cornerColours_;
};

}  // namespace

void readPly(Scene& scene, std::span<const std::uint8_t> content) {
  const bool isUtf16 = content.size() >= 2 && (content[0] == 0xff || content[0] == 0xfe);
  const bool hasMark = content.size() >= 3 && content[0] == 0xef;
  if (isUtf16 || hasMark) {
    const std::string text = textOf(scene.file, content);
    PlyReader(scene, std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size())).run();
  } else {
    PlyReader(scene, content).run();
  }
}

}  // namespace lucerna
