// Wavefront OBJ. Source: "Advanced Visualizer Manual", appendix B1, Wavefront Technologies (object files).
// - Positions are read in double. Indices may refer to lines further down.
// - A file cut off is an error that names the line. Faces that name a normal or texture coordinate that the file does
//   not have are drawn without it, with a warning; those that name such a position are an error.
// - Colours after a position (v x y z r g b) are sRGB-encoded, of 0 to 1, or to 255 where one is above 1.
// - A mesh is what has one o or g, and one usemtl.
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/log.hpp"
#include "scene/mtl_file.hpp"
#include "scene/polygon_mesh.hpp"
#include "scene/text_lines.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

namespace lucerna {

namespace fs = std::filesystem;

namespace {

constexpr std::array<const char*, 3> kPartNames = {"v", "vt", "vn"};

/// Keywords without an effect on what is drawn: smoothing (normals are given or made), display hints.
constexpr std::string_view kNoEffect[] = {"s",  "mg",         "lod",       "bevel",  "c_interp", "d_interp",
                                          "vp", "shadow_obj", "trace_obj", "usemap", "maplib",   "csh"};

/// Indices of a face's vertex into v, vt, vn, from 0 up; -1: not given.
using Corner = std::array<int, 3>;

struct Group {
  std::string object, material;
  std::vector<Corner> corners;
  std::vector<std::size_t> ends;
};

class ObjReader {
 public:
  ObjReader(Scene& scene, std::string_view text) : scene_(scene), lines_(text, true), isEmpty_(text.empty()) {}

  void run() {
    if (isEmpty_) throwBadInput("{}: the file is empty", scene_.file.string());
    readLines();
    checkEnd();
    std::vector<PolygonMesh> meshes = makeMeshes();
    if (meshes.empty() && !positions_.empty())
      throwBadInput("{}: nothing to draw: positions ({}), points and lines ({}) alone, no face", scene_.file.string(),
                    positions_.size(), others_);
    warn();
    appendPolygons(scene_, std::move(meshes));
  }

 private:
  // ---------------------------------------------------------------------------------------------------------------
  // Lines

  void readLines() {
    std::string object, material;
    std::map<std::pair<std::string, std::string>, std::size_t> known;
    std::size_t group = 0;
    bool chosen = false;
    while (lines_.next()) {
      const std::string_view keyword = lines_.word();
      if (keyword.empty() || keyword[0] == '#') continue;
      lastPart_ = -1;
      if (keyword == "v") position();
      else if (keyword == "vt") textureCoordinate();
      else if (keyword == "vn") normal();
      else if (keyword == "f" || keyword == "fo") {
        if (!chosen) {
          const auto [place, isNew] = known.try_emplace({object, material}, groups_.size());
          if (isNew) groups_.push_back({object, material, {}, {}});
          group = place->second;
          chosen = true;
        }
        face(groups_[group]);
      } else if (keyword == "usemtl") {
        material = lines_.rest();
        chosen = false;
      } else if (keyword == "o" || keyword == "g") {
        object = lines_.rest();
        chosen = false;
      } else if (keyword == "mtllib") libraries_.emplace_back(lines_.rest());
      else if (keyword == "p" || keyword == "l") ++others_;
      else if (std::find(std::begin(kNoEffect), std::end(kNoEffect), keyword) == std::end(kNoEffect))
        ignored_.emplace(keyword.substr(0, 40));
    }
  }

  /// Numbers up to the line's end or a comment; returns how many.
  template <std::size_t kMost>
  std::size_t numbers(const char* keyword, std::size_t least, std::array<double, kMost>& to) {
    std::size_t count = 0;
    for (std::string_view text = lines_.word(); !text.empty() && text[0] != '#'; text = lines_.word()) {
      if (count == kMost) break;
      const std::optional<double> value = numberIn(text);
      if (!value) fail(fmt::format("'{}' in a {} line, expected a number", text, keyword));
      to[count++] = *value;
    }
    if (count < least)
      fail(fmt::format("{} has {} numbers, expected {}; is the file truncated?", keyword, count, least));
    return count;
  }

