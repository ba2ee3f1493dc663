#include "bench/light_model.hpp"

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
  const bool all = settings.technique == Technique::radiosity || settings.technique == Technique::irradianceCache;
  return all ? LightKinds{} : LightKinds{true, true, false, false};  // else of forward shading: sun and lamps
}

LightPaths modelOf(const RenderSettings& settings) {
  LightPaths model{Transport::all, directLightsOf(settings), 0};
  switch (settings.technique) {
    case Technique::direct: model.transport = Transport::direct; break;
    case Technique::rsm: model.transport = Transport::oneBounceUnoccluded; break;
    case Technique::lpv:
      model.transport = settings.lpv.blocking ? Transport::oneBounce : Transport::oneBounceUnoccluded;
      if (settings.lpv.bounces != 1) model = {Transport::indirect, model.lights, settings.lpv.bounces};
      break;
    case Technique::irradianceCache:
      model.transport =
          settings.cache.transport == CacheTransport::gather && settings.cache.visibility == GatherVisibility::none
              ? Transport::oneBounceUnoccluded
              : Transport::oneBounce;
      if (settings.cache.bounces != 1) model = {Transport::indirect, model.lights, settings.cache.bounces};
      break;
    case Technique::radiosity:
    case Technique::path: break;
  }
  return model;
}

}  // namespace lucerna::demo::bench
