// Technique radiosity in the frame: a solution, computed or loaded once and drawn from any viewpoint; direct light by
// shadow rays per pixel on request.
//
// It replaces the drawn geometry (patches instead of the scene's triangles), the shading programs and, on request, the
// display mapping.
#pragma once

#include "frame/technique.hpp"
#include "gl/chunks.hpp"
#include "radiosity/direct_rays.hpp"
#include "radiosity/radiosity_view.hpp"

#include <optional>
#include <span>

namespace lucerna {

class RadiosityFrame final : public GeometryTechnique {
 public:
  /// Solves or loads.
  explicit RadiosityFrame(const FrameParts& parts);

  /// Backs are black. Seen edge-on at a silhouette, rounding could bring a back's depth before the front that hides it,
  /// so backs are drawn separately, with a slope-scaled depth offset.
  std::span<const Sides> sides() const override;
  const Scene& geometry() const override { return view_.scene(); }  ///< the patches
  SurfacePrograms surfacePrograms(bool inspected) const override {
    return view_.loadPrograms(parts_.programs, parts_.drawn(), inspected);
  }
  const gl::Program* toneMap() const override { return view_.loadMapping(parts_.programs); }
  /// Solves the scene as it is now, from the last solution. The patches are others.
  bool follow(const SceneChange& change) override;
  void bindForShading() const override;
  /// A few shadow rays per pixel keep a small GPU busy for seconds, so rows of pixels are drawn in chunks, each waited
  /// for.
  void draw(const gl::RasterPass& pass, const SurfacePrograms& programs, const FrameView& view) override;

  void addShares(const InspectedPixel& pixel, PixelInspection& answer) override;
  void addLeftOut(std::vector<std::string>& names) const override;
  double largestIterations() const override { return chunks_ ? chunks_->largestIterations() : 0.0; }
  std::size_t gpuBytes() const override { return view_.gpuBytes() + (rays_ ? rays_->gpuBytes() : 0); }

  const RadiosityView& view() const { return view_; }

 private:
  void makeRays();

  FrameParts parts_;
  RadiosityView view_;
  std::optional<DirectRays> rays_;
  std::optional<gl::ChunkSize> chunks_;  ///< rows of pixels per submission, for the last frame's shadow rays
};

/// Null if the technique is another.
inline const RadiosityView* radiosityOf(const FrameTechnique* technique) {
  const auto* frame = dynamic_cast<const RadiosityFrame*>(technique);
  return frame ? &frame->view() : nullptr;
}

}  // namespace lucerna
