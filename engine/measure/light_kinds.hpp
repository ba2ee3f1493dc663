// The kinds of light in a scene, and the scene with only some of them (no GL): a technique is judged by the light
// that it supports.
#pragma once

#include "scene/scene.hpp"

#include <compare>
#include <string>

namespace lucerna::measure {

/// The kinds of emitters that a scene has, a technique supports, or a reference contains.
struct LightKinds {
  bool sun = true;
  bool lamps = true;  ///< spots and omnidirectional lamps
  bool surfaces = true;  ///< emissive surfaces and media
  bool environment = true;  ///< lights the scene from behind it; a background that lights nothing does not count

  auto operator<=>(const LightKinds&) const = default;
  bool any() const { return sun || lamps || surfaces || environment; }
};

/// Intersection.
LightKinds operator&(LightKinds a, LightKinds b);
/// Those of a that are not in b.
LightKinds without(LightKinds a, LightKinds b);
/// "sun, lamps"; "none".
std::string nameOf(LightKinds kinds);

/// The kinds that the scene has; emitters of radiance 0 do not count.
LightKinds kindsOf(const Scene& scene);
/// The scene without the emitters of all other kinds. Emissive surfaces stay, black but with their albedo; the
/// background stays.
Scene litBy(const Scene& scene, LightKinds kinds);

}  // namespace lucerna::measure
