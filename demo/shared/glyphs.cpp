#include "shared/glyphs.hpp"

#include "base/statistics.hpp"
#include "irradiance_cache/irradiance_cache.hpp"
#include "irradiance_cache/irradiance_cache_frame.hpp"
#include "irradiance_cache/settings.hpp"
#include "lpv/lpv_frame.hpp"
#include "lpv/settings.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lucerna::demo {

namespace {

constexpr float kY00 = 0.28209479f, kY1 = 0.48860251f;  // shaders/lib/sh.glsl

void addBox(std::vector<gl::Lines::Line>& lines, const glm::vec3& low, const glm::vec3& high, const glm::vec4& color) {
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 4; ++side) {
      glm::vec3 a = low, b = low;
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      a[u] = b[u] = side & 1 ? high[u] : low[u];
      a[v] = b[v] = side & 2 ? high[v] : low[v];
      b[axis] = high[axis];
      lines.push_back({a, b, color});
    }
}

struct Lobe {
  glm::vec3 centre;
  std::array<glm::vec4, 3> channels;
  float intensity(int channel, const glm::vec3& d) const {
    const glm::vec4& c = channels[static_cast<std::size_t>(channel)];
    return std::max(kY00 * c.x + kY1 * glm::dot(glm::vec3(c.y, c.z, c.w), d), 0.0f);
  }
  float brightness() const { return kY00 * (channels[0].x + channels[1].x + channels[2].x); }
};

/// Intensity along three great circles.
void addLobe(std::vector<gl::Lines::Line>& lines, const Lobe& lobe, float scale) {
  constexpr int kSegments = 16;
  glm::vec3 hue(lobe.channels[0].x, lobe.channels[1].x, lobe.channels[2].x);
  hue = glm::sqrt(glm::max(hue, 0.0f) / std::max({hue.x, hue.y, hue.z, 1e-30f}));
  for (int axis = 0; axis < 3; ++axis) {
    glm::vec3 before(0.0f);
    for (int i = 0; i <= kSegments; ++i) {
      const float angle = 2.0f * std::numbers::pi_v<float> * static_cast<float>(i) / kSegments;
      glm::vec3 d(0.0f);
      d[(axis + 1) % 3] = std::cos(angle);
      d[(axis + 2) % 3] = std::sin(angle);
      const float strength = lobe.intensity(0, d) + lobe.intensity(1, d) + lobe.intensity(2, d);
      const glm::vec3 place = lobe.centre + scale * strength * d;
      if (i > 0) lines.push_back({before, place, glm::vec4(hue, 0.9f)});
      before = place;
    }
  }
}

std::vector<gl::Lines::Line> lobesOf(const LightPropagationVolume& volume, const Cascade& placed, int cascade,
                                     int most) {
  const int cells = volume.settings().cascades.cells;
  std::array<std::vector<glm::vec4>, 3> channels;
  for (std::size_t c = 0; c < 3; ++c) channels[c] = volume.result()[c].readRgba();
  std::vector<Lobe> lobes;
  const auto cell = static_cast<float>(placed.cellSize);
  for (int z = 0; z < cells; ++z)
    for (int y = 0; y < cells; ++y)
      for (int x = 0; x < cells; ++x) {
        const auto at = static_cast<std::size_t>(((cascade * cells + z) * cells + y) * cells + x);
        const Lobe lobe{glm::vec3(placed.minimum()) + cell * (glm::vec3(x, y, z) + 0.5f),
                        {channels[0][at], channels[1][at], channels[2][at]}};
        if (lobe.brightness() > 0.0f) lobes.push_back(lobe);
      }
  std::ranges::sort(lobes, [](const Lobe& a, const Lobe& b) { return a.brightness() > b.brightness(); });
  if (lobes.size() > static_cast<std::size_t>(most)) lobes.resize(static_cast<std::size_t>(most));
  // The brightest direction of all is half a cell long: no lobe leaves its cell.
  float longest = 1e-30f;
  for (const Lobe& lobe : lobes) {
    float sum = 0.0f;
    for (const glm::vec4& c : lobe.channels) sum += kY00 * c.x + kY1 * glm::length(glm::vec3(c.y, c.z, c.w));
    longest = std::max(longest, sum);
  }
  std::vector<gl::Lines::Line> lines;
  for (const Lobe& lobe : lobes) addLobe(lines, lobe, 0.5f * cell / longest);
  return lines;
}

