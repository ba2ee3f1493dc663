// lucerna check, part programs: the seconds that the driver needs to compile and link every program of the techniques
// and of the catalogue of media, without its cache.
#include "check/check.hpp"

#include "bench/bench.hpp"
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

Finding compileTechnique(const Asked& asked, const UnitInput& input) {
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

}  // namespace

std::vector<Unit> programUnits() {
  std::vector<Unit> units;
  for (const Asked& asked : askedPictures())
    if (!asked.scene.starts_with("media/"))
      units.push_back(
          {"programs", asked.name, 60.0, [&](const UnitInput& input) { return compileTechnique(asked, input); }});
  units.push_back({"programs", "media", 90.0, compileMedia});
  return units;
}

}  // namespace lucerna::demo::check
