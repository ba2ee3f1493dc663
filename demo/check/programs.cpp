// lucerna check, part programs: the seconds that the driver needs to compile and link every program of the techniques
// and of the catalogue of media, without its cache.
#include "check/check.hpp"

#include "bench/bench.hpp"
#include "gl/lines.hpp"
#include "gl/overlay.hpp"
#include "pathtracer/path_tracer.hpp"

#include <fmt/core.h>

namespace lucerna::demo::check {

namespace {

constexpr double kSlow = 3.0;  ///< seconds

/// Seconds of each program, from the library's sum before each of them.
class Stopwatch {
 public:
  explicit Stopwatch(const gl::ProgramLibrary& library) : library_(library) {}

  Finding finding() const {
    Finding finding;
    const double all = library_.statistics().compileSeconds;
    std::size_t slowest = 0;
    std::string slow;
    for (std::size_t i = 0; i < begun_.size(); ++i) {
      const double seconds = secondsOf(i);
      if (seconds > secondsOf(slowest)) slowest = i;
      if (seconds > kSlow) slow += fmt::format("{}{} {:.1f} s", slow.empty() ? "" : ", ", begun_[i].name, seconds);
      finding.figures["programs"].push_back({{"name", begun_[i].name}, {"seconds", seconds}});
    }
    finding.figures["seconds"] = all;
    finding.text = fmt::format("{} programs in {:.1f} s", begun_.size(), all);
    if (!slow.empty()) finding.text += fmt::format("; over {:g} s: {}", kSlow, slow);
    else if (!begun_.empty())
      finding.text += fmt::format("; slowest {}, {:.2f} s", begun_[slowest].name, secondsOf(slowest));
    return finding;
  }

 private:
  struct Begun {
    std::string name;
    double before;  ///< seconds of all programs before it
  };
  double secondsOf(std::size_t i) const {
    return (i + 1 < begun_.size() ? begun_[i + 1].before : library_.statistics().compileSeconds) - begun_[i].before;
  }
  const gl::ProgramLibrary& library_;
  std::vector<Begun> begun_;
  gl::BuildWatch watch_{[this](const std::string& name) {
    at(fmt::format("compiling {}, or after it", name));
    begun_.push_back({name, library_.statistics().compileSeconds});
  }};
};

Finding compileTechnique(const Requested& asked, const UnitInput& input) {
  Session session(input);
  const Stopwatch stopwatch(session.programs);
  const Scene scene = loadScene(bench::asset(asked.scene));
  const RenderSettings settings = asked.parse({160, 90});
  const Renderer renderer(session.context, session.programs, scene, settings);
  return stopwatch.finding();
}

/// All scenes of assets/media: liquids, boundaries, grids.
Finding compileMedia(const UnitInput& input) {
  Session session(input);
  const Stopwatch stopwatch(session.programs);
  for (const char* name : {"block/coffee", "block/juice", "block/milk", "cola/cola", "espresso/espresso", "gems/gems",
                           "smoke/smoke", "smoke/smoke_cloud"}) {
    at(fmt::format("loading {}", name));
    const Scene scene = loadScene(bench::asset(fmt::format("media/{}.json", name)));
    PathTracer::Settings settings;
    settings.size = {160, 90};
    const PathTracer tracer(session.context, session.programs, scene, settings);
  }
  return stopwatch.finding();
}

/// Programs that no picture of the part has: of other settings, of lamps and haze, and those that inspect a pixel.
const std::vector<Requested>& variants() {
  static const std::vector<Requested> all{
      {"direct-lamps", "", "direct", {"shadow.cascades=3"}},
      {"rsm-lamps", "", "rsm", {"rsm.interpolate=off"}},
      {"lpv-lamps", "", "lpv", {"lpv.bounces=2", "lpv.shafts=on", "lpv.glossy=on"}},
      {"lpv-layered", "", "lpv", {"lpv.fill=layered", "lpv.propagate=layered"}},
      {"lpv-fixed", "cornell/cornell.json", "lpv", {"lpv.fill=fixed", "lpv.cascades=1"}},
      {"lpv-published", "", "lpv", {"lpv.lookup=published", "lpv.blocking=both"}},
      {"gather-lamps", "", "irradiance-cache", {"cache.transport=gather"}},
      {"cache-lamps", "", "irradiance-cache", {"cache.samples=16", "cache.bounces=1"}},
      {"radiosity-raster",
       "",
       "radiosity",
       {"radiosity.edge=1", "radiosity.visibility=raster", "radiosity.mapping=log"}},
      {"radiosity-rays", "", "radiosity", {"radiosity.edge=1", "radiosity.visibility=rays"}},
      {"radiosity-items", "", "radiosity", {"radiosity.edge=1", "radiosity.visibility=item-buffer"}},
      {"path-lamps", "", "path", {"path.samples=1"}}};
  return all;
}

/// The Cornell box in a haze, with a spot, an omnidirectional lamp and a conductor.
Scene boxOfEverything() {
  Scene scene = loadScene(bench::asset("cornell/cornell.json"));
  const glm::dvec3 middle = scene.bounds.centre();
  scene.points.push_back({middle, glm::vec3(1.0f)});
  scene.spots.push_back({middle, {0.0, -1.0, 0.0}, glm::vec3(1.0f), 0.3, 0.6});
  scene.media.emplace_back().scattering = glm::vec3(0.01f);
  scene.cameraMedium = static_cast<int>(scene.media.size()) - 1;
  Material& shiny = scene.materials.front();
  shiny.specular = glm::vec3(0.5f);
  shiny.roughness = 0.2f;
  return scene;
}

Finding compileVariant(const Requested& asked, const UnitInput& input) {
  Session session(input);
  const Stopwatch stopwatch(session.programs);
  const Scene scene = asked.scene.empty() ? boxOfEverything() : loadScene(bench::asset(asked.scene));
  const RenderSettings settings = asked.parse({32, 18});
  Renderer renderer(session.context, session.programs, scene, settings);
  if (!asked.isPath()) {
    renderer.render(scene.cameras.front());
    renderer.inspect(session.programs, scene.cameras.front(), {16, 9});
  }
  const gl::Lines lines(session.programs);
  const gl::Overlay overlay(session.programs);
  return stopwatch.finding();
}

}  // namespace

std::vector<Unit> programUnits() {
  std::vector<Unit> units;
  for (const Requested& asked : requestedPictures())
    if (!asked.scene.starts_with("media/"))
      units.push_back(
          {"programs", asked.name, 60.0, [&](const UnitInput& input) { return compileTechnique(asked, input); }});
  for (const Requested& asked : variants())
    units.push_back(
        {"programs", asked.name, 60.0, [&](const UnitInput& input) { return compileVariant(asked, input); }});
  units.push_back({"programs", "media", 90.0, compileMedia});
  return units;
}

}  // namespace lucerna::demo::check
