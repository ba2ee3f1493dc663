// A frame, from a scene and a camera to an HDR picture and a display picture, built only as far as it is needed.
//
// Renderer::render reads from top to bottom: direct light's shadow maps, the technique's own passes, shading (or the
// path tracer's film), the environment, what the technique adds to the picture, tone mapping. A technique is a folder
// of its own (frame/technique.hpp); the frame knows none by name.
#pragma once

#include "base/image.hpp"
#include "forward/antialiasing.hpp"
#include "forward/environment_view.hpp"
#include "forward/gpu_scene.hpp"
#include "forward/local_lights.hpp"
#include "forward/motion_samples.hpp"
#include "forward/object_motion.hpp"
#include "forward/sun_frustum.hpp"
#include "forward/sun_shadow.hpp"
#include "frame/technique.hpp"
#include "gl/context.hpp"
#include "gl/lines.hpp"
#include "gl/picture_chunks.hpp"
#include "gl/program.hpp"
#include "gl/split_timer.hpp"
#include "gl/time_query.hpp"
#include "rays/shadow_rays.hpp"
#include "scene/features.hpp"
#include "scene/motion.hpp"
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

  /// One frame: the HDR picture, then the display picture. Stages are timed. With RenderSettings::pixelSamples frames
  /// of a view that stands still are added up, and once it isSettled() nothing is drawn any more.
  void render(const Camera& camera) { render(camera, camera); }
  /// The same with the light propagation volume placed for another view, to separate flicker from motion.
  void render(const Camera& camera, const Camera& volumeCamera);

  /// One frame of all samples of each pixel, on its own: its edges do not depend on the frames before.
  void renderSamples(const Camera& camera, const Camera& volumeCamera);

  /// What lit a pixel's centre (counted from the top left) in the last frame, which must have been of this view.
  /// Compiles, allocates and waits.
  PixelInspection inspect(gl::ProgramLibrary& programs, const Camera& camera, glm::ivec2 pixel);

  /// The picture that frames of this view converge to: everything accumulated over frames, at once; the same bits on
  /// every run.
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
  const gl::Texture& radiance() const { return *shown_; }  ///< linear, scene units, bottom row first
  glm::ivec2 size() const { return settings_.size; }
  void resize(glm::ivec2 size);
  /// Applies the settings whose cost is SettingCost::uniform; others need a new Renderer.
  void apply(const RenderSettings& settings);
  /// The scene that it was made of is posed at another time (scene/motion.hpp): textures and programs are kept, the
  /// rest is made anew as far as the change asks for. False: a new Renderer is needed, as other features are, or a
  /// solution came from a file.
  bool follow(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene, const SceneChange& change);
  /// Samples of a pixel that each frame has while the view or the scene moves.
  int motionSamples() const;
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
  bool isSettled() const;
  /// Drops everything kept from frame to frame: the next frame starts like the first.
  void forget();
  /// Estimated iterations of the largest submission (gl/chunks.hpp) of any frame so far; of the path tracer, which
  /// counts them, PathTracer::submissions().
  double largestIterations() const;
  /// Waits for all pending results, times and counts; for the end of a run, not for a frame.
  void drain();
  /// What of the scene the technique does not draw, or draws as something else, with the names of materials. They were
  /// logged, too.
  const std::vector<std::string>& warnings() const { return warnings_; }
  /// Names of the omitted features.
  std::vector<std::string> leftOut() const;

 private:
  const Scene& aboutOrigin(const Scene& scene);  ///< makes moved_ if it must be moved
  FrameParts parts(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene);
  void makeLights(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene,
                  const SceneChange& change = {});
  glm::vec3 shownSky(const Scene& scene) const;
  void chooseLamps(gl::ProgramLibrary& programs);
  void leaveCoarseMapsToRays();
  /// Parts that a picture shows large: their shadows need texels (forward/sun_cascades.hpp).
  std::span<const Bounds> largeParts();
  void makeShadowMaps(gl::ProgramLibrary& programs);
  void loadPrograms(gl::ProgramLibrary& programs);
  void allocateTargets();
  double aspect() const { return static_cast<double>(settings_.size.x) / settings_.size.y; }
  bool accumulates() const { return !picture_ && settings_.pixelSamples > 1; }
  bool beginView(const Camera& camera, const Camera& volumeCamera);
  void drawSample(int sample, FrameEffort effort);
  void drawFrame(const FrameView& view, FrameEffort effort, bool viewIsNew);
  void drawSamples(const Camera& camera, const Camera& volumeCamera, FrameEffort effort);
  void showAccumulated(int sample, bool moves);
  void chooseMotionSamples(int drawn);
  bool lightChanges() const { return technique_ && technique_->lightChanges(); }
  void toneMap();
  void endFrame();
  FrameView viewOf(const Camera& camera, const Camera& volumeCamera, const glm::dvec2& offset = glm::dvec2(0.0)) const;
  void bindFrameConstants(const FrameView& view);
  void bindFrameConstants(const shared::FrameConstants& constants);
  void recordShadows(const Camera& camera, bool viewIsNew);
  void forgetShadows();  ///< all are drawn again
  void drawDepth(const gl::Framebuffer& target, const FrameView& view);
  /// The multisampled target, or the picture itself.
  const gl::Framebuffer& surfaceTarget();
  void shade(const FrameView& view, bool depthIsDrawn);
  double iterationsOfSurface() const;  ///< of a pixel of a raster technique
  void bindForShading() const;
  /// Shading programs; inspected: the variant with which one pixel records its terms.
  SurfacePrograms surfacePrograms(gl::ProgramLibrary& programs, bool inspected) const;
  InspectedTerms drawInspected(gl::ProgramLibrary& programs, const FrameView& view, glm::ivec2 fromBelow);
  void addDirectShares(const InspectedTerms& terms, PixelInspection& answer);
  std::span<const GeometryTechnique::Sides> sides() const;
  void warnOfWhatIsLeftOut(const TechniqueEntry& technique);
  void warnOfWhatIsCut();
  bool showsDirect() const;  ///< direct light of sun or lamps, with shadows
  int rayShadowedLamps() const;  ///< the first of localLights_'s lamps without maps
  bool sunHasPenumbra() const;  ///< in its shadow map
  gl::ShaderFlags shadowFlags() const;  ///< how shading finds what is in the way of sun and lamps

  RenderSettings settings_;
  std::uint64_t frames_ = 0;
  std::vector<std::string> warnings_;
  SceneFeatures features_;
  glm::dvec3 origin_;  ///< of the drawn coordinates, in the scene's coordinates
  std::optional<Scene> moved_;  ///< the scene relative to it, if it is not 0
  float sceneExposure_, exposure_;
  gl::TimeQuery timer_;
  TracedScene traced_;
  std::unique_ptr<FrameTechnique> technique_;  ///< before gpuScene_, which may draw its geometry
  GeometryTechnique* geometry_ = nullptr;  ///< the technique, if it is one of these
  PictureTechnique* picture_ = nullptr;
  std::optional<GpuScene> gpuScene_;  ///< not with a PictureTechnique
  bool surfacesAreNew_ = true;  ///< or cameras; near_ and largeParts_ are of others
  double near_ = 1.0;  ///< distance of the near plane
  std::optional<std::vector<Bounds>> largeParts_;
  SunFrustum sunFrustum_;
  std::vector<LightViews> spots_, points_;  ///< with shadow maps
  std::vector<LightViews> plainLamps_;  ///< without
  gl::Buffer frameConstants_;
  gl::VertexArray noAttributes_;
  gl::Texture radiance_, depth_, display_;
  gl::Framebuffer depthTarget_, radianceTarget_, displayTarget_;
  std::optional<gl::MultisampledTarget> multisampled_;  ///< surfaces are drawn there first; made by the first frame
  SurfacePrograms depthPrograms_, surfacePrograms_;
  const gl::Program* toneMap_ = nullptr;
  const gl::Texture* shown_ = &radiance_;

  // Shadow maps of direct light. They are drawn again where meshes or lights have moved, and the sun's cascades follow
  // the camera.
  std::optional<SunShadow> sunShadow_;
  std::optional<LocalLights> localLights_;
  std::optional<ShadowRays> shadowRays_;  ///< instead of maps
  bool sunShadowMade_ = false, lampShadowsMade_ = false;  ///< as meshes and lights are now

  std::optional<EnvironmentView> environmentView_;
  gl::PictureChunks surfaceChunks_;

  // The view, and its frames for other points of each pixel.
  struct View {
    Camera camera, volumeCamera;
    std::vector<bool> drawn;  ///< samples of the pixel
    bool lacksLight = false;  ///< the last frame was one with light that was still to change
  };
  std::optional<View> view_;
  std::vector<glm::dvec2> samples_;  ///< offsets from pixels' centres
  int nextSample_ = 0;  ///< while light or the view changes
  bool lightMoves_ = false;  ///< since the last frame; or surfaces whose motion is not known
  bool moves_ = false;  ///< the view, in this frame
  MotionSamples motionSamples_;
  gl::SplitTimer sampleTimer_;  ///< of a frame in motion: its first sample, all others
  Antialiasing antialiasing_;
  std::optional<ObjectMotion> objectMotion_;  ///< where meshes have moved in the window
};

}  // namespace lucerna
