// Settings of a picture: the technique, the light components to show, and the settings of every stage (no GL calls).
// engine/settings/settings.hpp lists the user settings by key.
#pragma once

#include "base/named_values.hpp"
#include "forward/gpu_scene.hpp"
#include "forward/local_lights.hpp"
#include "forward/shadow_map.hpp"
#include "forward/sun_cascades.hpp"
#include "irradiance_cache/settings.hpp"
#include "lpv/light_propagation_volume.hpp"
#include "pathtracer/path_deviations.hpp"
#include "radiosity/radiosity_view.hpp"
#include "rsm/reflective_shadow_map.hpp"
#include "rsm/rsm_gather.hpp"
#include "scene/transport.hpp"

#include <glm/glm.hpp>

#include <array>
#include <optional>
#include <string_view>

namespace lucerna {

enum class Technique { direct, rsm, lpv, irradianceCache, radiosity, path };
constexpr std::array<std::string_view, 6> namesOf(Technique) {
  return {"direct", "rsm", "lpv", "irradiance-cache", "radiosity", "path"};
}

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

struct RenderSettings {
  Technique technique = Technique::irradianceCache;
  Component component = Component::all;
  glm::ivec2 size{1280, 720};
  bool reuse = true;  ///< stages with unchanged inputs are not run again; the same picture, bit by bit
  bool fullFloatTarget = false;  ///< HDR target in 32 instead of 16 bits, for measured pictures
  std::optional<float> exposure;  ///< multiplies radiance before tone mapping; not set: the scene's
  GpuSceneSettings textures;
  ShadowMap::Settings shadow;  ///< of the sun; with several cascades the size is that of each
  SunCascadeSettings sunCascades;
  LocalLights::Settings lights;
  ReflectiveShadowMap::Settings rsm;  ///< the size serves the sun and spots; each face of an omnidirectional light has
                                      ///< half of it. `light` is not read
  RsmGather::Settings gather;
  LpvSettings lpv;
  IrradianceCacheSettings cache;
  PathSettings path;
  RadiosityView::Settings radiosity;  ///< `light` is not read: the component determines it
  double unmeasuredIterations =
      gl::kUnmeasuredIterations;  ///< of a piece of radiosity's shadow rays of unknown cost (gl/chunks.hpp)
};

}  // namespace lucerna
