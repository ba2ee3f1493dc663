// Spot and omnidirectional lights of a scene for forward shading: their uniform block and their shadow maps.
#pragma once

#include "forward/layered_depth.hpp"
#include "forward/light_views.hpp"
#include "shared/lights.h"

#include <optional>
#include <vector>

namespace lucerna {

class LocalLights {
 public:
  struct Settings {
    int spotSize = 1024;  ///< texels per side of a spot's shadow map
    int pointSize = 512;  ///< texels per side of each of the six faces of an omnidirectional light's
    int shadows = 4;  ///< lamps of a kind with a shadow map, at most: those of which surfaces reflect most
                      ///< (rsm/lamp_choice.hpp); 0 to LIGHTS_MAX_SHADOWS
    bool penumbrae = true;  ///< of lamps that have a size
  };
  static bool isNeeded(const SceneFeatures& features) { return features.spotLights || features.pointLights; }

  /// Where the lamps are; maps are kept where as many lamps have some. `plain`: those without maps.
  void place(gl::ProgramLibrary& programs, const GpuScene& scene, const Settings& settings,
             const std::vector<LightViews>& spots, const std::vector<LightViews>& points,
             const std::vector<LightViews>& plain);

  /// Whether maps of a kind are compared with the receiver's plane: any lamp has a size, and so a penumbra, or is far
  /// away, where the offset of receivers would exceed what stands on a wide floor. All of a kind are filtered alike.
  bool areSpotsSoft() const { return spotsAreSoft_; }
  bool arePointsSoft() const { return pointsAreSoft_; }
  bool hasSpots() const { return spotShadows_.has_value(); }
  bool hasPoints() const { return pointShadows_.has_value(); }
  bool hasPlainLamps() const { return plain_.bytes() > 0; }
  void recordSpots(const GpuScene& scene) { spotShadows_->record(scene, spotViews_); }
  void recordPoints(const GpuScene& scene) { pointShadows_->record(scene, pointViews_); }
  void forget();
  /// Binds blocks 3 and PLAIN_LAMPS_BINDING, and units 10 (spots) and 11 (points) for shaders/forward/lights.glsl.
  void bindForShading() const;
  std::size_t gpuBytes() const;

 private:
  bool spotsAreSoft_ = false, pointsAreSoft_ = false;
  std::vector<LayeredDepth::View> spotViews_, pointViews_;
  std::optional<LayeredDepth> spotShadows_;  ///< a layer per spot
  std::optional<LayeredDepth> pointShadows_;  ///< six layers per light, a cube map
  gl::Buffer constants_;
  gl::Buffer plain_;  ///< lamps without shadows, if any
};

}  // namespace lucerna
