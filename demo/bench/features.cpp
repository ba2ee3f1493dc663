// lucerna bench features [SCENE]...: the features that a scene does not need, and what leaving them out saves, measured
// against the same picture with every feature forced on.
#include "base/clock.hpp"
#include "base/error.hpp"
#include "base/statistics.hpp"
#include "bench/bench.hpp"
#include "bench/features_bench.hpp"
#include "gl/draw.hpp"
#include "lpv/settings.hpp"
#include "measure/neutral.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace lucerna::demo {

namespace bench {

namespace {

/// Alternates frames of the two renderers, so that other load on the machine affects both.
void measureFrames(Renderer& renderer, const Camera& camera, std::vector<double>& ms) {
  const auto start = Clock::now();
  renderer.render(camera);
  gl::finish();
  ms.push_back(1e3 * secondsSince(start));
}

double largestDifference(const Image& a, const Image& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i)
    for (int c = 0; c < 3; ++c) {
      const double d = std::abs(static_cast<double>(a.pixels[i][c]) - static_cast<double>(b.pixels[i][c]));
      largest = std::isnan(d) ? INFINITY : std::max(largest, d);
    }
  return largest;
}

}  // namespace

Scene withEverything(const Scene& scene, const RenderSettings& settings) {
  Scene full = scene;
  // A lamp, however dark, adds the surfaces that it sees to the geometry volume, where it is therefore not neutral.
  const bool lampsBlock = settings.technique == "lpv" && settings.of<LpvSettings>().blocking;
  for (const std::string& need : measure::neutralFeatures())
    if (!(lampsBlock && (need == "spotLights" || need == "pointLights"))) measure::addNeutral(full, need);
  return full;
}

FeaturesResult measureFeatures(const gl::Context& context, const Scene& scene, const Camera& camera,
                               RenderSettings settings, int frames) {
  settings.fullFloatTarget = true;
  settings.reuse = false;  // measure each frame's full cost
  const Scene full = withEverything(scene, settings);
  FeaturesResult result;
  // Separate libraries: each compiles what it needs and finds nothing compiled already.
  gl::ProgramLibrary leanPrograms, fullPrograms;
  Renderer lean(context, leanPrograms, scene, settings), complete(context, fullPrograms, full, settings);
  lean.render(camera);
  complete.render(camera);
  gl::finish();
  std::vector<double> leanMs, fullMs;
  for (int i = 0; i < frames && !interrupted(); ++i) {
    measureFrames(lean, camera, leanMs);
    measureFrames(complete, camera, fullMs);
  }
  const Image leanPicture = lean.readRadiance();
  result.leftOut = lean.leftOut();
  for (const std::string& name : complete.leftOut()) std::erase(result.leftOut, name);
  result.without = {lean.gpuBytes(), leanPrograms.programs().size(), 1e3 * leanPrograms.statistics().compileSeconds,
                    median(leanMs)};
  result.with = {complete.gpuBytes(), fullPrograms.programs().size(), 1e3 * fullPrograms.statistics().compileSeconds,
                 median(fullMs)};
  result.maxDifference = largestDifference(leanPicture, complete.readRadiance());
  for (const glm::vec3& p : leanPicture.pixels)
    result.maxRadiance =
        std::max({result.maxRadiance, static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z)});
  result.scene = scene.name;
  result.technique = std::string(settings.technique);
  return result;
}

nlohmann::ordered_json featuresJson(const FeaturesResult& r) {
  return {{"scene", r.scene},
          {"technique", r.technique},
          {"left_out", r.leftOut},
          {"gpu_bytes_with", r.with.gpuBytes},
          {"gpu_bytes_without", r.without.gpuBytes},
          {"ms_with", r.with.ms},
          {"ms_without", r.without.ms},
          {"compile_ms_with", r.with.compileMs},
          {"compile_ms_without", r.without.compileMs},
          {"programs_with", r.with.programs},
          {"programs_without", r.without.programs},
          {"max_difference", r.maxDifference},
          {"max_radiance", r.maxRadiance}};
}

std::string featuresText(const FeaturesResult& r) {
  std::string names;
  for (const std::string& name : r.leftOut) names += (names.empty() ? "" : ", ") + name;
  const auto line = [](const char* what, double with, double without, const char* unit) {
    return fmt::format("  {:<22}{:>12.2f}{:>12.2f} {:<5}{:>8.2f}\n", what, with, without, unit, without / with);
  };
  return fmt::format("{}, {}: left out: {}\n  {:<22}{:>12}{:>12} {:<5}{:>8}\n", r.scene, r.technique,
                     names.empty() ? "nothing" : names, "", "forced on", "left out", "", "ratio") +
         line("compile time", r.with.compileMs, r.without.compileMs, "ms") +
         line("GPU memory", static_cast<double>(r.with.gpuBytes) / 1048576.0,
              static_cast<double>(r.without.gpuBytes) / 1048576.0, "MiB") +
         line("a picture", r.with.ms, r.without.ms, "ms") +
         fmt::format("  largest difference of a pixel {:.3g}, of radiances to {:.3g}\n", r.maxDifference,
                     r.maxRadiance);
}

}  // namespace bench

namespace {

struct FeaturesOptions {
  CommonOptions common;
  PictureOptions picture;
  std::vector<std::string> scenes;
  std::string camera;
  int frames = 5;
};

int runFeatures(FeaturesOptions options) {
  options.common.apply();
  options.picture.readSettingsFile();
  options.picture.usualSamples = 1;
  const RenderSettings settings = options.picture.parse();
  if (options.scenes.empty()) options.scenes = {bench::sceneOrAtrium("")};
  const auto host = options.common.makeHost(false);
  const gl::Context context;
  watchForInterrupt();
  if (!options.common.quiet) fmt::print("Renderer {}\n", context.capabilities().renderer);
  nlohmann::ordered_json results = nlohmann::ordered_json::array();
  for (const std::string& file : options.scenes) {
    const Scene scene = loadScene(file);
    const bench::FeaturesResult result =
        bench::measureFeatures(context, scene, chooseCamera(scene, options.camera), settings, options.frames);
    if (interrupted()) return exitCode();
    if (!options.common.quiet) fmt::print("{}", bench::featuresText(result));
    results.push_back(bench::featuresJson(result));
  }
  nlohmann::ordered_json json = results.size() == 1 ? results[0] : nlohmann::ordered_json{{"scenes", results}};
  json["renderer"] = context.capabilities().renderer;
  json["host"] = std::string(nameOf(host->kind()));
  options.common.writeJson(json);
  return 0;
}

}  // namespace

Work addBenchFeatures(Command app) {
  auto options = std::make_shared<FeaturesOptions>();
  options->picture.size = "320x180";
  app.addOption("SCENE", options->scenes, "scene files (default: the atrium)").scene();
  app.addOption("--camera", options->camera, "a camera's name, or px,py,pz,tx,ty,tz,fov (position, target, degrees)");
  app.addOption("--frames", options->frames, "pictures of each kind, in turn").showDefault().range(1, 10000);
  options->picture.declare(app);
  options->common.declare(app);
  return [options] { return runFeatures(*options); };
}

}  // namespace lucerna::demo
