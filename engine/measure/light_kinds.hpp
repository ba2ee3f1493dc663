// The kinds of light in a scene, and the scene with some of them alone (no GL): a technique is judged against the light
// that it is given.
#pragma once

#include "scene/scene.hpp"

#include <compare>
#include <string>

namespace lucerna::measure {

/// Which kinds of emitters a scene has, a technique knows, or a reference holds.
struct LightKinds {
  bool sun = true;
  bool lamps = true;        ///< spots and omnidirectional lamps
  bool surfaces = true;     ///< emissive surfaces, and media that shine
  bool environment = true;  ///< what is seen behind the scene and lights it; a background that lights nothing is none

  auto operator<=>(const LightKinds&) const = default;
  bool any() const { return sun || lamps || surfaces || environment; }
};

/// Those of both.
LightKinds operator&(LightKinds a, LightKinds b);
/// Those of a that b has not.
LightKinds without(LightKinds a, LightKinds b);
/// "sun, lamps"; "none".
std::string nameOf(LightKinds kinds);

/// The kinds that the scene has: an emitter of radiance 0 is none.
LightKinds kindsOf(const Scene& scene);
/// The scene without the emitters of all other kinds. Surfaces that shone stay, black emitters with their albedo; the
/// background stays.
Scene litBy(const Scene& scene, LightKinds kinds);

}  // namespace lucerna::measure