/// The geometry volume's cells that block light, as boxes whose size shows how much they block.
std::vector<gl::Lines::Line> geometryOf(const LightPropagationVolume& volume, const Cascade& placed, int cascade,
                                        int most) {
  const gl::Texture* potential = volume.geometryVolume();
  if (!potential) return {};
  const glm::ivec3 size = potential->size();
  const int side = volume.settings().cascades.cells + 1;
  const std::vector<glm::vec4> texels = potential->readRgba();
  std::vector<std::pair<float, glm::vec3>> corners;
  for (int z = 0; z < side; ++z)
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        const auto at = static_cast<std::size_t>(((cascade * side + z) * size.y + y) * size.x + x);
        if (at < texels.size() && texels[at].x > 0.0f) corners.emplace_back(texels[at].x, glm::vec3(x, y, z));
      }
  std::ranges::sort(corners, [](const auto& a, const auto& b) { return a.first > b.first; });
  if (corners.size() > static_cast<std::size_t>(most)) corners.resize(static_cast<std::size_t>(most));
  std::vector<gl::Lines::Line> lines;
  const auto cell = static_cast<float>(placed.cellSize);
  for (const auto& [blocks, corner] : corners) {
    const glm::vec3 centre = glm::vec3(placed.minimum()) + cell * corner;
    const float half = 0.5f * cell * std::cbrt(blocks / corners.front().first);
    addBox(lines, centre - half, centre + half, {0.4f, 0.8f, 1.0f, 0.7f});
  }
  return lines;
}

/// A disk of 12 sectors, with a dark rim so that it is seen on a surface of its own colour.
void addDisk(std::vector<gl::Lines::Line>& lines, const glm::vec3& centre, const glm::vec3& normal, float radius,
             const glm::vec3& color) {
  constexpr int kSectors = 12;
  const glm::vec3 other = std::abs(normal.y) < 0.9f ? glm::vec3(0.0f, 1.0f, 0.0f) : glm::vec3(1.0f, 0.0f, 0.0f);
  const glm::vec3 u = glm::normalize(glm::cross(other, normal)), v = glm::cross(normal, u);
  const auto rim = [&](int i) {
    const float angle = 2.0f * std::numbers::pi_v<float> * static_cast<float>(i) / kSectors;
    return centre + radius * (std::cos(angle) * u + std::sin(angle) * v);
  };
  for (int i = 0; i < kSectors; ++i) {
    lines.push_back({centre, rim(i), glm::vec4(color, 1.0f)});
    lines.push_back({0.5f * (centre + rim(i)), 0.5f * (centre + rim(i + 1)), glm::vec4(color, 1.0f)});
  }
  for (int i = 0; i < kSectors; ++i) lines.push_back({rim(i), rim(i + 1), {0.0f, 0.0f, 0.0f, 0.8f}});
}

/// In the order of a hash of their cells: the same ones while the camera moves.
std::vector<gl::Lines::Line> recordsOf(const IrradianceCache& cache, const Renderer& renderer, const Camera& camera,
                                       const Cascade& placed, int cascade, int most) {
  const glm::vec3 eye(camera.position - renderer.origin()), ahead(camera.direction);
  const glm::vec3 right = glm::normalize(glm::cross(ahead, glm::vec3(camera.up))), up = glm::cross(right, ahead);
  const auto half = static_cast<float>(camera.halfHeight());
  const float aspect = static_cast<float>(renderer.size().x) / static_cast<float>(renderer.size().y);
  std::vector<std::pair<std::uint32_t, IrradianceCache::Shown>> seen;
  for (const IrradianceCache::Shown& record : cache.shown()) {
    if (record.cascade != cascade) continue;
    const glm::vec3 to = record.position - eye;
    const float depth = glm::dot(to, ahead), high = camera.isOrthographic() ? half : half * depth;
    if (depth <= 0.0f || std::abs(glm::dot(to, up)) > high || std::abs(glm::dot(to, right)) > aspect * high) continue;
    const glm::uvec3 cell(record.cell);
    std::uint32_t hash = cell.x * 73856093u ^ cell.y * 19349663u ^ cell.z * 83492791u ^
                         static_cast<std::uint32_t>(record.face) * 2654435761u;
    hash = (hash ^ hash >> 16) * 0x45d9f3bu;
    seen.emplace_back(hash ^ hash >> 16, record);
  }
  std::ranges::sort(seen, [](const auto& a, const auto& b) { return a.first < b.first; });
  if (seen.size() > static_cast<std::size_t>(most)) seen.resize(static_cast<std::size_t>(most));
  // One in ten is brighter than white.
  std::vector<double> largest;
  for (const auto& [hash, record] : seen)
    largest.push_back(std::max({record.irradiance.x, record.irradiance.y, record.irradiance.z}));
  const double white = largest.empty() ? 1.0 : std::max(percentile(largest, 0.9), 1e-30);
  std::vector<gl::Lines::Line> lines;
  const auto cell = static_cast<float>(placed.cellSize);
  for (const auto& [hash, record] : seen) {
    const glm::vec3 color = glm::clamp(record.irradiance / static_cast<float>(white), 0.0f, 1.0f);
    addDisk(lines, record.position + 0.01f * cell * record.normal, record.normal, 0.2f * cell,
            glm::pow(color, glm::vec3(1.0f / 2.2f)));
  }
  return lines;
}

}  // namespace

