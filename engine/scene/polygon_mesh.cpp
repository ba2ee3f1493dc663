#include "scene/polygon_mesh.hpp"

#include "base/log.hpp"
#include "scene/polygon.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <unordered_map>

namespace lucerna {

namespace {

const double kCosCrease = 0.5;  // 60 degrees between faces

// ------------------------------------------------------------------------------------------------------------------
// The offset

/// What to take off so that single precision keeps the meshes' detail; 0: nothing.
glm::dvec3 offsetOf(const std::vector<PolygonMesh>& meshes) {
  Bounds bounds;
  glm::dvec3 loss(0.0);  // largest rounding
  double edges = 0.0;  // sum of lengths
  std::size_t edgeCount = 0;
  for (const PolygonMesh& mesh : meshes) {
    std::size_t begin = 0;
    for (const std::size_t end : mesh.ends) {
      for (std::size_t i = begin; i < end; ++i) {
        const glm::dvec3& p = mesh.positions[mesh.corners[i]];
        const glm::dvec3& q = mesh.positions[mesh.corners[i + 1 < end ? i + 1 : begin]];
        const double edge = glm::length(q - p);
        if (!isFinite(glm::dvec3(glm::vec3(p))) || !std::isfinite(edge)) continue;
        bounds.add(p);
        loss = glm::max(loss, glm::abs(glm::dvec3(glm::vec3(p)) - p));
        edges += edge;
        ++edgeCount;
      }
      begin = end;
    }
  }
  glm::dvec3 offset(0.0);
  constexpr double kMostLoss = 1e-4;  // of the mean edge
  if (edgeCount == 0) return offset;
  // A round number for people, near the middle of the axes that are far off.
  const glm::dvec3 extent = bounds.extent(), centre = bounds.centre();
  const double size = std::max({extent.x, extent.y, extent.z, 1e-30}),
               step = std::pow(10.0, std::floor(std::log10(size)));
  for (int k = 0; k < 3; ++k)
    if (loss[k] > kMostLoss * edges / static_cast<double>(edgeCount) && std::abs(centre[k]) > 4.0 * size)
      offset[k] = std::round(centre[k] / step) * step;
  return offset;
}

// ------------------------------------------------------------------------------------------------------------------
// Normals

struct BitsHash {
  template <class Word, std::size_t kCount>
  std::size_t operator()(const std::array<Word, kCount>& words) const {
    std::uint64_t h = 0x9e3779b97f4a7c15u;
    for (const Word w : words) {
      h = (h ^ w) * 0xff51afd7ed558ccdu;
      h ^= h >> 32;
    }
    return static_cast<std::size_t>(h);
  }
};

bool isZero(const glm::vec3& v) { return v == glm::vec3(0.0f); }

/// Sets the normals of 0. `data` has a vertex for every corner of `mesh`.
void makeNormals(MeshData& data, const PolygonMesh& mesh) {
  const std::size_t count = mesh.corners.size();
  if (data.normals.empty()) data.normals.assign(count, glm::vec3(0.0f));
  if (std::none_of(data.normals.begin(), data.normals.end(), isZero)) return;

  struct Part {
    glm::dvec3 normal;  ///< of the corner's face, unit; 0 without area
    double angle;
  };
  std::vector<Part> parts(count);
  std::vector<glm::dvec3> face;
  std::size_t begin = 0;
  for (const std::size_t end : mesh.ends) {
    face.clear();
    for (std::size_t i = begin; i < end; ++i) face.push_back(mesh.positions[mesh.corners[i]]);
    const glm::dvec3 area = areaVector(face);
    const double length = glm::length(area);
    const bool usable = length > 0.0 && std::isfinite(length);
    const std::size_t n = face.size();
    for (std::size_t i = 0; i < n; ++i) {
      const glm::dvec3 to = face[(i + 1) % n] - face[i], from = face[(i + n - 1) % n] - face[i];
      const double angle = std::atan2(glm::length(glm::cross(to, from)), glm::dot(to, from));
      parts[begin + i] = {usable ? area / length : glm::dvec3(0.0), usable ? angle : 0.0};
    }
    begin = end;
  }

  // Corners of one position, as chains from its first vertex.
  constexpr std::uint32_t kNone = 0xffffffffu;
  std::vector<std::uint32_t> next(count, kNone), heads(mesh.positions.size(), kNone),
      firsts(mesh.positions.size(), kNone);
  std::unordered_map<std::array<std::uint32_t, 3>, std::uint32_t, BitsHash> known;
  known.reserve(mesh.positions.size());
  for (std::size_t i = 0; i < count; ++i) {
    std::uint32_t& first = firsts[mesh.corners[i]];
    if (first == kNone) {
      const glm::vec3 p = glm::vec3(data.positions[i]) + 0.0f;  // -0 is 0
      std::array<std::uint32_t, 3> bits;
      std::memcpy(bits.data(), &p, sizeof bits);
      first = known.try_emplace(bits, mesh.corners[i]).first->second;
    }
    next[i] = std::exchange(heads[first], static_cast<std::uint32_t>(i));
  }
  std::vector<std::uint32_t> around;
  for (const std::uint32_t head : heads) {
    if (head == kNone) continue;
    around.clear();
    glm::dvec3 all(0.0);
    for (std::uint32_t i = head; i != kNone; i = next[i]) {
      around.push_back(i);
      all += parts[i].angle * parts[i].normal;
    }
    constexpr std::size_t kMany = 1024;  // above, comparing all pairs takes too long
    for (const std::uint32_t i : around) {
      if (!isZero(data.normals[i])) continue;
      const glm::dvec3 own = parts[i].normal;
      glm::dvec3 sum(0.0);
      if (own == glm::dvec3(0.0)) sum = all;
      else if (around.size() > kMany) sum = glm::dot(own, all) >= kCosCrease * glm::length(all) ? all : own;
      else
        for (const std::uint32_t j : around)
          if (glm::dot(own, parts[j].normal) >= kCosCrease) sum += parts[j].angle * parts[j].normal;
      const double length = glm::length(sum);
      if (length > 0.0) data.normals[i] = glm::vec3(sum / length);
    }
  }
}

// ------------------------------------------------------------------------------------------------------------------
// Colours

std::uint8_t encoded(float linear) {
  return static_cast<std::uint8_t>(std::lround(255.0f * srgbFromLinear(std::clamp(linear, 0.0f, 1.0f))));
}

/// A picture with a square block of texels for each triangle: the plane through its corners' colours, a + (b - a) x +
/// (c - a) y. Interpolation between texels keeps it, but for texels beyond the triangle's third side whose colour
/// leaves 0..1; the larger the block, the less they count.
class ColourPicture {
 public:
  /// The block for a triangle.
  std::uint32_t add(const std::array<glm::vec3, 3>& colours) {
    Block block;
    for (std::size_t k = 0; k < 9; ++k) block[k] = encoded(colours[k / 3][static_cast<int>(k % 3)]);
    const auto [known, isNew] = index_.try_emplace(block, static_cast<std::uint32_t>(blocks_.size()));
    if (isNew) blocks_.push_back(block);
    return known->second;
  }
  bool empty() const { return blocks_.empty(); }
  /// Whether that many triangles more have a place.
  bool takes(std::size_t triangles) const { return blocks_.size() + triangles <= kMost; }

