// Shadows of the sun: one map of the whole scene, or cascades along the view.
//
// Input: the scene; for cascades a camera. Output: maps and constants that shaders/forward/sun_shadow.glsl reads.
#pragma once

#include "forward/layered_depth.hpp"
#include "forward/shadow_map.hpp"
#include "forward/sun_cascades.hpp"

#include <array>
#include <optional>
#include <string_view>

namespace lucerna {

/// Of shadow maps: a tent of 3x3 texels, or percentage-closer soft shadows of the sun's disc and of lamps' balls
/// [Fernando2005].
enum class ShadowFilter { tent, pcss };
constexpr std::array<std::string_view, 2> namesOf(ShadowFilter) { return {"tent", "pcss"}; }

class SunShadow {
 public:
  struct Settings {
    int size = ShadowMap::Settings{}.size;  ///< texels per side of the map, or of each cascade
    SunCascadeSettings cascades;
    ShadowFilter filter = ShadowFilter::pcss;  ///< of lamps' maps too
    int taps = 16;  ///< in a penumbra; half as many look for what casts it
  };
  static bool isNeeded(const SceneFeatures& features) { return ShadowMap::isNeeded(features); }

  SunShadow(gl::ProgramLibrary& programs, const GpuScene& scene, const Settings& settings);

  /// Whether the map depends on the camera, and so must be drawn again when it moves.
  bool followsCamera() const { return cascades_.has_value(); }
  /// Draws what has changed since the last time. `whole`: of the scene; aspect: of the picture, width over height;
  /// near: the camera's near plane, scene units.
  void record(const GpuScene& scene, const SunFrustum& whole, const Camera& camera, double aspect, double near);
  void forget();
  void bindForShading() const;

  /// For the flag SUN_CASCADES: 0 where one map serves the whole scene.
  int cascades() const { return cascades_ ? settings_.cascades.cascades : 0; }
  const gl::Texture& depth() const { return cascades_ ? cascades_->depth() : map_->depth(); }
  /// Offset along the normal at which a point reads a map with texels of that side, scene units.
  static float normalOffset(double texel);
  std::size_t gpuBytes() const;

 private:
  Settings settings_;
  std::optional<ShadowMap> map_;
  std::optional<LayeredDepth> cascades_;  ///< instead of map_
  gl::Buffer constants_;  ///< of the cascades
};

}  // namespace lucerna
