#include "walk/state.hpp"

#include "base/provenance.hpp"
#include "scene/motion.hpp"
#include "shared/shell.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace lucerna::demo {

namespace {

template <class Lamp>
bool sameLamps(const std::vector<Lamp>& a, const std::vector<Lamp>& b) {
  return std::ranges::equal(
      a, b, [](const Lamp& x, const Lamp& y) { return x.position == y.position && x.intensity == y.intensity; });
}

}  // namespace

bool WalkState::timeRuns() const {
  return scene->motion && !time.held && (time.loops || time.seconds < scene->motion->end);
}

LightState lightsOf(const WalkState& state) {
  const Scene& scene = *state.scene;
  return {scene.sun, scene.spots, scene.points, scene.environment ? scene.environment->radiance : glm::vec3(0.0f),
          state.emissionFactor};
}

void setLights(WalkState& state, const LightState& lights) {
  Scene& scene = *state.scene;
  scene.sun = lights.sun;
  scene.spots = lights.spots;
  scene.points = lights.points;
  if (scene.environment) scene.environment->radiance = lights.sky;
  setEmission(state, lights.emission);
}

void setEmission(WalkState& state, float factor) {
  state.emissionFactor = factor;
  for (std::size_t i = 0; i < state.scene->materials.size(); ++i) {
    const Material& loaded = state.materialsAsLoaded[i];
    state.scene->materials[i].emission = factor * loaded.emission;
    state.scene->materials[i].emissionScale = factor * loaded.emissionScale;
  }
}

SceneChange changeOf(const LightState& before, const LightState& now) {
  SceneChange change;
  change.sun =
      before.sun.has_value() != now.sun.has_value() ||
      (now.sun && (before.sun->direction != now.sun->direction || before.sun->irradiance != now.sun->irradiance));
  change.lamps = !sameLamps(before.spots, now.spots) || !sameLamps(before.points, now.points);
  change.environment = before.sky != now.sky;
  change.materials = before.emission != now.emission;
  return change;
}

std::string textOf(const PictureOptions& o) {
  return fmt::format("{} {} {} | {} | {}", o.technique, o.component, o.fidelity, fmt::join(o.deviations, " "),
                     fmt::join(o.settings, " "));
}

void chooseTechnique(PictureOptions& options, const std::string& technique) {
  if (technique == options.technique) return;
  options.technique = technique;
  options.settings.clear();
  options.deviations.clear();
}

std::string commandLine(const std::string& command, const std::string& scene, const PictureOptions& o) {
  const PictureOptions usual;
  std::string line = "lucerna " + command + " " + bench::shellWord(scene);
  if (o.technique != kDefaultTechnique) line += " --technique " + o.technique;
  if (o.component != usual.component) line += " --component " + o.component;
  if (o.fidelity != usual.fidelity) line += " --fidelity " + o.fidelity;
  for (const std::string& deviation : o.deviations) line += " --deviation " + bench::shellWord(deviation);
  for (const std::string& setting : o.settings) line += " --set " + bench::shellWord(setting);
  return line;
}

void assign(std::vector<std::string>& assignments, const std::string& key, const std::string& value) {
  const auto known = std::find_if(assignments.begin(), assignments.end(),
                                  [&](const std::string& a) { return a.starts_with(key + "="); });
  if (value.empty()) {
    if (known != assignments.end()) assignments.erase(known);
  } else if (known != assignments.end()) {
    *known = key + "=" + value;
  } else {
    assignments.push_back(key + "=" + value);
  }
}

std::string cameraText(const Scene& scene, const Camera& c) {
  if (c.isOrthographic()) return c.name;  // numbers stand for perspective views alone
  const glm::dvec3 from = c.position + scene.origin, target = from + c.direction;
  const int digits = scene.origin == glm::dvec3(0.0) ? 7 : 13;
  return fmt::format("{:.{}g},{:.{}g},{:.{}g},{:.{}g},{:.{}g},{:.{}g},{:.5g}", from.x, digits, from.y, digits, from.z,
                     digits, target.x, digits, target.y, digits, target.z, digits, glm::degrees(c.verticalFov));
}

}  // namespace lucerna::demo
