// Which light a technique computes: the paths of its model, and the kinds of light that it knows. It is judged against
// that light; what its model leaves out is listed apart.
#pragma once

#include "measure/light_kinds.hpp"
#include "measure/reference.hpp"
#include "render/renderer.hpp"

#include <compare>
#include <optional>
#include <string>

namespace lucerna::demo::bench {

/// The light of a reference.
struct LightPaths {
  Transport transport = Transport::all;
  measure::LightKinds lights;
  int bounces = 0;  ///< of indirect light at most; 0: any number

  auto operator<=>(const LightPaths&) const = default;
};
/// "one bounce of sun, lamps"; "up to 2 bounces of sun".
std::string nameOf(const LightPaths& paths);
/// What is seen of lights and of what lies behind the scene is part of it.
bool showsLights(Transport transport);

/// The kinds of light that a technique reflects from surface to surface, whatever the scene has.
measure::LightKinds lightsOf(const RenderSettings& settings);
/// Those whose direct light it shows.
measure::LightKinds directLightsOf(const RenderSettings& settings);
/// What its settings promise: direct light for `direct`, indirect light for rsm and lpv, all light for radiosity.
LightPaths modelOf(const RenderSettings& settings);

}  // namespace lucerna::demo::bench
