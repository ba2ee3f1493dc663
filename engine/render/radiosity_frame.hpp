// Technique radiosity in the frame: a solution, computed or loaded once and drawn from any viewpoint; direct light by
// shadow rays per pixel on request.
//
// It replaces the drawn geometry (patches instead of the scene's triangles), the shading programs and, on request, the
// display mapping.
#pragma once

#include "gl/chunks.hpp"
#include "radiosity/direct_rays.hpp"
#include "radiosity/radiosity_view.hpp"
#include "render/frame_parts.hpp"

#include <optional>
#include <span>

namespace lucerna {

class RadiosityFrame {
 public:
  /// How the two sides of surfaces are drawn: backs are black. Seen edge-on at a silhouette, rounding could bring a
  /// back's depth before the front that hides it, so backs are drawn separately, with a slope-scaled depth offset.
  struct Sides {
    gl::Cull cull = gl::Cull::none;
    glm::vec2 polygonOffset{0.0f};
  };
  static std::span<const Sides> sides();

  /// Solves or loads. `scene`: as loaded; `settings` is the frame's, which outlives it.
  RadiosityFrame(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene,
                 const RenderSettings& settings, const glm::dvec3& origin);

  /// The geometry for GpuScene: the patches.
  const Scene& scene() const { return view_.scene(); }
  SurfacePrograms loadPrograms(gl::ProgramLibrary& programs, const GpuScene& drawn, bool asked) const {
    return view_.loadPrograms(programs, drawn, asked);
  }
  const gl::Program* loadMapping(gl::ProgramLibrary& programs) const {
    return view_.loadMapping(programs);
  }  ///< null: the engine's tone mapping

  void bindForShading() const;
  /// A few shadow rays per pixel keep a small GPU busy for seconds, so rows of pixels are drawn in chunks, each waited
  /// for.
  void draw(const gl::RasterPass& pass, const GpuScene& drawn, const SurfacePrograms& programs, const FrameView& view);

  const RadiosityView& view() const { return view_; }
  bool hasShadowRays() const { return rays_.has_value(); }
  double largestIterations() const { return chunks_ ? chunks_->largestIterations() : 0.0; }
  std::size_t gpuBytes() const { return view_.gpuBytes() + (rays_ ? rays_->gpuBytes() : 0); }

 private:
  const RenderSettings& settings_;
  RadiosityView view_;
  std::optional<DirectRays> rays_;
  std::optional<gl::ChunkSize> chunks_;  ///< rows of pixels per submission, for the last frame's shadow rays
};

}  // namespace lucerna
