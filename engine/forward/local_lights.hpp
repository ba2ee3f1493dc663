// Spot and omnidirectional lights of a scene for forward shading: their uniform block and their shadow maps. Lights do
// not move.
#pragma once

#include "forward/layered_depth.hpp"
#include "forward/light_views.hpp"
#include "shared/lights.h"

#include <optional>
#include <vector>

namespace lucerna {

class LocalLights {
 public:
  /// Maximum number of lamps of each kind, the size of the shaders' arrays. A scene may have more: the frame keeps
  /// those of which surfaces reflect most (rsm/lamp_choice.hpp) and names the others.
  static constexpr std::size_t kMostSpots = LIGHTS_MAX_SPOTS, kMostPoints = LIGHTS_MAX_POINTS;
  struct Settings {
    int spotSize = 1024;  ///< texels per side of a spot's shadow map
    int pointSize = 512;  ///< texels per side of each of the six faces of an omnidirectional light's
  };
  static bool isNeeded(const SceneFeatures& features) { return features.spotLights || features.pointLights; }

  LocalLights(gl::ProgramLibrary& programs, const GpuScene& scene, const Settings& settings,
              const std::vector<LightViews>& spots, const std::vector<LightViews>& points);

  bool hasSpots() const { return spotShadows_.has_value(); }
  bool hasPoints() const { return pointShadows_.has_value(); }
  void recordSpots(const GpuScene& scene) const { spotShadows_->record(scene, spotViews_); }
  void recordPoints(const GpuScene& scene) const { pointShadows_->record(scene, pointViews_); }
  /// Binds block 3 and units 10 (spots) and 11 (points) for shaders/forward/lights.glsl.
  void bindForShading() const;
  std::size_t gpuBytes() const;

 private:
  std::vector<LayeredDepth::View> spotViews_, pointViews_;
  std::optional<LayeredDepth> spotShadows_;  ///< a layer per spot
  std::optional<LayeredDepth> pointShadows_;  ///< six layers per light, a cube map
  gl::Buffer constants_;
};

}  // namespace lucerna
