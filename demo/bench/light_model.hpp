// The light that a technique computes: the paths of its model, and the kinds of light that it supports. It is judged
// against that light; light that its model omits is listed separately.
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
  int bounces = 0;  ///< maximum for indirect light; 0: any number

  auto operator<=>(const LightPaths&) const = default;
};
/// "one bounce of sun, lamps"; "up to 2 bounces of sun".
std::string nameOf(const LightPaths& paths);
/// Whether visible lights and the visible background are included.
bool showsLights(Transport transport);

/// The kinds of light that a technique shows directly and reflects between surfaces, whatever the scene contains.
measure::LightKinds directLightsOf(const RenderSettings& settings);
/// The light that its settings promise: direct for `direct`, indirect for rsm and lpv, all for radiosity.
LightPaths modelOf(const RenderSettings& settings);

}  // namespace lucerna::demo::bench