  /// Texture coordinates of a triangle's corners, once all are there.
  std::array<glm::vec2, 3> texCoords(std::uint32_t block) const {
    const glm::dvec2 size(bitmapSize()), at = glm::dvec2(cornerOf(block)) + 0.5;
    const auto place = [&](const glm::dvec2& p) { return glm::vec2(p.x / size.x, 1.0 - p.y / size.y); };
    const double last = blockSize() - 1;
    return {place(at), place(at + glm::dvec2(last, 0.0)), place(at + glm::dvec2(0.0, last))};
  }

  Bitmap bitmap() const {
    const glm::ivec2 size = bitmapSize();
    const auto n = blockSize();
    Bitmap bitmap{size.x, size.y, {}, false};
    bitmap.rgba.assign(4 * static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y), 255);
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
      const glm::ivec2 corner = cornerOf(static_cast<std::uint32_t>(i));
      std::array<glm::vec3, 3> c;
      for (std::size_t k = 0; k < 9; ++k)
        c[k / 3][static_cast<int>(k % 3)] = linearFromSrgb(static_cast<float>(blocks_[i][k]) / 255.0f);
      for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) {
          const float last = static_cast<float>(n - 1);
          const glm::vec3 colour =
              c[0] + (c[1] - c[0]) * (static_cast<float>(x) / last) + (c[2] - c[0]) * (static_cast<float>(y) / last);
          const auto at = 4 * static_cast<std::size_t>((corner.y + y) * size.x + corner.x + x);
          for (int k = 0; k < 3; ++k) bitmap.rgba[at + static_cast<std::size_t>(k)] = encoded(colour[k]);
        }
    }
    return bitmap;
  }

 private:
  using Block = std::array<std::uint8_t, 9>;  ///< sRGB-encoded, corner by corner
  static constexpr std::size_t kMost = std::size_t{1} << 22, kTexels = std::size_t{1} << 17;

  /// Many triangles are small ones: their blocks should be no larger than they are on the screen.
  int blockSize() const {
    int size = 16;
    while (size > 2 && blocks_.size() * static_cast<std::size_t>(size * size) > kTexels) size /= 2;
    return size;
  }
  int blocksPerRow() const { return static_cast<int>(std::ceil(std::sqrt(static_cast<double>(blocks_.size())))); }
  glm::ivec2 cornerOf(std::uint32_t block) const {
    const auto i = static_cast<int>(block);
    return blockSize() * glm::ivec2(i % blocksPerRow(), i / blocksPerRow());
  }
  glm::ivec2 bitmapSize() const {
    const int rows = (static_cast<int>(blocks_.size()) + blocksPerRow() - 1) / blocksPerRow();
    return blockSize() * glm::ivec2(blocksPerRow(), rows);
  }

  std::vector<Block> blocks_;
  std::unordered_map<Block, std::uint32_t, BitsHash> index_;
};