  void position() {
    std::array<double, 7> n{};
    const std::size_t count = numbers("v", 3, n);
    positions_.emplace_back(n[0], n[1], n[2]);
    if (count >= 6) {
      colours_.resize(positions_.size() - 1, glm::vec3(1.0f));
      colours_.emplace_back(n[3], n[4], n[5]);
    }
    defined(0);
  }
  void textureCoordinate() {
    std::array<double, 3> n{};
    numbers("vt", 1, n);
    texCoords_.emplace_back(n[0], n[1]);
    defined(1);
  }
  void normal() {
    std::array<double, 3> n{};
    numbers("vn", 3, n);
    normals_.emplace_back(n[0], n[1], n[2]);
    defined(2);
  }
  void defined(int part) {
    lastPart_ = part;
    cutOff_ = lines_.isCutOff();
    lastLine_ = lines_.line();
  }

  std::size_t countOf(std::size_t part) const {
    return part == 0 ? positions_.size() : part == 1 ? texCoords_.size() : normals_.size();
  }

  Corner corner(std::string_view text) {
    Corner corner{-1, -1, -1};
    const char* next = text.data();
    const char* const end = text.data() + text.size();
    for (std::size_t part = 0; part < 3 && next < end; ++part) {
      if (*next != '/') {
        int index = 0;
        const auto [stop, error] = std::from_chars(next, end, index);
        if (error != std::errc() || index == 0 || (stop != end && *stop != '/'))
          fail(fmt::format("'{}' in a face, expected index, index/index or index/index/index from 1 up or from -1 down",
                           text));
        const auto count = static_cast<long>(countOf(part));
        if (index > 0) corner[part] = index - 1;
        else if (index >= -count) corner[part] = static_cast<int>(count + index);
        else if (part == 0)
          fail(fmt::format("a face refers to {} number {}, only {} come before it", kPartNames[part], index, count));
        else missing_[part] = true;
        if (corner[part] >= highest_[part]) {
          highest_[part] = corner[part] + 1;
          highestLine_[part] = lines_.line();
        }
        next = stop;
      }
      if (next < end) ++next;  // the slash
    }
    if (next < end || corner[0] < 0)
      fail(fmt::format("'{}' in a face, expected index, index/index or index/index/index", text));
    return corner;
  }

  void face(Group& group) {
    const std::size_t begin = group.corners.size();
    for (std::string_view text = lines_.word(); !text.empty() && text[0] != '#'; text = lines_.word()) {
      group.corners.push_back(corner(text));
      const auto given = [](const Corner& c) { return std::pair(c[1] >= 0, c[2] >= 0); };
      if (given(group.corners.back()) != given(group.corners[begin]) && lines_.isCutOff())
        fail(fmt::format("the file ends within a face, at '{}'", text));
    }
    const std::size_t count = group.corners.size() - begin;
    if (count >= 3) return group.ends.push_back(group.corners.size());
    // Elsewhere such faces are merely useless; at the very end they indicate a truncated file.
    if (lines_.isCutOff()) fail(fmt::format("the file ends within a face: {} vertices, expected at least 3", count));
    group.corners.resize(begin);
    ++others_;
  }

  void checkEnd() const {
    // Vertices come before the faces that use them.
    if (lastPart_ >= 0 && cutOff_) {
      const auto part = static_cast<std::size_t>(lastPart_);
      if (highest_[part] < static_cast<int>(countOf(part)))
        throwBadInput("{}:{}: the file ends within its vertices: it is cut off", scene_.file.string(), lastLine_);
    }
    if (highest_[0] > static_cast<int>(positions_.size()))
      throwBadInput("{}:{}: a face refers to v number {}, the file holds {}; is it cut off?", scene_.file.string(),
                    highestLine_[0], highest_[0], positions_.size());
  }

  [[noreturn]] void fail(const std::string& what) const {
    throwBadInput("{}:{}: {}", scene_.file.string(), lines_.line(), what);
  }

  // ---------------------------------------------------------------------------------------------------------------
  // Materials

