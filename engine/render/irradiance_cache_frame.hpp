// Technique irradiance-cache in the frame: irradiance stored at surface points, chosen by camera and grids.
//
// Stages, with their inputs: rsm (lights, geometry; only for gather) -> geometry (camera) -> records (maps, visible
// surfaces, placement of the cascades). A view whose records have all their paths needs no work.
#pragma once

#include "forward/visible_surfaces.hpp"
#include "irradiance_cache/irradiance_cache.hpp"
#include "render/light_maps.hpp"

#include <optional>

namespace lucerna {

class IrradianceCacheFrame {
 public:
  static bool isNeeded(const RenderSettings& settings, const SceneFeatures& features);
  /// Whether they gather light from the lights' maps.
  static bool takesMaps(const RenderSettings& settings, const SceneFeatures& features) {
    return isNeeded(settings, features) && settings.cache.transport == CacheTransport::gather &&
           settings.component != Component::direct;
  }
  /// `depth`: the frame's, of the picture's size.
  IrradianceCacheFrame(const FrameParts& parts, const gl::Texture& depth);
  void resize(const gl::Texture& depth);

  /// Returns whether depth was drawn.
  bool record(gl::TimeQuery& timer, const FrameView& view, FrameEffort effort);
  void forget();
  void collect(bool wait = false) { cache_.collect(wait); }
  /// Whether another frame of the same view would look the same.
  bool isSettled() const { return settled_; }

  /// Flags of shaders/forward/indirect.glsl, and its inputs.
  gl::ShaderFlags shadingFlags() const;
  void bindForShading() const { cache_.bindForLookup(); }

  bool hasMaps() const { return maps_ && maps_->count() > 0; }
  const IrradianceCache& cache() const { return cache_; }
  /// Bounds for the last view (IrradianceCache). The first: only with CacheTransport::gather.
  Image gatheredAtPixels() const {
    return cache_.gatheredAtPixels(maps_ ? maps_->outputs() : std::vector<ReflectiveShadowMap::Outputs>{});
  }
  /// `cascades`: of the cells, blended over `blendBand` (engine/lpv).
  Image readFromCells(const CascadeSettings& cascades, float blendBand, int paths) const;
  double largestIterations() const { return cache_.mostIterations(); }
  void addStagePictures(std::vector<StagePicture>& pictures) const {
    if (maps_) maps_->addStagePictures(pictures);
    pictures.push_back({StagePicture::Kind::normal, "normals", &visible_.normal()});
    pictures.push_back({StagePicture::Kind::irradiance, "irradiance cache", &cache_.irradiance()});
  }
  std::size_t gpuBytes() const { return (maps_ ? maps_->gpuBytes() : 0) + visible_.gpuBytes() + cache_.gpuBytes(); }

 private:
  FrameParts parts_;
  std::optional<LightMaps> maps_;  ///< if they use maps
  VisibleSurfaces visible_;
  IrradianceCache cache_;
  /// The view for which they were last updated, the frame of its first update, and whether no work is left.
  glm::dmat4 clip_{0.0};
  glm::dvec3 volumePosition_{0.0}, volumeDirection_{0.0};
  std::uint32_t since_ = 0;
  bool settled_ = false;
};

}  // namespace lucerna
