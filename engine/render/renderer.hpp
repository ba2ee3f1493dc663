// A frame, from a scene and a camera to an HDR picture and a display picture: the techniques in order, each built only
// if needed.
//
// Renderer::render reads from top to bottom: direct light's shadow maps, the technique's own passes, shading (or the
// path tracer's film), the environment and tone mapping. A technique is one object (rsm_frame, lpv_frame,
// cache_frame, radiosity_frame, path_frame) with its stages, its inputs to shading and its bytes.
#pragma once

#include "base/image.hpp"
#include "forward/environment_view.hpp"
#include "forward/gpu_scene.hpp"
#include "forward/layered_depth.hpp"
#include "forward/local_lights.hpp"
#include "forward/shadow_map.hpp"
#include "forward/sun_cascades.hpp"
#include "forward/sun_frustum.hpp"
#include "gl/context.hpp"
#include "gl/lines.hpp"
#include "gl/program.hpp"
#include "gl/time_query.hpp"
#include "lpv/light_shafts.hpp"
#include "render/lpv_frame.hpp"
#include "render/path_frame.hpp"
#include "render/pixel_answer.hpp"
#include "render/radiosity_frame.hpp"
#include "render/irradiance_cache_frame.hpp"
#include "render/rsm_frame.hpp"
#include "render/stage_picture.hpp"
#include "scene/features.hpp"
#include "settings/render_settings.hpp"
#include "shared/frame.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lucerna {

class Renderer {
 public:
  /// Compiles and allocates only what `scene` and `settings` need. The scene must outlive the renderer.
  /// A scene far from the origin is moved to it (scene/place.hpp), with cameras and lamps, so that its picture does not
  /// depend on its position.
  Renderer(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene,
           const RenderSettings& settings);
  Renderer(const Renderer&) = delete;  // its techniques refer to it
  Renderer& operator=(const Renderer&) = delete;

  /// One frame: the HDR picture, then the display picture. Stages are timed.
  void render(const Camera& camera) { render(camera, camera); }
  /// The same with the light propagation volume placed for another view, to separate flicker from motion.
  void render(const Camera& camera, const Camera& volumeCamera);

  /// What lit a pixel (counted from the top left) of the last frame, which must have been of this view; `scene`: as
  /// passed to the constructor. Compiles, allocates and waits.
  PixelAnswer ask(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene, const Camera& camera,
                  glm::ivec2 pixel);

  /// The picture that frames of this view converge to: everything accumulated over frames, at once.
  void renderToTheEnd(const Camera& camera);

  Image readRadiance() const;  ///< linear, scene units, top row first
  Bitmap readDisplay() const;  ///< tone mapped, sRGB, top row first
  const gl::Framebuffer& displayFramebuffer() const { return displayTarget_; }
  const gl::Texture& display() const { return display_; }  ///< of that framebuffer
  /// Depth of the last frame; null for path tracing, which draws none.
  const gl::Texture* depth() const { return path_ ? nullptr : &depth_; }
  /// For lines over the last frame, about origin(). `bounds`: the scene's.
  gl::Lines::View linesView(const Camera& camera, const Bounds& bounds) const;
  const glm::dvec3& origin() const { return origin_; }
  const gl::Texture& radiance() const { return radiance_; }  ///< linear, scene units, bottom row first
  glm::ivec2 size() const { return settings_.size; }
  void resize(glm::ivec2 size);
  /// Applies the settings whose cost is SettingCost::uniform (exposure, frame.reuse); others need a new Renderer.
  void apply(const RenderSettings& settings);
  void setExposure(float exposure) { exposure_ = exposure; }
  float exposure() const { return exposure_; }

  gl::TimeQuery& timer() { return timer_; }
  std::size_t gpuBytes() const;
  const SceneFeatures& features() const { return features_; }
  const RenderSettings& settings() const { return settings_; }
  std::vector<StagePicture> stagePictures() const;
  const IrradianceCache* irradianceCache() const { return cache_ ? &cache_->cache() : nullptr; }
  const IrradianceCacheFrame* irradianceCacheFrame() const { return cache_ ? &*cache_ : nullptr; }
  /// Whether more frames of the same view would look the same: nothing accumulates any more.
  bool isSettled() const { return (!cache_ || cache_->isSettled()) && (!path_ || path_->isSettled()); }
  /// Drops everything kept from frame to frame: the next frame starts like the first.
  void forget();
  const LightPropagationVolume* lpv() const { return lpv_ ? &lpv_->volume() : nullptr; }
  const RadiosityView* radiosity() const { return radiosity_ ? &radiosity_->view() : nullptr; }
  const RsmGather* gather() const { return rsm_ ? &rsm_->gather() : nullptr; }
  const PathTracer* path() const { return path_ ? &path_->tracer() : nullptr; }
  /// Estimated iterations of the largest submission (gl/chunks.hpp) of any frame so far; of the path tracer, which
  /// counts them, PathTracer::submissions().
  double largestIterations() const;
  /// Waits for all pending results, times and counts; for the end of a run, not for a frame.
  void drain();
  /// Names of the omitted features.
  std::vector<std::string> leftOut() const;