bool hasPictures(const Material& m) {
  return m.diffuseTexture >= 0 || m.alphaTexture >= 0 || m.emissionTexture >= 0 || m.normalTexture >= 0 ||
         m.metalMap.has_value();
}

glm::vec3 meanColour(const PolygonMesh& mesh) {
  glm::dvec3 sum(0.0);
  for (const unsigned v : mesh.corners) sum += glm::dvec3(mesh.colours[v]);
  return glm::vec3(sum / static_cast<double>(mesh.corners.size()));
}

/// One mesh on its way into the scene.
struct Prepared {
  MeshData data;
  int material = 0;
  std::vector<std::uint32_t> blocks;  ///< of its triangles; empty without such colours
};

/// A vertex for every corner of every triangle, looked up in the picture of colours.
MeshData withColours(const Prepared& mesh, const ColourPicture& picture) {
  MeshData data;
  data.name = mesh.data.name;
  for (std::size_t t = 0; t < mesh.blocks.size(); ++t) {
    const std::array<glm::vec2, 3> texCoords = picture.texCoords(mesh.blocks[t]);
    for (std::size_t k = 0; k < 3; ++k) {
      const unsigned i = mesh.data.triangles[t][k];
      data.positions.push_back(mesh.data.positions[i]);
      data.normals.push_back(mesh.data.normals[i]);
      data.texCoords.push_back(texCoords[k]);
    }
    const auto first = static_cast<unsigned>(3 * t);
    data.triangles.push_back({first, first + 1, first + 2});
  }
  return data;
}

/// A vertex for every corner.
MeshData trianglesOf(const PolygonMesh& mesh, const glm::dvec3& origin) {
  MeshData data;
  data.name = mesh.name;
  std::vector<glm::dvec3> face;
  std::size_t begin = 0;
  for (const std::size_t end : mesh.ends) {
    face.clear();
    for (std::size_t i = begin; i < end; ++i) {
      const unsigned v = mesh.corners[i];
      face.push_back(mesh.positions[v] - origin);
      data.positions.emplace_back(face.back());
      if (!mesh.normals.empty()) data.normals.push_back(mesh.normals[v]);
      if (!mesh.texCoords.empty()) data.texCoords.push_back(mesh.texCoords[v]);
    }
    appendTriangles(face, static_cast<unsigned>(begin), data.triangles);
    begin = end;
  }
  return data;
}

