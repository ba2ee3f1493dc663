// What the frame's techniques are made from, and what they are given each frame (no GL calls).
#pragma once

#include "forward/gpu_scene.hpp"
#include "forward/light_views.hpp"
#include "forward/sun_frustum.hpp"
#include "gl/context.hpp"
#include "gl/program.hpp"
#include "scene/needs.hpp"
#include "settings/render_settings.hpp"

#include <vector>

namespace lucerna {

/// Of the frame, which keeps all of it: it outlives the techniques.
struct FrameParts {
  const gl::Context& context;
  gl::ProgramLibrary& programs;
  const RenderSettings& settings;
  const SceneNeeds& needs;
  const Scene& scene;  ///< as loaded
  const glm::dvec3& origin;  ///< of what is drawn, in the scene's coordinates
  const GpuScene& drawn;
  const SunFrustum& sun;
  const std::vector<LightViews>& spots;
  const std::vector<LightViews>& points;
};

/// Positions are those of what is drawn, about FrameParts::origin.
struct FrameView {
  Camera camera;
  Camera volumeCamera;  ///< that the light propagation volume is placed for
  glm::dmat4 clip;  ///< from world
  glm::mat4 clipFromWorld;
  glm::vec3 viewPoint;

  GpuScene::View drawn() const { return {&clipFromWorld, &viewPoint}; }
};

/// How much of a picture that is added up over frames a frame makes.
struct FrameEffort {
  bool wholePicture = false;  ///< all samples at once
  bool fadesIn = true;  ///< what is new is shown by and by, so that nothing flickers while the camera moves
};

}  // namespace lucerna