 private:
  const Scene& aboutOrigin(const Scene& scene);  ///< makes moved_ if it must be moved
  void makeShadowMaps(gl::ProgramLibrary& programs);
  bool asksForShafts() const;
  void makeShafts(gl::ProgramLibrary& programs, const Haze& haze);
  void recordShafts(const FrameView& view);
  void loadPrograms(gl::ProgramLibrary& programs);
  void allocateTargets();
  void renderFrame(const Camera& camera, const Camera& volumeCamera, FrameEffort effort);
  FrameView viewOf(const Camera& camera, const Camera& volumeCamera) const;
  void bindFrameConstants(const FrameView& view);
  void bindFrameConstants(const shared::FrameConstants& constants);
  void recordShadows(const Camera& camera);
  void shade(const FrameView& view, bool depthIsDrawn);
  double iterationsOfSurface() const;  ///< of a pixel of a raster technique
  void bindForShading() const;
  /// Shading programs; asked: the variant with which one pixel records its terms.
  SurfacePrograms surfacePrograms(gl::ProgramLibrary& programs, bool asked) const;
  AskedTerms drawAsked(gl::ProgramLibrary& programs, const FrameView& view, glm::ivec2 fromBelow);
  void answerOfForward(gl::ProgramLibrary& programs, const FrameView& view, const AskedTerms& terms,
                       glm::ivec2 fromBelow, PixelAnswer& answer);
  void answerOfPatches(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene,
                       const AskedTerms& terms, PixelAnswer& answer);
  /// Calls `visit` with each existing technique.
  template <class Self, class Visit>
  static void forTechniques(Self& self, const Visit& visit) {
    const auto visitIfThere = [&](auto& technique) {
      if (technique) visit(*technique);
    };
    visitIfThere(self.rsm_), visitIfThere(self.lpv_), visitIfThere(self.cache_);
    visitIfThere(self.radiosity_), visitIfThere(self.path_);
  }
  bool showsDirect() const;  ///< direct light of any kind, by shadow maps
  bool showsSun() const { return shadowMap_ || sunCascades_; }

  RenderSettings settings_;
  std::uint64_t frames_ = 0;
  SceneFeatures features_;
  glm::dvec3 origin_;  ///< of the drawn coordinates, in the scene's coordinates
  std::optional<Scene> moved_;  ///< the scene relative to it, if it is not 0
  float sceneExposure_, exposure_;
  gl::TimeQuery timer_;
  std::optional<RadiosityFrame> radiosity_;  ///< before gpuScene_, which draws its patches
  std::optional<GpuScene> gpuScene_;  ///< not for path tracing, which has its own copy of the scene
  SunFrustum sunFrustum_;
  std::vector<LightViews> spots_, points_;
  gl::Buffer frameConstants_;
  gl::VertexArray noAttributes_;
  gl::Texture radiance_, depth_, display_;
  gl::Framebuffer depthTarget_, radianceTarget_, displayTarget_;
  SurfacePrograms depthPrograms_, surfacePrograms_;
  const gl::Program* toneMap_ = nullptr;

  // Shadow maps of direct light. They are drawn once, except for the sun's cascades, which follow the camera.
  std::optional<ShadowMap> shadowMap_;
  std::optional<LayeredDepth> sunCascades_;  ///< instead of shadowMap_
  gl::Buffer sunCascadeConstants_;
  std::optional<LocalLights> localLights_;
  bool shadowsMade_ = false;

  // At most one of them, besides radiosity_.
  std::optional<RsmFrame> rsm_;
  std::optional<LpvFrame> lpv_;
  std::optional<IrradianceCacheFrame> cache_;
  std::optional<PathFrame> path_;
  std::optional<EnvironmentView> environmentView_;
  std::optional<LightShafts> shafts_;  ///< added to the finished picture
  gl::PictureChunks surfaceChunks_;
};

}  // namespace lucerna
