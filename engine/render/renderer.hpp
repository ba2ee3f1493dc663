// A frame, from a scene and a camera to an HDR picture and a display picture: the techniques in order, each built only where needed.
#pragma once

#include "base/image.hpp"
#include "forward/environment_view.hpp"
#include "forward/gpu_scene.hpp"
#include "forward/layered_depth.hpp"
#include "forward/local_lights.hpp"
#include "forward/shadow_map.hpp"
#include "forward/sun_cascades.hpp"
#include "forward/sun_frustum.hpp"
#include "forward/visible_surfaces.hpp"
#include "gl/context.hpp"
#include "gl/pieces.hpp"
#include "gl/program.hpp"
#include "gl/time_query.hpp"
#include "lpv/light_propagation_volume.hpp"
#include "lpv/receivers.hpp"
#include "radiosity/radiosity_view.hpp"
#include "render/direct_rays.hpp"
#include "rsm/lamp_choice.hpp"
#include "rsm/reflective_shadow_map.hpp"
#include "rsm/rsm_gather.hpp"
#include "scene/needs.hpp"
#include "settings/render_settings.hpp"

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
  /// A scene far from the origin is moved to it (scene/place.hpp), with cameras and lamps, so that its picture does not depend on its position.
  Renderer(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene, const RenderSettings& settings);

  /// One frame: the HDR picture, then the display picture. Stages are timed.
  void render(const Camera& camera) { render(camera, camera); }
  /// The same with the light propagation volume placed for another view, to separate flicker from motion.
  void render(const Camera& camera, const Camera& volumeCamera);

  /// The picture that frames of this view converge to: everything accumulated over frames, at once.
  void renderToTheEnd(const Camera& camera);

  Image readRadiance() const;   ///< linear, scene units, top row first
  Bitmap readDisplay() const;   ///< tone mapped, sRGB, top row first
  const gl::Framebuffer& displayFramebuffer() const { return displayTarget_; }
  const gl::Texture& display() const { return display_; }    ///< of that framebuffer
  const gl::Texture& radiance() const { return radiance_; }  ///< linear, scene units, bottom row first
  glm::ivec2 size() const { return settings_.size; }
  void resize(glm::ivec2 size);
  void setExposure(float exposure) { exposure_ = exposure; }
  float exposure() const { return exposure_; }

  gl::TimeQuery& timer() { return timer_; }
  std::size_t gpuBytes() const;
  const SceneNeeds& needs() const { return needs_; }
  const RenderSettings& settings() const { return settings_; }
  const LpvReceivers* receivers() const { return receivers_ ? &*receivers_ : nullptr; }
  /// Whether more frames of the same view would show the same: nothing is added up any more.
  bool isSettled() const { return !receivers_ || settled_; }
  /// All that is kept from frame to frame is dropped: the next one begins as the first did.
  void forget();
  const LightPropagationVolume* lpv() const { return lpv_ ? &*lpv_ : nullptr; }
  const RadiosityView* radiosity() const { return radiosity_.get(); }
  /// Turns, about, of the largest submission of the last frame's shadow rays; 0 without any.
  double largestTurns() const { return pieces_ ? pieces_->largestTurns() : 0.0; }
  const RsmGather* gather() const { return gather_ ? &*gather_ : nullptr; }
  /// Waits for everything still on its way, times and counts; for the end of a run, not for a frame.
  void drain();
  /// Names of features that were left out.
  std::vector<std::string> leftOut() const;

 private:
  const Scene& aboutOrigin(const Scene& scene);  ///< makes moved_ where that is another
  void allocateTargets();
  /// Shadow maps and reflective shadow maps do not depend on the camera: lights and geometry stand still.
  bool mapsAreMade() const { return settings_.reuse && mapsMade_; }
  void recordShadows(const Camera& camera);
  void recordVolume(const Camera& volumeCamera);
  bool recordReceivers(const Camera& camera, const Camera& volumeCamera, const glm::dmat4& clip);  ///< whether depth was drawn
  const std::vector<ReflectiveShadowMap::Outputs>& recordReflectiveShadowMaps();
  std::vector<ReflectiveShadowMap::Outputs> recordCameraMap(const Camera& camera);  ///< empty where none is needed

  RenderSettings settings_;
  std::uint64_t frames_ = 0;
  SceneNeeds needs_;
  glm::dvec3 origin_;                ///< of what is drawn, in the scene's coordinates
  std::optional<Scene> moved_;       ///< the scene about it, where that is not 0
  bool showsDirect_;  ///< direct light of any kind
  bool showsLpv_, showsReceivers_, showsGather_;
  float exposure_;
  gl::TimeQuery timer_;
  std::unique_ptr<RadiosityView> radiosity_;  ///< before gpuScene_, which draws its patches
  std::optional<gl::PieceSize> pieces_;       ///< rows of pixels a submission, of the last frame's shadow rays
  std::optional<DirectRays> directRays_;      ///< direct light of radiosity by pixels
  GpuScene gpuScene_;
  SunFrustum sunFrustum_;
  gl::Buffer frameConstants_;
  gl::VertexArray noAttributes_;
  SurfacePrograms depthPrograms_, surfacePrograms_;
  const gl::Program* toneMap_ = nullptr;
  std::optional<ShadowMap> shadowMap_;
  std::optional<LayeredDepth> sunCascades_;  ///< instead of shadowMap_
  gl::Buffer sunCascadeConstants_;
  std::vector<LightViews> spots_, points_;
  std::optional<LocalLights> localLights_;
  std::vector<ReflectiveShadowMap> rsms_;    ///< one a light: the sun, the spots, the points
  std::vector<ReflectiveShadowMap::Outputs> rsmOutputs_;  ///< since they were last drawn
  bool mapsMade_ = false;
  std::vector<shared::LpvCascade> volumeCascades_;  ///< that the propagated light is of
  std::optional<ReflectiveShadowMap> cameraMap_;  ///< what the camera sees, for the geometry volume
  std::optional<LightPropagationVolume> lpv_;
  std::optional<LpvReceivers> receivers_;
  /// Of the receivers: the view that they were brought up to date for, since which frame, and whether nothing of it waits any more.
  glm::dmat4 receivedClip_{0.0};
  glm::dvec3 receivedVolumePosition_{0.0}, receivedVolumeDirection_{0.0};
  std::uint32_t receivedSince_ = 0;
  bool settled_ = false;
  int rounds_ = 1;  ///< of paths in a frame
  bool toTheEnd_ = false;  ///< nothing fades in
  std::optional<VisibleSurfaces> visible_;  ///< of techniques that start from pixels
  std::optional<RsmGather> gather_;
  std::optional<EnvironmentView> environmentView_;
  gl::Texture radiance_, depth_, display_;
  gl::Framebuffer depthTarget_, radianceTarget_, displayTarget_;
};

}  // namespace lucerna
