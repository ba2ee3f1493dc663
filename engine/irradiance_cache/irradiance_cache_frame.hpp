// Technique irradiance-cache in the frame: irradiance stored at surface points, chosen by camera and grids.
//
// Stages, with their inputs: rsm (lights, geometry; only for gather) -> geometry (camera) -> records (maps, visible
// surfaces, placement of the cascades). A view whose records have all their paths needs no work.
#pragma once

#include "forward/visible_surfaces.hpp"
#include "frame/technique.hpp"
#include "irradiance_cache/irradiance_cache.hpp"
#include "irradiance_cache/reflections.hpp"
#include "rsm/light_maps.hpp"

#include <algorithm>
#include <optional>

namespace lucerna {

class IrradianceCacheFrame final : public FrameTechnique {
 public:
  static bool isNeeded(const RenderSettings& settings, const SceneFeatures& features);
  /// Whether it gathers light from the lights' maps.
  static bool takesMaps(const RenderSettings& settings, const SceneFeatures& features) {
    return isNeeded(settings, features) && settings.of<IrradianceCacheSettings>().transport == CacheTransport::gather &&
           settings.component != Component::direct;
  }
  /// Boundaries of clouds are not drawn where they are seen through.
  static void prepare(RenderSettings& settings, const Scene& scene);
  explicit IrradianceCacheFrame(const FrameParts& parts);

  std::string surfaceShader() const override { return "irradiance_cache/surface.frag"; }
  gl::ShaderFlags surfaceFlags() const override {
    return gl::with(cache_.pictureFlags(),
                    {{"INDIRECT_SPECULAR", reflections_ && parts_.features.specular},
                     {"BEHIND_MEDIA", Reflections::showsClouds(parts_.features, settings().reflections)}});
  }
  void resize() override;
  bool follow(const SceneChange& change) override;
  void see(gl::TimeQuery& timer, const FrameView& view) override;
  /// Draws depth, unless no work is left for this view.
  bool record(gl::TimeQuery& timer, const FrameView& view, FrameEffort effort) override;
  void bindForShading() const override {
    cache_.bindForLookup();
    if (reflections_) reflections_->bindForShading();
  }
  void collect(bool wait) override { cache_.collect(wait); }
  bool lightChanges() const override { return cache_.settles(); }
  bool isSettled() const override { return settled_; }
  bool lacksLight(std::size_t frames) const override;
  void forget() override;

  void addShares(const InspectedPixel& pixel, PixelInspection& answer) override;
  void addStagePictures(std::vector<StagePicture>& pictures) const override;
  void addLeftOut(std::vector<std::string>& names) const override;
  std::string summary() const override;
  bool previewsMedia() const override { return reflections_ && Bodies::isNeeded(parts_.features); }
  double largestIterations() const override {
    return std::max(cache_.mostIterations(), reflections_ ? reflections_->largestIterations() : 0.0);
  }
  double iterationsOfPixel() const override { return 24.0; }
  std::size_t gpuBytes() const override {
    return (maps_ ? maps_->gpuBytes() : 0) + visible_.gpuBytes() + cache_.gpuBytes() +
           (reflections_ ? reflections_->gpuBytes() : 0);
  }

  const IrradianceCache& cache() const { return cache_; }
  /// Bounds for the last view (IrradianceCache). The first: only with CacheTransport::gather.
  Image gatheredAtPixels() const {
    return cache_.gatheredAtPixels(maps_ ? maps_->outputs() : std::vector<ReflectiveShadowMap::Outputs>{});
  }
  /// `cascades`: of the cells, blended over `blendBand`, as of a light propagation volume.
  Image readFromCells(const CascadeSettings& cascades, float blendBand, int paths) const;

 private:
  void makeReflections();
  void recordSurfaces(gl::TimeQuery& timer, const FrameView& view);
  IrradianceCache::Inputs inputs(const FrameView& view, const std::vector<ReflectiveShadowMap::Outputs>& maps,
                                 bool mapsAreNew, bool fades) const;
  bool hasMaps() const { return maps_ && maps_->count() > 0; }
  const IrradianceCacheSettings& settings() const { return parts_.settings.of<IrradianceCacheSettings>(); }

  FrameParts parts_;
  std::optional<LightMaps> maps_;  ///< if they use maps
  VisibleSurfaces visible_;
  IrradianceCache cache_;
  std::optional<Reflections> reflections_;  ///< if something reflects
  /// The view for which they were last updated, the update that first saw all of it, and whether no work is left.
  glm::dvec3 volumePosition_{0.0}, volumeDirection_{0.0};
  std::uint32_t since_ = 0;
  bool settled_ = false;
  std::vector<Bounds> meshes_;  ///< of each, if they move: where it is
};

/// Null if the technique is another.
inline const IrradianceCache* cacheOf(const FrameTechnique* technique) {
  const auto* frame = dynamic_cast<const IrradianceCacheFrame*>(technique);
  return frame ? &frame->cache() : nullptr;
}

}  // namespace lucerna
