// Settings of a picture: the technique, the light components to show, and the settings of every stage (no GL calls).
// render/settings.hpp lists the user settings by key.
#pragma once

#include "base/named_values.hpp"
#include "base/pixel_filter.hpp"
#include "forward/gpu_scene.hpp"
#include "forward/local_lights.hpp"
#include "forward/sun_shadow.hpp"
#include "gl/chunks.hpp"
#include "scene/transport.hpp"

#include <glm/glm.hpp>

#include <any>
#include <array>
#include <map>
#include <optional>
#include <string_view>
#include <typeindex>

namespace lucerna {

enum class Component { all, direct, indirect };
constexpr std::array<std::string_view, 3> namesOf(Component) { return {"all", "direct", "indirect"}; }
/// The light paths in a picture of a component.
constexpr Transport transportOf(Component component) {
  return component == Component::direct     ? Transport::direct
         : component == Component::indirect ? Transport::indirect
                                            : Transport::all;
}

/// `original` is the thesis; `demo` the program published with it, if it differs (the light propagation volume's).
enum class Fidelity { corrected, original, thesis, demo };
constexpr std::array<std::string_view, 4> namesOf(Fidelity) { return {"corrected", "original", "thesis", "demo"}; }

constexpr std::string_view kDefaultTechnique = "irradiance-cache";

/// How direct light of sun and lamps finds what is in its way: shadow maps, or rays (rays/shadow_rays.hpp).
enum class ShadowTransport { map, rays };
constexpr std::array<std::string_view, 2> namesOf(ShadowTransport) { return {"map", "rays"}; }

struct RenderSettings {
  std::string_view technique = kDefaultTechnique;  ///< the name of one in render/techniques.hpp
  Component component = Component::all;
  glm::ivec2 size{1280, 720};
  int pixelSamples = 1;  ///< frames of one view that are added up, each for another point of every pixel
  int multisamples = 1;  ///< points of a pixel at which a frame tells surfaces apart; each is shaded once
  PixelFilter filter = PixelFilter::box;  ///< places them
  int motionSamples = 0;  ///< of them in each frame while the view moves; 0: by their time (MotionSamples)
  bool reprojection = true;  ///< while the view moves, frames before it smooth edges too
  bool reuse = true;  ///< stages with unchanged inputs are not run again; the same picture, bit by bit
  bool wholePictures = false;  ///< all are drawn to the end (Renderer::renderToTheEnd), none in motion
  bool fullFloatTarget = false;  ///< HDR target in 32 instead of 16 bits, for measured pictures
  std::optional<float> exposure;  ///< multiplies radiance before tone mapping; not set: the scene's
  GpuSceneSettings textures;
  ShadowTransport shadows = ShadowTransport::map;
  SunShadow::Settings shadow;
  LocalLights::Settings lights;
  double unmeasuredIterations =
      gl::kUnmeasuredIterations;  ///< of a chunk of radiosity's shadow rays of unknown cost (gl/chunks.hpp)

  /// Settings that a technique's folder declares, by their type: settings.of<LpvSettings>().bounces. Those never set
  /// have their defaults.
  template <class T>
  T& of() {
    std::any& held = ofTechniques[typeid(T)];
    if (!held.has_value()) held = T{};
    return *std::any_cast<T>(&held);
  }
  template <class T>
  const T& of() const {
    static const T usual{};
    const auto found = ofTechniques.find(typeid(T));
    return found == ofTechniques.end() ? usual : *std::any_cast<T>(&found->second);
  }
  std::map<std::type_index, std::any> ofTechniques;
};

}  // namespace lucerna
