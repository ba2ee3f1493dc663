#include "walk/scene_views.hpp"

#include "base/statistics.hpp"
#include "gl/pass.hpp"
#include "irradiance_cache/irradiance_cache.hpp"
#include "irradiance_cache/irradiance_cache_frame.hpp"
#include "irradiance_cache/settings.hpp"
#include "lpv/lpv_frame.hpp"
#include "lpv/settings.hpp"
#include "scene/place.hpp"

#include <glm/gtc/matrix_inverse.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace lucerna::demo {

namespace {

/// As in shaders/walk/compose.frag.
glm::vec3 heat(float t) { return glm::clamp(glm::vec3(3.0f * t, 3.0f * t - 1.0f, 3.0f * t - 2.0f), 0.0f, 1.0f); }

}  // namespace

CountViews::CountViews(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene,
                       const glm::dvec3& origin)
    : context_(context), programs_(programs), scene_(scene), origin_(origin) {}

std::vector<float> CountViews::surfaces(const glm::mat4& clipFromWorld, glm::ivec2 size) {
  if (!drawn_) {
    if (origin_ != glm::dvec3(0.0)) moved_ = movedTo(scene_, origin_);
    const Scene& scene = moved_ ? *moved_ : scene_;
    drawn_.emplace(scene, analyse(scene), context_.capabilities());
  }
  gl::Texture target("surfaces in a pixel", gl::Format::rgba32f, size);
  const std::array<const gl::Texture*, 1> colors{&target};
  const gl::Framebuffer framebuffer("surfaces in a pixel", colors);
  shared::FrameConstants constants{};
  constants.clipFromWorld = clipFromWorld;
  const gl::Buffer buffer("overdraw constants", sizeof constants, &constants, gl::Usage::staticDraw);
  buffer.bindUniform(BLOCK_FRAME);
  const gl::Program& program = programs_.loadRaster("overdraw", "forward/depth.vert", "walk/overdraw.frag",
                                                    {{"ALPHA_MASK", 0}, {"FROM_SUN", 0}});
  {
    gl::RasterState state;
    state.blend = gl::Blend::add;
    const gl::RasterPass pass("overdraw", framebuffer, state);
    pass.clearColor(0, glm::vec4(0.0f));
    drawn_->draw({&program, &program}, {&clipFromWorld, nullptr});
  }
  std::vector<float> counts;
  for (const glm::vec4& texel : target.readRgba()) counts.push_back(texel.x);
  return counts;
}

std::vector<float> CountViews::visits(const Camera& camera, glm::ivec2 size) {
  struct Ray {  // as in shaders/rays/bvh.glsl
    glm::vec3 origin;
    float tMin;
    glm::vec3 direction;
    float tMax;
  };
  if (!rays_) rays_.emplace(scene_, context_.capabilities());
  const glm::dvec3 right = glm::normalize(glm::cross(camera.direction, camera.up)),
                   up = glm::cross(right, camera.direction);
  const double pixel = 2.0 * std::tan(0.5 * camera.verticalFov) / size.y;
  std::vector<Ray> rays;
  for (int y = 0; y < size.y; ++y)
    for (int x = 0; x < size.x; ++x) {
      const glm::dvec3 direction =
          camera.direction + pixel * ((x + 0.5 - 0.5 * size.x) * right) + pixel * ((y + 0.5 - 0.5 * size.y) * up);
      rays.push_back({glm::vec3(camera.position - rays_->origin()), 0.0f, glm::vec3(glm::normalize(direction)), 3e38f});
    }
  const gl::Program& program = programs_.loadCompute("ray visits", "rays/trace_rays.comp",
                                                     {{"ALPHA_MASKS", 0},
                                                      {"ANY_HIT", 0},
                                                      {"COUNT_WORK", 1},
                                                      {"OFFSET_ORIGINS", 0},
                                                      {"SHARED_STACK", rays_->sharedStack()}});
  const std::vector<std::uint32_t> skip(rays.size(), 0xffffffffu);
  const gl::Buffer rayBuffer("rays", rays.size() * sizeof(Ray), rays.data(), gl::Usage::staticDraw);
  const gl::Buffer hits("hits", rays.size() * sizeof(glm::vec4), nullptr, gl::Usage::streamRead);
  const gl::Buffer skipped("skipped", skip.size() * sizeof skip[0], skip.data(), gl::Usage::staticDraw);
  program.use();
  rays_->bind();
  rayBuffer.bindStorage(2);
  hits.bindStorage(3);
  skipped.bindStorage(4);
  const int count = static_cast<int>(rays.size());
  program.set("rayCount", count);
  constexpr int kBatch = 1 << 16;
  for (int first = 0; first < count; first += kBatch) {
    const gl::ComputePass pass("ray visits");
    program.set("firstRay", first);
    pass.dispatch(glm::ivec3(std::min(kBatch, count - first), 1, 1), glm::ivec3(64, 1, 1));
  }
  std::vector<float> counts;
  for (const glm::vec4& hit : hits.read<glm::vec4>()) counts.push_back(hit.x);
  return counts;
}

const gl::Texture& CountViews::record(CountView view, const Camera& camera, const glm::mat4& clipFromWorld,
                                      glm::ivec2 size, float white) {
  const bool isNew = view != view_ || clipFromWorld != clip_ || !result_.id() || result_.size2d() != size;
  if (isNew) {
    counts_ = view == CountView::overdraw ? surfaces(clipFromWorld, size) : visits(camera, size);
    view_ = view;
    clip_ = clipFromWorld;
    result_ = gl::Texture("counts", gl::Format::rgba32f, size);
    most_ = *std::ranges::max_element(counts_);
    double sum = 0.0;
    for (const float count : counts_) sum += static_cast<double>(count);
    mean_ = static_cast<float>(sum / static_cast<double>(counts_.size()));
  }
  std::vector<glm::vec4> texels;
  for (const float count : counts_) texels.emplace_back(heat(count / white), 1.0f);
  result_.upload(gl::Texels::rgbaFloat, texels.data());
  return result_;
}

// ---------------------------------------------------------------------------------------------------- glyphs

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
  const float tangent = std::tan(0.5f * static_cast<float>(camera.verticalFov));
  const float aspect = static_cast<float>(renderer.size().x) / static_cast<float>(renderer.size().y);
  std::vector<std::pair<std::uint32_t, IrradianceCache::Shown>> seen;
  for (const IrradianceCache::Shown& record : cache.shown()) {
    if (record.cascade != cascade) continue;
    const glm::vec3 to = record.position - eye;
    const float depth = glm::dot(to, ahead);
    if (depth <= 0.0f || std::abs(glm::dot(to, up)) > tangent * depth ||
        std::abs(glm::dot(to, right)) > aspect * tangent * depth)
      continue;
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

std::vector<gl::Lines::Line> glyphsOf(Glyphs glyphs, const Renderer& renderer, const Scene& scene, const Camera& camera,
                                      int cascade, int most) {
  const RenderSettings& settings = renderer.settings();
  const LightPropagationVolume* volume = volumeOf(renderer.technique());
  if (glyphs == Glyphs::none || (glyphs == Glyphs::records ? !cacheOf(renderer.technique()) : !volume)) return {};
  // Place them as render/lpv_frame.cpp and, but for the blend, render/irradiance_cache_frame.cpp do.
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
