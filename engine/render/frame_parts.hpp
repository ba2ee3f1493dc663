// Inputs of the frame's techniques, at construction and in each frame (no GL calls).
#pragma once

#include "forward/gpu_scene.hpp"
#include "forward/light_views.hpp"
#include "forward/sun_frustum.hpp"
#include "gl/context.hpp"
#include "gl/program.hpp"
#include "scene/features.hpp"
#include "settings/render_settings.hpp"

#include <vector>

namespace lucerna {

/// Owned by the frame, which outlives its techniques.
struct FrameParts {
  const gl::Context& context;
  gl::ProgramLibrary& programs;
  const RenderSettings& settings;
  const SceneFeatures& features;
  const Scene& scene;  ///< as loaded
  const glm::dvec3& origin;  ///< of the drawn coordinates, in the scene's coordinates
  const GpuScene& drawn;
  const SunFrustum& sun;
  const std::vector<LightViews>& spots;
  const std::vector<LightViews>& points;
};

/// Positions are in the drawn coordinates, relative to FrameParts::origin.
struct FrameView {
  Camera camera;
  Camera volumeCamera;  ///< determines where the light propagation volume is placed
  glm::dmat4 clip;  ///< from world
  glm::mat4 clipFromWorld;
  glm::vec3 viewPoint;

  GpuScene::View drawn() const { return {&clipFromWorld, &viewPoint}; }
};

/// How much of an accumulated picture one frame computes.
struct FrameEffort {
  bool wholePicture = false;  ///< all samples at once
  bool fadesIn = true;  ///< new contributions fade in, so that nothing flickers while the camera moves
};

}  // namespace lucerna
