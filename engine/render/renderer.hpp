// A frame, from a scene and a camera to an HDR picture and a display picture, built only as far as it is needed.
//
// Renderer::render reads from top to bottom: direct light's shadow maps, the technique's own passes, shading (or the
// path tracer's film), the environment, what the technique adds to the picture, tone mapping. A technique is a folder
// of its own (frame/technique.hpp); the frame knows none by name.
#pragma once

#include "base/image.hpp"
#include "forward/environment_view.hpp"
#include "forward/gpu_scene.hpp"
#include "forward/local_lights.hpp"
#include "forward/sun_frustum.hpp"
#include "forward/sun_shadow.hpp"
#include "frame/technique.hpp"
#include "gl/context.hpp"
#include "gl/lines.hpp"
#include "gl/picture_chunks.hpp"
#include "gl/program.hpp"
#include "gl/time_query.hpp"
#include "scene/features.hpp"
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

  /// What lit a pixel (counted from the top left) of the last frame, which must have been of this view. Compiles,
  /// allocates and waits.
  PixelInspection inspect(gl::ProgramLibrary& programs, const Camera& camera, glm::ivec2 pixel);

  /// The picture that frames of this view converge to: everything accumulated over frames, at once.
  void renderToTheEnd(const Camera& camera);

  Image readRadiance() const;  ///< linear, scene units, top row first
  Bitmap readDisplay() const;  ///< tone mapped, sRGB, top row first
  const gl::Framebuffer& displayFramebuffer() const { return displayTarget_; }
  const gl::Texture& display() const { return display_; }  ///< of that framebuffer
  /// Depth of the last frame; null for path tracing, which draws none.
  const gl::Texture* depth() const { return gpuScene_ ? &depth_ : nullptr; }
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
  /// Null if the frame needs none. volumeOf(), cacheOf() and others give what is in it.
  const FrameTechnique* technique() const { return technique_.get(); }
  /// Whether more frames of the same view would look the same: nothing accumulates any more.
  bool isSettled() const { return !technique_ || technique_->isSettled(); }
  /// Drops everything kept from frame to frame: the next frame starts like the first.
  void forget();
  /// Estimated iterations of the largest submission (gl/chunks.hpp) of any frame so far; of the path tracer, which
  /// counts them, PathTracer::submissions().
  double largestIterations() const;
  /// Waits for all pending results, times and counts; for the end of a run, not for a frame.
  void drain();
  /// Names of the omitted features.
  std::vector<std::string> leftOut() const;

 private:
  const Scene& aboutOrigin(const Scene& scene);  ///< makes moved_ if it must be moved
  FrameParts parts(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene) const;
  void makeShadowMaps(gl::ProgramLibrary& programs);
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
  /// Shading programs; inspected: the variant with which one pixel records its terms.
  SurfacePrograms surfacePrograms(gl::ProgramLibrary& programs, bool inspected) const;
  InspectedTerms drawInspected(gl::ProgramLibrary& programs, const FrameView& view, glm::ivec2 fromBelow);
  void addDirectShares(const InspectedTerms& terms, PixelInspection& answer);
  std::span<const GeometryTechnique::Sides> sides() const;
  void warnOfWhatIsLeftOut(const TechniqueEntry& technique) const;
  bool showsDirect() const;  ///< direct light of any kind, by shadow maps

  RenderSettings settings_;
  std::uint64_t frames_ = 0;
  SceneFeatures features_;
  glm::dvec3 origin_;  ///< of the drawn coordinates, in the scene's coordinates
  std::optional<Scene> moved_;  ///< the scene relative to it, if it is not 0
  float sceneExposure_, exposure_;
  gl::TimeQuery timer_;
  std::unique_ptr<FrameTechnique> technique_;  ///< before gpuScene_, which may draw its geometry
  GeometryTechnique* geometry_ = nullptr;  ///< the technique, if it is one of these
  PictureTechnique* picture_ = nullptr;
  std::optional<GpuScene> gpuScene_;  ///< not with a PictureTechnique
  SunFrustum sunFrustum_;
  std::vector<LightViews> spots_, points_;  ///< with shadow maps
  std::vector<LightViews> plainLamps_;  ///< without
  gl::Buffer frameConstants_;
  gl::VertexArray noAttributes_;
  gl::Texture radiance_, depth_, display_;
  gl::Framebuffer depthTarget_, radianceTarget_, displayTarget_;
  SurfacePrograms depthPrograms_, surfacePrograms_;
  const gl::Program* toneMap_ = nullptr;

  // Shadow maps of direct light. They are drawn once, except for the sun's cascades, which follow the camera.
  std::optional<SunShadow> sunShadow_;
  std::optional<LocalLights> localLights_;
  bool shadowsMade_ = false;

  std::optional<EnvironmentView> environmentView_;
  gl::PictureChunks surfaceChunks_;
};

}  // namespace lucerna