std::vector<gl::Lines::Line> boxesOf(const Bvh& bvh, const glm::dvec3& origin, int level, int most) {
  std::vector<std::pair<Bounds, bool>> boxes;  // and whether they are leaves
  std::vector<std::pair<std::uint32_t, int>> open{{0u, 0}};  // nodes, with their level
  while (!open.empty()) {
    const auto [index, depth] = open.back();
    open.pop_back();
    const shared::BvhNode& node = bvh.nodes[index];
    std::uint32_t next = node.firstChild;
    for (std::size_t k = 0; k < BVH_WIDTH; ++k) {
      if ((node.meta[k / 4] >> 8 * (k % 4) & 0xffu) == 0) continue;
      const bool isNode = (node.exponents >> (24 + k) & 1u) != 0;
      if (isNode && depth < level) open.emplace_back(next, depth + 1);
      else boxes.emplace_back(boundsOfChild(node, k), !isNode);
      next += isNode ? 1 : 0;
    }
  }
  std::ranges::stable_sort(boxes, [](const auto& a, const auto& b) {
    return glm::length(a.first.extent()) > glm::length(b.first.extent());
  });
  if (boxes.size() > static_cast<std::size_t>(most)) boxes.resize(static_cast<std::size_t>(most));
  const glm::dvec3 offset = bvh.origin - origin;
  std::vector<gl::Lines::Line> lines;
  for (const auto& [box, isLeaf] : boxes)
    addBox(lines, glm::vec3(box.min + offset), glm::vec3(box.max + offset),
           isLeaf ? glm::vec4(0.4f, 0.9f, 0.4f, 0.7f) : glm::vec4(1.0f, 0.7f, 0.2f, 0.7f));
  return lines;
}

std::vector<gl::Lines::Line> glyphsOf(Glyphs glyphs, const Renderer& renderer, const Scene& scene, const Camera& camera,
                                      int cascade, int most) {
  const RenderSettings& settings = renderer.settings();
  const LightPropagationVolume* volume = volumeOf(renderer.technique());
  if (glyphs == Glyphs::none || glyphs == Glyphs::boxes ||
      (glyphs == Glyphs::records ? !cacheOf(renderer.technique()) : !volume))
    return {};
  // Place them as lpv/lpv_frame.cpp and, but for the blend, irradiance_cache/irradiance_cache_frame.cpp do.
  Bounds bounds = scene.bounds;
  bounds.min -= renderer.origin();
  bounds.max -= renderer.origin();
  Camera inFrame = camera;
  inFrame.position -= renderer.origin();
  const std::vector<Cascade> cascades =
      glyphs == Glyphs::records
          ? placeCascadesAround(settings.of<IrradianceCacheSettings>().cascades, bounds, inFrame, 1.0)
          : placeCascades(settings.of<LpvSettings>().cascades, bounds, inFrame.position, inFrame.direction);
  const int k = std::clamp(cascade, 0, static_cast<int>(cascades.size()) - 1);
  const Cascade& placed = cascades[static_cast<std::size_t>(k)];
  if (glyphs == Glyphs::records) return recordsOf(*cacheOf(renderer.technique()), renderer, camera, placed, k, most);
  return glyphs == Glyphs::lobes ? lobesOf(*volume, placed, k, most) : geometryOf(*volume, placed, k, most);
}

}  // namespace lucerna::demo
