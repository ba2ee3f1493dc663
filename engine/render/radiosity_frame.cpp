#include "render/radiosity_frame.hpp"

#include "base/log.hpp"

#include <algorithm>
#include <array>

namespace lucerna {

namespace {

constexpr double kSecondsOfPiece = 0.1;  // of a frame's shadow rays

RadiosityView::Settings viewSettings(const Scene& scene, const RenderSettings& settings) {
  using Light = RadiosityView::Light;
  RadiosityView::Settings view = settings.radiosity;
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

std::span<const RadiosityFrame::Sides> RadiosityFrame::sides() {
  static constexpr std::array<Sides, 2> apart{Sides{gl::Cull::back, glm::vec2(0.0f)},
                                              Sides{gl::Cull::front, glm::vec2(1.0f)}};
  return apart;
}

RadiosityFrame::RadiosityFrame(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene,
                               const RenderSettings& settings, const glm::dvec3& origin)
    : settings_(settings), view_(context, programs, scene, viewSettings(scene, settings), origin) {
  if (view_.takesDirectRays()) rays_.emplace(scene, context.capabilities(), settings.radiosity.shadowRays, origin);
}

void RadiosityFrame::bindForShading() const {
  view_.bind();
  if (rays_) rays_->bind();
}

void RadiosityFrame::draw(const gl::RasterPass& pass, const GpuScene& drawn, const SurfacePrograms& programs,
                          const FrameView& view) {
  if (!rays_) {
    drawn.draw(programs, view.drawn());
    return;
  }
  const glm::ivec2 size = settings_.size;
  chunks_.emplace(kSecondsOfPiece, size.x * rays_->iterationsOfPixel(), static_cast<std::uint32_t>(size.y),
                  settings_.unmeasuredIterations);
  for (int row = 0; row < size.y;) {
    const int rows = std::min(static_cast<int>(chunks_->units()), size.y - row);
    const gl::ChunkClock clock;
    pass.restrictTo({0, row}, {size.x, rows});
    drawn.draw(programs, view.drawn());
    chunks_->took(static_cast<std::uint32_t>(rows), clock.seconds());
    row += rows;
  }
}

}  // namespace lucerna
