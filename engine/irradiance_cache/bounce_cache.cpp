#include "irradiance_cache/bounce_cache.hpp"

#include "base/error.hpp"
#include "scene/texture_mean.hpp"

#include <algorithm>
#include <cmath>

namespace lucerna {

namespace {

constexpr double kLeans = 0.02;  // as shaders/irradiance_cache/mark.comp
constexpr double kStep = 0.25;  // cells between tested points of a triangle

/// Whether a material is cut out at a texture coordinate, as in forward shading, at the nearest texel.
bool isCutOut(const Scene& scene, const Material& material, const glm::dvec2& texCoord) {
  const int index = material.alphaTexture >= 0 ? material.alphaTexture : material.diffuseTexture;
  if (!material.alphaMasked || index < 0) return false;
  const Texture& texture = scene.textures[static_cast<std::size_t>(index)];
  if (texture.bitmap.width <= 0 || texture.bitmap.height <= 0) return false;
  return nearestTexel(texture, texCoord)[texture.bitmap.hasAlpha ? 3 : 0] < 128;
}

class Chooser {
 public:
  explicit Chooser(BounceCache& result) : result_(result) {
    result_.slots.assign(
        static_cast<std::size_t>(BounceCache::kFaces * result.cells.x * result.cells.y * result.cells.z), 0);
  }

  /// Offers both sides of a point to the cells' slots. normal: on the triangle's front.
  void offer(BounceCache::Point point, const glm::dvec3& normal) {
    const glm::dvec3 inCells = (point.position - result_.minimum) / result_.cellSize;
    const glm::ivec3 cell = glm::clamp(glm::ivec3(glm::floor(inCells)), glm::ivec3(0), result_.cells - 1);
    const double offCentre = glm::length(inCells - glm::dvec3(cell) - 0.5);
    for (const bool front : {true, false}) {
      point.front = front;
      point.normal = glm::vec3(front ? normal : -normal);
      for (int axis = 0; axis < 3; ++axis) {
        const double lean = normal[axis] * normal[axis];
        if (lean < kLeans) continue;
        point.place = glm::ivec4(cell, 2 * axis + (point.normal[axis] < 0.0f ? 1 : 0));
        offer(point, offCentre + 0.5 * (1.0 - lean));
      }
    }
  }

 private:
  // To the layer that it belongs to, or as a new one.
  void offer(const BounceCache::Point& point, double score) {
    std::uint32_t* link = &result_.slots[static_cast<std::size_t>(
        ((point.place.w * result_.cells.z + point.place.z) * result_.cells.y + point.place.y) * result_.cells.x +
        point.place.x)];
    for (int layer = 0; *link != 0; ++layer) {
      BounceCache::Point& there = result_.points[*link - 1];
      const double apart = std::abs(glm::dot(glm::dvec3(point.normal), there.position - point.position));
      if (apart <= BounceCache::kApart * result_.cellSize) {
        double& best = scores_[*link - 1];
        if (score >= best) return;
        best = score;
        const std::uint32_t next = there.next;
        there = point;
        there.next = next;
        return;
      }
      if (layer + 1 == BounceCache::kLayers) return;
      link = &there.next;
    }
    *link = static_cast<std::uint32_t>(result_.points.size() + 1);
    result_.points.push_back(point);
    scores_.push_back(score);
  }

  BounceCache& result_;
  std::vector<double> scores_;  ///< of the points, smallest first choice
};

/// Points in rows along two edges; of a small triangle its middle alone.
void offerTriangle(const Scene& scene, const Material& material, std::uint32_t first, double step, Chooser& chooser) {
  const Vertex* corners[3];
  for (std::uint32_t k = 0; k < 3; ++k) corners[k] = &scene.vertices[scene.indices[first + k]];
  const glm::dvec3 a(corners[0]->position), ab = glm::dvec3(corners[1]->position) - a,
                                            ac = glm::dvec3(corners[2]->position) - a, cross = glm::cross(ab, ac);
  const double area = glm::length(cross);
  if (!(area > 0.0) || !std::isfinite(area)) return;
  const double edge = std::max({glm::length(ab), glm::length(ac), glm::length(ac - ab)});
  const int steps = std::max(1, static_cast<int>(std::ceil(edge / step)));
  for (int u = 0; u < steps; ++u)
    for (int v = 0; u + v < steps; ++v) {
      const double second = (u + 1.0 / 3.0) / steps, third = (v + 1.0 / 3.0) / steps, own = 1.0 - second - third;
      const glm::vec2 texCoord = static_cast<float>(own) * corners[0]->texCoord +
                                 static_cast<float>(second) * corners[1]->texCoord +
                                 static_cast<float>(third) * corners[2]->texCoord;
      const glm::dvec3 position = a + second * ab + third * ac;
      if (!scene.isMain(position) || isCutOut(scene, material, texCoord)) continue;
      glm::dvec3 normal = own * glm::dvec3(corners[0]->normal) + second * glm::dvec3(corners[1]->normal) +
                          third * glm::dvec3(corners[2]->normal);
      const double length = glm::length(normal);
      normal = length > 1e-6 ? normal / length : cross / area;
      BounceCache::Point point{};
      point.position = position;
      point.triangle = first / 3;
      point.barycentrics = glm::vec2(second, third);
      chooser.offer(point, normal);
    }
}

}  // namespace

BounceCache bounceCache(const Scene& scene, int across) {
  CHECK(across >= 1 && across <= 64, "{} cells", across);
  BounceCache result;
  const glm::dvec3 extent = scene.main().extent();
  const double longest = std::max({extent.x, extent.y, extent.z});
  result.cellSize = longest > 0.0 ? longest / across : 1.0;
  // Half a cell of air around the scene, so that its outermost walls lie in the middle of cells.
  result.minimum = scene.bounds.empty() ? glm::dvec3(0.0) : scene.main().min - 0.5 * result.cellSize;
  for (int axis = 0; axis < 3; ++axis)
    result.cells[axis] = std::max(1, static_cast<int>(std::ceil(extent[axis] / result.cellSize + 1.0 - 1e-6)));
  Chooser chooser(result);
  for (const Mesh& mesh : scene.meshes) {
    const Material& material = scene.materials[static_cast<std::size_t>(mesh.material)];
    for (std::uint32_t i = mesh.firstIndex; i + 2 < mesh.firstIndex + mesh.indexCount; i += 3)
      offerTriangle(scene, material, i, kStep * result.cellSize, chooser);
  }
  return result;
}

}  // namespace lucerna
