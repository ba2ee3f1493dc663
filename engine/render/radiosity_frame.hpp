// Technique radiosity in the frame: a solution, made or loaded once, drawn from anywhere; direct light by shadow rays
// in each pixel where asked for.
//
// It replaces what is drawn (patches instead of the scene's triangles), the programs of shading and, where asked for,
// the display mapping.
#pragma once

#include "gl/pieces.hpp"
#include "radiosity/direct_rays.hpp"
#include "radiosity/radiosity_view.hpp"
#include "render/frame_parts.hpp"

#include <optional>
#include <span>

namespace lucerna {

class RadiosityFrame {
 public:
  /// How a picture is drawn: backs are black. On edge at a silhouette, where rounding of a back's depth could bring it
  /// before the front that it hides behind, backs are drawn apart and pushed away by their slope.
  struct Sides {
    gl::Cull cull = gl::Cull::none;
    glm::vec2 polygonOffset{0.0f};
  };
  static std::span<const Sides> sides();

  /// Solves or loads. `scene`: as loaded; `settings` is the frame's, which outlives it.
  RadiosityFrame(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene,
                 const RenderSettings& settings, const glm::dvec3& origin);

  /// What GpuScene is to draw: the patches.
  const Scene& scene() const { return view_.scene(); }
  SurfacePrograms loadPrograms(gl::ProgramLibrary& programs, const GpuScene& drawn, bool asked) const {
    return view_.loadPrograms(programs, drawn, asked);
  }
  const gl::Program* loadMapping(gl::ProgramLibrary& programs) const {
    return view_.loadMapping(programs);
  }  ///< null: the engine's tone mapping

  void bindForShading() const;
  /// Some shadow rays a pixel keep a small GPU busy for seconds: rows of pixels in pieces, each waited for.
  void draw(const gl::RasterPass& pass, const GpuScene& drawn, const SurfacePrograms& programs, const FrameView& view);

  const RadiosityView& view() const { return view_; }
  bool hasShadowRays() const { return rays_.has_value(); }
  double largestTurns() const { return pieces_ ? pieces_->largestTurns() : 0.0; }
  std::size_t gpuBytes() const { return view_.gpuBytes() + (rays_ ? rays_->gpuBytes() : 0); }

 private:
  const RenderSettings& settings_;
  RadiosityView view_;
  std::optional<DirectRays> rays_;
  std::optional<gl::PieceSize> pieces_;  ///< rows of pixels a submission, of the last frame's shadow rays
};

}  // namespace lucerna
