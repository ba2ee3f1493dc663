// lucerna check, part stages: times of frames and of their stages along a scene's camera path, each frame complete
// (frame.reuse=off).
#include "check/check.hpp"

#include "base/clock.hpp"
#include "base/statistics.hpp"
#include "bench/bench.hpp"
#include "gl/draw.hpp"
#include "shared/paths.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace lucerna::demo::check {

namespace {

constexpr int kFrames = 60;

/// After a warm-up, up to kFrames frames in the time there is, at least one.
Finding measureFrames(const Requested& asked, glm::ivec2 size, const UnitInput& input) {
  const auto start = Clock::now();
  Session session(input);
  at("loading " + asked.scene);
  const Scene scene = loadScene(bench::asset(asked.scene));
  RenderSettings settings = asked.parse(size);
  settings.reuse = false;
  settings.fullFloatTarget = false;  // as a walk has it
  const Spline path = pathOf(scene);
  at("allocating");
  Renderer renderer(session.context, session.programs, scene, settings);
  std::vector<double> ms;
  for (int i = 0; i <= kFrames; ++i) {
    if (i > 1 && (interrupted() || secondsSince(start) > input.seconds)) break;
    at(fmt::format("frame {} of {} {}x{}", i, asked.name, size.x, size.y));
    const auto begun = Clock::now();
    renderer.render(path.view(i));
    gl::finish();
    if (i > 0) ms.push_back(1e3 * secondsSince(begun));
  }
  at("reading times");
  renderer.drain();

  // The frame, and the stage that takes most of it.
  const std::vector<gl::StageStatistics> stages = renderer.timer().statistics();
  Finding finding;
  finding.text = fmt::format("{:.2f} ms ({:.2f}..{:.2f}), {} frames", median(ms), percentile(ms, 0.05),
                             percentile(ms, 0.95), ms.size());
  const auto longest = std::max_element(stages.begin(), stages.end(), [](const auto& a, const auto& b) {
    return (std::isnan(a.medianMs) ? 0.0 : a.medianMs) < (std::isnan(b.medianMs) ? 0.0 : b.medianMs);
  });
  if (longest != stages.end() && !std::isnan(longest->medianMs))
    finding.text += fmt::format("; {} {:.2f} ms", longest->name, longest->medianMs);
  finding.figures = {
      {"technique", asked.name},          {"size", {size.x, size.y}},      {"frames", ms.size()},
      {"median_ms", median(ms)},          {"p5_ms", percentile(ms, 0.05)}, {"p95_ms", percentile(ms, 0.95)},
      {"gpu_bytes", renderer.gpuBytes()}, {"stages", stagesJson(stages)}};
  return finding;
}

/// One of each technique and transport.
const std::vector<Requested>& walks() {
  static const std::vector<Requested> all = [] {
    std::vector<Requested> asked;
    for (const char* scene : {"atrium", "cornell"}) {
      const auto add = [&](const std::string& name, const char* technique, std::vector<std::string> settings) {
        asked.push_back(
            {fmt::format("{}-{}", name, scene), fmt::format("{0}/{0}.json", scene), technique, std::move(settings)});
      };
      add("cache", "irradiance-cache", {});
      add("direct", "direct", {});
      add("lpv", "lpv", {});
      add("rsm", "rsm", {});
      add("gather", "irradiance-cache", {"cache.transport=gather"});
      add("path", "path", {});
      add("radiosity", "radiosity", {scene == std::string("atrium") ? "radiosity.edge=2" : "radiosity.edge=0.1"});
    }
    return asked;
  }();
  return all;
}

}  // namespace

std::vector<Unit> stageUnits() {
  std::vector<Unit> units;
  for (const glm::ivec2& size : {glm::ivec2(1920, 1080), glm::ivec2(1280, 720)})
    for (const Requested& asked : walks()) {
      Unit unit{"stages", fmt::format("{}-{}x{}", asked.name, size.x, size.y), 20.0,
                [&asked, size](const UnitInput& input) { return measureFrames(asked, size, input); }};
      unit.isLarge = true;
      for (const Requested& picture : requestedPictures())
        if (picture.name == asked.name) unit.after = "pictures/" + picture.name;
      units.push_back(std::move(unit));
    }
  return units;
}

}  // namespace lucerna::demo::check
