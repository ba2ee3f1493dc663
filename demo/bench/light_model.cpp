#include "bench/light_model.hpp"

#include "render/techniques.hpp"

#include <fmt/format.h>

namespace lucerna::demo::bench {

using measure::LightKinds;

std::string nameOf(const LightPaths& paths) {
  const std::string lights = measure::nameOf(paths.lights);
  switch (paths.transport) {
    case Transport::direct: return "direct light of " + lights;
    case Transport::oneBounce: return "one bounce of " + lights;
    case Transport::oneBounceUnoccluded: return "one bounce, unoccluded, of " + lights;
    case Transport::all: return "all light of " + lights;
    case Transport::indirect:
      return paths.bounces > 0 ? fmt::format("up to {} bounces of {}", paths.bounces, lights)
                               : "all bounces of " + lights;
  }
  return "?";
}

bool showsLights(Transport transport) { return transport == Transport::all || transport == Transport::direct; }

LightKinds directLightsOf(const RenderSettings& settings) {
  const bool all = techniqueNamed(settings.technique).model(settings).environmentAndEmission;
  return all ? LightKinds{} : LightKinds{true, true, false, false};  // sun and lamps
}

LightPaths modelOf(const RenderSettings& settings) {
  const LightModel model = techniqueNamed(settings.technique).model(settings);
  return {model.transport, directLightsOf(settings), model.bounces};
}

}  // namespace lucerna::demo::bench