  /// The files that a line mtllib names: one whose name may contain blanks, or several, each perhaps in quotes.
  std::vector<fs::path> filesOf(std::string_view names) {
    std::vector<std::string> words;
    for (std::size_t at = 0; at < names.size();) {
      if (names[at] == ' ' || names[at] == '\t') {
        ++at;
        continue;
      }
      const bool quoted = names[at] == '"' && names.find('"', at + 1) != std::string_view::npos;
      const std::size_t end = std::min(quoted ? names.find('"', at + 1) : names.find_first_of(" \t", at), names.size());
      words.emplace_back(names.substr(at + quoted, end - at - quoted));
      at = end + quoted;
    }
    std::vector<fs::path> files;
    for (std::size_t i = 0; i < words.size();) {
      std::size_t count = words.size() - i;  // as many words as make a name
      std::optional<fs::path> found;
      for (; count > 0 && !found; count -= !found) {
        std::string name = words[i];
        for (std::size_t k = 1; k < count; ++k) name += " " + words[i + k];
        found = existing(name);
      }
      if (found) files.push_back(*found);
      else missingLibraries_.push_back(words[i]);
      i += std::max<std::size_t>(count, 1);
    }
    return files;
  }

  std::optional<fs::path> existing(const std::string& name) const {
    const fs::path file = fileBeside(scene_.file, name);
    std::error_code error;
    return fs::is_regular_file(file, error) ? std::optional(file) : std::nullopt;
  }

  void readLibraries() {
    std::set<fs::path> read;
    for (const std::string& names : libraries_)
      for (const fs::path& file : filesOf(names)) {
        if (!read.insert(file).second) continue;
        readLibrary(file);
      }
    // Exporters rename libraries.
    const fs::path beside = fs::path(scene_.file).replace_extension(".mtl");
    std::error_code error;
    if (!read.empty() || missingLibraries_.empty() || !fs::is_regular_file(beside, error)) return;
    insteadOf_ = beside;
    readLibrary(beside);
  }

  /// Of two materials of one name the first counts.
  void readLibrary(const fs::path& file) {
    for (const MtlMaterial& material : readMtl(textOf(file, readFileBytes(file)), ignoredOf_[file]))
      materials_.try_emplace(material.name, material, file);
  }

  // ---------------------------------------------------------------------------------------------------------------
  // Meshes

  std::vector<PolygonMesh> makeMeshes() {
    readLibraries();
    colours_.resize(colours_.empty() ? 0 : positions_.size(), glm::vec3(1.0f));
    decodeColours();
    TextureLoader textures(scene_, [](const std::string&, const fs::path&) { return std::nullopt; });
    std::map<std::pair<std::string, bool>, int> known;
    std::vector<PolygonMesh> meshes;
    for (Group& group : groups_) {
      if (group.ends.empty()) continue;
      PolygonMesh& mesh = meshes.emplace_back();
      mesh.name = group.object.empty() ? group.material : group.object;
      const auto found = materials_.find(group.material);
      const MtlMaterial* const mtl = found == materials_.end() ? nullptr : &found->second.first;
      const bool coloured =
          !colours_.empty() && std::any_of(group.corners.begin(), group.corners.end(), [&](const Corner& c) {
            return colours_[static_cast<std::size_t>(c[0])] != glm::vec3(1.0f);
          });
      const auto [place, isNew] =
          known.try_emplace({group.material, coloured}, static_cast<int>(scene_.materials.size()));
      mesh.material = place->second;
      if (isNew) {
        if (mtl) scene_.materials.push_back(materialOf(*mtl, textures, ignoredOf_[found->second.second]));
        else scene_.materials.push_back(defaultMaterial(group.material, coloured));
      }
      fill(mesh, group, mtl ? leadingPicture(*mtl) : MtlPicture{}, coloured);
      group = {};  // memory
    }
    return meshes;
  }

  /// Vertex colours are the colour of what has no material.
  Material defaultMaterial(const std::string& name, bool coloured) {
    if (!name.empty()) unknown_.insert(name);
    Material material;
    material.name = name.empty() ? "DefaultMaterial" : name;
    material.diffuse = glm::vec3(coloured ? 1.0f : kDefaultAlbedo);
    return material;
  }

