// Inputs of the frame's techniques, at construction and in each frame (no GL calls).
#pragma once

#include "forward/inspected_pixel.hpp"
#include "forward/gpu_scene.hpp"
#include "forward/light_views.hpp"
#include "forward/sun_frustum.hpp"
#include "frame/render_settings.hpp"
#include "gl/context.hpp"
#include "gl/program.hpp"
#include "gl/time_query.hpp"
#include "rays/shadow_rays.hpp"
#include "scene/features.hpp"

#include <optional>
#include <vector>

namespace lucerna {

/// Owned by the frame, which outlives its technique.
struct FrameParts {
  const gl::Context& context;
  gl::ProgramLibrary& programs;
  const RenderSettings& settings;
  const SceneFeatures& features;
  const Scene& scene;  ///< as loaded
  const glm::dvec3& origin;  ///< of the drawn coordinates, in the scene's coordinates
  const std::optional<GpuScene>& gpuScene;  ///< made after a technique that draws geometry or pictures of its own
  const SunFrustum& sun;
  const std::vector<LightViews>& spots;
  const std::vector<LightViews>& points;
  const std::optional<SunShadow>& sunShadow;
  TracedScene& traced;  ///< the scene for rays
  const gl::Texture& radiance;  ///< the frame's picture, RGBA, linear, scene units; depth of the same size
  const gl::Texture& depth;
  const gl::Framebuffer& radianceTarget;
  const gl::VertexArray& noAttributes;

  const GpuScene& drawn() const { return *gpuScene; }
};

/// Positions are in the drawn coordinates, relative to FrameParts::origin.
struct FrameView {
  Camera camera;
  Camera volumeCamera;  ///< determines where grids around the camera are placed
  glm::dmat4 clip;  ///< from world
  glm::mat4 clipFromWorld;
  glm::vec3 viewPoint;
  int sample = 0;  ///< number of the pixel's sample, from 0, to draw other random numbers
  glm::dvec2 offset{0.0};  ///< of that sample from the pixel's centre, in pixels to the right and up; in `clip` already
  bool isNew = true;  ///< not drawn before since the camera moved

  GpuScene::View drawn() const { return {&clipFromWorld, &viewPoint}; }
};

/// How much of an accumulated picture one frame computes.
struct FrameEffort {
  bool wholePicture = false;  ///< all samples at once
  bool fadesIn = true;  ///< new contributions fade in, so that nothing flickers while the camera moves
  bool isLive = false;  ///< shown after others, which may show through while the view moves
  bool isFurtherSample = false;  ///< of a view that this frame has drawn: light that does not depend on it is known
};

/// A pixel of the last frame that is drawn again, to say what lit it.
struct InspectedPixel {
  gl::TimeQuery& timer;
  const FrameView& view;
  const InspectedTerms& terms;  ///< as shading recorded them
  glm::ivec2 fromBelow;
};

}  // namespace lucerna
