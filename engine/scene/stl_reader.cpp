// Stereolithography (STL). Source: 3D Systems, "StereoLithography Interface Specification", 1989; colours in the
// attribute of binary facets as Materialise Magics (a header with COLOR=) and VisCAM write them.
// A file is binary if its length is that of its count of facets, whatever it begins with: many begin with "solid".
#include "base/error.hpp"
#include "base/files.hpp"
#include "scene/polygon_mesh.hpp"
#include "scene/text_lines.hpp"

#include <bit>

namespace lucerna {

namespace {

constexpr std::size_t kHeader = 80, kFacets = kHeader + 4, kFacet = 50;

std::uint32_t wordAt(std::span<const std::uint8_t> bytes, std::size_t at) {
  return std::uint32_t{bytes[at]} | std::uint32_t{bytes[at + 1]} << 8 | std::uint32_t{bytes[at + 2]} << 16 |
         std::uint32_t{bytes[at + 3]} << 24;
}

glm::vec3 vectorAt(std::span<const std::uint8_t> bytes, std::size_t at) {
  return {std::bit_cast<float>(wordAt(bytes, at)), std::bit_cast<float>(wordAt(bytes, at + 4)),
          std::bit_cast<float>(wordAt(bytes, at + 8))};
}

glm::vec3 linear(float r, float g, float b) { return {linearFromSrgb(r), linearFromSrgb(g), linearFromSrgb(b)}; }

void add(PolygonMesh& mesh, const glm::dvec3& position, const glm::vec3& normal) {
  mesh.corners.push_back(static_cast<unsigned>(mesh.positions.size()));
  mesh.positions.push_back(position);
  mesh.normals.push_back(normal);
}

PolygonMesh readBinary(std::span<const std::uint8_t> bytes, std::size_t count) {
  PolygonMesh mesh;
  const std::string_view header(reinterpret_cast<const char*>(bytes.data()), kHeader);
  const std::size_t whole = header.find("COLOR=");
  const bool magics = whole != std::string_view::npos && whole + 10 <= kHeader;
  const auto byte = [&](std::size_t i) { return static_cast<float>(bytes[whole + 6 + i]) / 255.0f; };
  const glm::vec3 colourOfAll = magics ? linear(byte(0), byte(1), byte(2)) : glm::vec3(kDefaultAlbedo);
  bool coloured = magics;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = kFacets + kFacet * i;
    const glm::vec3 normal = vectorAt(bytes, at);
    for (std::size_t k = 1; k <= 3; ++k) add(mesh, glm::dvec3(vectorAt(bytes, at + 12 * k)), normal);
    mesh.endFace();
    const unsigned attribute = bytes[at + 48] | unsigned{bytes[at + 49]} << 8;
    const auto channel = [&](int shift) { return static_cast<float>(attribute >> shift & 31u) / 31.0f; };
    const bool own = (attribute >> 15 != 0) != magics;
    coloured |= own;
    const glm::vec3 colour = !own     ? colourOfAll
                             : magics ? linear(channel(0), channel(5), channel(10))
                                      : linear(channel(10), channel(5), channel(0));
    mesh.colours.insert(mesh.colours.end(), 3, colour);
  }
  if (!coloured) mesh.colours.clear();
  return mesh;
}

PolygonMesh readText(const std::filesystem::path& file, std::span<const std::uint8_t> bytes) {
  PolygonMesh mesh;
  const std::string content = textOf(file, bytes);
  TextLines lines(content);
  glm::vec3 normal(0.0f);
  bool inFacet = false;
  const auto fail = [&](std::string_view what) { throwBadInput("{}:{}: {}", file.string(), lines.line(), what); };
  const auto vector = [&] {
    glm::dvec3 v;
    for (int k = 0; k < 3; ++k) {
      const std::string_view word = lines.word();
      const std::optional<double> number = numberIn(word);
      if (!number) fail(fmt::format("'{}', expected a number", word));
      v[k] = *number;
    }
    return v;
  };
  std::size_t first = 0;
  while (lines.next()) {
    for (std::string_view read = lines.word(); !read.empty(); read = lines.word()) {
      const std::string word = lowerCase(read);
      if (word == "solid" || word == "endsolid") {
        if (mesh.name.empty()) mesh.name = lines.rest();
        else static_cast<void>(lines.rest());
      } else if (word == "facet") {
        inFacet = true;
        first = mesh.corners.size();
      } else if (word == "normal") {
        normal = glm::vec3(vector());
      } else if (word == "vertex") {
        if (!inFacet) fail("a vertex outside of a facet");
        add(mesh, vector(), normal);
      } else if (word == "endfacet") {
        if (mesh.corners.size() < first + 3) fail("a facet of fewer than three vertices");
        mesh.endFace();
        inFacet = false;
        normal = glm::vec3(0.0f);
      } else if (word != "outer" && word != "loop" && word != "endloop") {
        fail(fmt::format("'{}', expected a facet", read.substr(0, 40)));
      }
    }
  }
  if (inFacet) fail("the file ends within a facet: it is cut off");
  return mesh;
}

}  // namespace

void readStl(Scene& scene, std::span<const std::uint8_t> content) {
  const std::size_t count = content.size() >= kFacets ? wordAt(content, kHeader) : 0,
                    held = content.size() >= kFacets ? (content.size() - kFacets) / kFacet : 0;
  const std::string_view text(reinterpret_cast<const char*>(content.data()), content.size());
  const std::size_t begin = std::min(text.find_first_not_of(" \t\r\n"), text.size());
  const bool isUtf16 = text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff");
  const bool isText = isUtf16 || ((lowerCase(text.substr(begin, 5)) == "solid" || text.starts_with("\xef\xbb\xbf")) &&
                                  text.find('\0') == std::string_view::npos);
  const bool isBinary = count == held && kFacets + kFacet * held == content.size();
  if (!isText && !isBinary && (content.size() < kFacets || count > held))
    throwBadInput("{}: {} facets, its bytes hold {}: it is cut off, or no STL", scene.file.string(), count, held);
  PolygonMesh mesh = isBinary || !isText ? readBinary(content, count) : readText(scene.file, content);
  Material material;
  material.name = "DefaultMaterial";
  material.diffuse = glm::vec3(mesh.colours.empty() ? kDefaultAlbedo : 1.0f);
  scene.materials.push_back(std::move(material));
  std::vector<PolygonMesh> meshes;
  meshes.push_back(std::move(mesh));
  appendPolygons(scene, std::move(meshes));
}

}  // namespace lucerna