  void fill(PolygonMesh& mesh, const Group& group, const MtlPicture& picture, bool coloured) {
    const auto any = [&](std::size_t part) {
      return std::any_of(group.corners.begin(), group.corners.end(), [&](const Corner& c) { return c[part] >= 0; });
    };
    const bool hasTexCoords = any(1), hasNormals = any(2);
    for (const Corner& c : group.corners) {
      const auto v = static_cast<std::size_t>(c[0]);
      mesh.corners.push_back(static_cast<unsigned>(mesh.positions.size()));
      mesh.positions.push_back(positions_[v]);
      if (coloured) mesh.colours.push_back(colours_[v]);
      if (hasTexCoords) {
        const glm::dvec2* const uv = at(texCoords_, c[1], 1);
        mesh.texCoords.emplace_back(uv ? picture.scale * *uv + picture.offset : glm::dvec2(0.0));
      }
      if (hasNormals) {
        const glm::vec3* const normal = at(normals_, c[2], 2);
        mesh.normals.push_back(normal ? *normal : glm::vec3(0.0f));
      }
    }
    mesh.ends = group.ends;
  }

  template <class T>
  const T* at(const std::vector<T>& values, int index, std::size_t part) {
    if (index >= 0 && static_cast<std::size_t>(index) < values.size()) return &values[static_cast<std::size_t>(index)];
    missing_[part] = missing_[part] || index >= 0;
    return nullptr;
  }

  void decodeColours() {
    const bool bytes = std::any_of(colours_.begin(), colours_.end(), [](const glm::vec3& c) {
      return std::max({c.x, c.y, c.z}) > 1.0f;
    });
    for (glm::vec3& colour : colours_)
      for (int c = 0; c < 3; ++c)
        colour[c] = linearFromSrgb(clampedNumber(bytes ? colour[c] / 255.0f : colour[c], 0.0f, 1.0f, 1.0f));
  }

  // ---------------------------------------------------------------------------------------------------------------
  // What could not be read

  void warn() const {
    const std::string file = scene_.file.string();
    std::string lacks;
    if (!missingLibraries_.empty())
      lacks = fmt::format("material library {} is missing", fmt::join(missingLibraries_, ", "));
    if (!insteadOf_.empty()) lacks += fmt::format("; using {}", insteadOf_.filename().string());
    if (!unknown_.empty())
      lacks += fmt::format("{}no library has material {}", lacks.empty() ? "" : "; ", listed(unknown_));
    if (!lacks.empty())
      logWarning("{}: {}{}", file, lacks, insteadOf_.empty() || !unknown_.empty() ? "; using default materials" : "");
    if (missing_[1]) logWarning("{}: faces refer to texture coordinates (vt) that it does not hold; using 0 0", file);
    if (missing_[2]) logWarning("{}: faces refer to normals (vn) that it does not hold; they are computed", file);
    if (!ignored_.empty()) logWarning("{}: not read: {}", file, listed(ignored_));
    for (const auto& [library, ignored] : ignoredOf_)
      if (!ignored.empty()) logWarning("{}: not read: {}", library.string(), listed(ignored));
  }

  static std::string listed(const std::set<std::string>& names) {
    constexpr std::size_t kMost = 12;
    std::string list;
    std::size_t count = 0;
    for (const std::string& name : names) {
      if (++count > kMost) return fmt::format("{} and {} more", list, names.size() - kMost);
      list += (list.empty() ? "" : ", ") + name;
    }
    return list;
  }

  Scene& scene_;
  TextLines lines_;
  bool isEmpty_;
  std::vector<glm::dvec3> positions_;
  std::vector<glm::vec3> colours_;  ///< empty, or one a position
  std::vector<glm::dvec2> texCoords_;
  std::vector<glm::vec3> normals_;
  std::vector<Group> groups_;
  std::vector<std::string> libraries_, missingLibraries_;
  fs::path insteadOf_;  ///< the library that is read instead of missing ones
  std::map<std::string, std::pair<MtlMaterial, fs::path>, std::less<>> materials_;
  std::map<fs::path, std::set<std::string>> ignoredOf_;  ///< of each library
  std::set<std::string> ignored_, unknown_;
  std::array<int, 3> highest_{}, highestLine_{};  ///< highest index from 1 up in any face, and its line
  std::array<bool, 3> missing_{};
  std::size_t others_ = 0;  ///< points, lines, and faces of fewer than three vertices
  int lastPart_ = -1;  ///< defined by the last line, among v, vt, vn; -1: something else
  int lastLine_ = 0;  ///< the number of that line
  bool cutOff_ = false;
};

}  // namespace

void readObj(Scene& scene, std::span<const std::uint8_t> content) {
  ObjReader(scene, textOf(scene.file, content)).run();
}

}  // namespace lucerna