/// Those that only served as bases of others.
void dropUnusedMaterials(Scene& scene) {
  std::vector<int> kept(scene.materials.size(), -1);
  for (const Mesh& mesh : scene.meshes) kept[static_cast<std::size_t>(mesh.material)] = 0;
  int count = 0;
  std::vector<Material> used;
  for (std::size_t i = 0; i < kept.size(); ++i)
    if (kept[i] == 0) {
      kept[i] = count++;
      used.push_back(std::move(scene.materials[i]));
    }
  scene.materials = std::move(used);
  for (Mesh& mesh : scene.meshes) mesh.material = kept[static_cast<std::size_t>(mesh.material)];
}

}  // namespace

void appendPolygons(Scene& scene, std::vector<PolygonMesh> meshes) {
  scene.origin = offsetOf(meshes);
  if (scene.origin != glm::dvec3(0.0))
    logWarning("{}: ({:.15g}, {:.15g}, {:.15g}) taken off all positions: single precision would lose their detail",
               scene.file.string(), scene.origin.x, scene.origin.y, scene.origin.z);
  std::vector<Prepared> prepared;
  ColourPicture colours;
  std::map<std::pair<int, std::array<float, 3>>, int> tinted;  // materials times one colour
  bool approximated = false;
  for (PolygonMesh& mesh : meshes) {
    if (mesh.ends.empty()) continue;
    Prepared& to = prepared.emplace_back();
    to.data = trianglesOf(mesh, scene.origin);
    to.material = mesh.material;
    makeNormals(to.data, mesh);
    if (!mesh.colours.empty()) {
      const auto colourAt = [&](unsigned corner) { return mesh.colours[mesh.corners[corner]]; };
      const bool same = std::all_of(mesh.corners.begin(), mesh.corners.end(),
                                    [&](unsigned v) { return mesh.colours[v] == colourAt(0); });
      const bool exact = same || (!hasPictures(scene.materials[static_cast<std::size_t>(mesh.material)]) &&
                                  colours.takes(to.data.triangles.size()));
      if (same || !exact) {
        approximated |= !exact;
        const glm::vec3 tint = same ? colourAt(0) : meanColour(mesh);
        const auto [known, isNew] =
            tinted.try_emplace({mesh.material, {tint.x, tint.y, tint.z}}, static_cast<int>(scene.materials.size()));
        if (isNew) {
          Material material = scene.materials[static_cast<std::size_t>(mesh.material)];
          material.diffuse *= tint;
          scene.materials.push_back(std::move(material));
        }
        to.material = known->second;
      } else {
        for (const std::array<unsigned, 3>& t : to.data.triangles)
          to.blocks.push_back(colours.add({colourAt(t[0]), colourAt(t[1]), colourAt(t[2])}));
      }
    }
    mesh = {};  // memory
  }
  // What has vertex colours is looked up in the picture of them, once that is whole.
  if (approximated)
    logWarning("{}: vertex colours of a mesh whose material has pictures, or that is too large, count by their mean",
               scene.file.string());

  const int picture = static_cast<int>(scene.textures.size());
  if (!colours.empty()) scene.textures.push_back({scene.file.string() + ":vertex colours", colours.bitmap()});
  std::map<int, int> painted;
  for (Prepared& mesh : prepared) {
    if (mesh.blocks.empty()) {
      appendMesh(scene, mesh.data, glm::dmat4(1.0), mesh.material);
    } else {
      const auto [known, isNew] = painted.try_emplace(mesh.material, static_cast<int>(scene.materials.size()));
      if (isNew) {
        scene.materials.push_back(scene.materials[static_cast<std::size_t>(mesh.material)]);
        scene.materials.back().diffuseTexture = picture;
      }
      appendMesh(scene, withColours(mesh, colours), glm::dmat4(1.0), known->second);
    }
    mesh = {};
  }
  dropUnusedMaterials(scene);
}

}  // namespace lucerna
