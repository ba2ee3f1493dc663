#include "radiosity/radiosity_frame.hpp"

#include "base/angles.hpp"
#include "base/log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace lucerna {

namespace {

constexpr double kSecondsOfPiece = 0.1;  // of a frame's shadow rays

RadiosityView::Settings viewSettings(const Scene& scene, const RenderSettings& settings) {
  using Light = RadiosityView::Light;
  auto view = settings.of<RadiosityView::Settings>();
  view.light = settings.component == Component::all      ? Light::all
               : settings.component == Component::direct ? Light::direct
                                                         : Light::indirect;
  if (view.direct != RadiosityView::Direct::pixels) return view;
  if (const std::size_t emitters = DirectRays::emitterCount(scene); emitters > DirectRays::kMostEmitters) {
    logWarning(
        "radiosity: {} triangles emit, more than the {} supported by shadow rays per pixel: direct light is computed "
        "per patch",
        emitters, DirectRays::kMostEmitters);
    view.direct = RadiosityView::Direct::patches;
  }
  return view;
}

}  // namespace

std::span<const GeometryTechnique::Sides> RadiosityFrame::sides() const {
  // Of sheets in one place the front is seen. Their depths differ by the rounding of corners to parts of a pixel; a
  // larger offset would show the floor behind a wall along its foot.
  static constexpr std::array<Sides, 2> apart{Sides{gl::Cull::back, glm::vec2(0.0f)},
                                              Sides{gl::Cull::front, glm::vec2(0.015625f, 4.0f)}};
  return apart;
}

RadiosityFrame::RadiosityFrame(const FrameParts& parts)
    : parts_(parts),
      view_(parts.context, parts.programs, parts.scene, viewSettings(parts.scene, parts.settings), parts.origin) {
  makeRays();
}

void RadiosityFrame::makeRays() {
  rays_.reset();
  if (view_.takesDirectRays())
    rays_.emplace(parts_.scene, parts_.context.capabilities(), parts_.settings.of<RadiosityView::Settings>().shadowRays,
                  parts_.origin);
}

bool RadiosityFrame::follow(const SceneChange&) {
  const RadiosityView::Settings settings = viewSettings(parts_.scene, parts_.settings);
  const RadiositySolution& before = view_.solution();
  if (!before.moment || !settings.file.empty()) return false;
  view_ = RadiosityView(parts_.context, parts_.programs, parts_.scene, settings, parts_.origin, &before);
  makeRays();
  return true;
}

void RadiosityFrame::bindForShading() const {
  view_.bind();
  if (rays_) rays_->bind();
}

void RadiosityFrame::draw(const gl::RasterPass& pass, const SurfacePrograms& programs, const FrameView& view) {
  const GpuScene& drawn = parts_.drawn();
  if (!rays_) {
    drawn.draw(programs, view.drawn());
    return;
  }
  const glm::ivec2 size = parts_.settings.size;
  chunks_.emplace(kSecondsOfPiece, size.x * rays_->iterationsOfPixel(), static_cast<std::uint32_t>(size.y),
                  parts_.settings.unmeasuredIterations);
  for (int row = 0; row < size.y;) {
    const int rows = std::min(static_cast<int>(chunks_->units()), size.y - row);
    const gl::ChunkClock clock;
    pass.restrictTo({0, row}, {size.x, rows});
    drawn.draw(programs, view.drawn());
    chunks_->took(static_cast<std::uint32_t>(rows), clock.seconds());
    row += rows;
  }
}

void RadiosityFrame::addShares(const InspectedPixel& pixel, PixelInspection& answer) {
  const Scene& scene = parts_.scene;
  const InspectedTerms& terms = pixel.terms;
  const RadiositySolution& solution = view_.solution();
  const glm::dvec3 position = answer.surface->position, reflection = answer.surface->albedo / kPi;
  const auto patch = static_cast<std::uint32_t>(std::lround(terms.fourth(INSPECTED_CORNERS)));
  answer.surface->normal = solution.mesh.patches[patch].faceNormal;
  const auto& settings = parts_.settings.of<RadiosityView::Settings>();
  const bool byPixel = view_.takesDirectRays();
  if (byPixel) {
    const std::size_t emitters = DirectRays::emitterCount(scene);
    std::vector<std::string> names;
    for (std::size_t i = 0; i < emitters; ++i) names.push_back(fmt::format("emissive triangle {}", i + 1));
    if (scene.sun) names.emplace_back("sun");
    for (std::size_t i = 0; i < scene.spots.size(); ++i) names.push_back(fmt::format("spot {}", i + 1));
    for (std::size_t i = 0; i < scene.points.size(); ++i) names.push_back(fmt::format("point {}", i + 1));
    glm::dvec3 rest = glm::dvec3(terms[INSPECTED_RADIANCE] - terms[INSPECTED_EMISSION]) -
                      reflection * glm::dvec3(terms[INSPECTED_INDIRECT]);
    for (std::size_t i = 0; i < names.size() && INSPECTED_LIGHTS + i < InspectedTerms::kCount; ++i) {
      answer.add("direct", names[i], glm::dvec3(terms[INSPECTED_LIGHTS + i]));
      rest -= glm::dvec3(terms[INSPECTED_LIGHTS + i]);
    }
    if (INSPECTED_LIGHTS + names.size() > InspectedTerms::kCount) answer.add("direct", "more lamps", rest);
  }
  const RadiosityOrigins origins = originsOf(parts_.context, parts_.programs, scene, solution, settings.solution, patch,
                                             glm::dvec3(terms[INSPECTED_CORNERS]), settings.flat);
  const bool hasDirect = parts_.settings.component != Component::indirect,
             hasIndirect = parts_.settings.component != Component::direct;
  if (hasDirect && !byPixel)
    answer.add("direct", "lamps, of the patches around", reflection * origins.lamps, {position});
  if (hasDirect) answer.add("direct", "sky, of the patches around", reflection * origins.sky, {position});
  constexpr const char* kRepair = "repair of the form factors";
  if (hasDirect && !byPixel) answer.add("direct", kRepair, reflection * origins.repairOfEmitted, {position});
  if (hasIndirect) answer.add("patches", kRepair, reflection * origins.repairOfReflected, {position});
  for (const RadiosityOrigins::FromPatch& from : origins.patches) {
    const glm::dvec3 place = solution.mesh.patches[from.patch].centroid;
    if (hasDirect && !byPixel)
      answer.add("direct", fmt::format("emissive patch {}", from.patch), reflection * from.emitted, {position, place});
    if (!hasIndirect) continue;
    answer.add("patches", fmt::format("patch {}", from.patch), reflection * from.reflected, {position, place});
    if (from.reflected != glm::dvec3(0.0)) answer.shares.back().weight = from.factor;
  }
}

void RadiosityFrame::addLeftOut(std::vector<std::string>& names) const {
  if (!rays_) names.emplace_back("shadow rays");
}

}  // namespace lucerna
