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
#include "pathtracer/path_frame.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

namespace lucerna::demo {

namespace bench {

namespace {

/// One of the renderers that are measured in turn.
struct Run {
  gl::ProgramLibrary programs;  ///< its own: it finds nothing compiled already
  std::unique_ptr<Renderer> renderer;
  std::vector<double> ms;
  double variance = 0.0;

  Run(const gl::Context& context, const Scene& scene, const RenderSettings& settings)
      : renderer(std::make_unique<Renderer>(context, programs, scene, settings)) {}

  /// A picture from the start: of path, all of its samples.
  void draw(const Camera& camera) {
    const bool isPath = pathOf(renderer->technique()) != nullptr;
    if (isPath) renderer->forget();
    const auto start = Clock::now();
    if (isPath) renderer->renderToTheEnd(camera);
    else renderer->render(camera);
    gl::finish();
    ms.push_back(1e3 * secondsSince(start));
  }
  void findVariance() {
    const PathTracer* tracer = pathOf(renderer->technique());
    if (!tracer) return;
    const Image error = tracer->standardError();
    for (const glm::vec3& p : error.pixels) variance += glm::dot(glm::dvec3(p), glm::dvec3(p)) / 3.0;
    variance /= static_cast<double>(error.pixels.size());
  }
  /// Path: the time in which its error would be 1.
  std::vector<double> costs() const {
    std::vector<double> result = ms;
    if (variance > 0.0)
      for (double& cost : result) cost *= variance;
    return result;
  }
};

double largestDifference(const Image& a, const Image& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i)
    for (int c = 0; c < 3; ++c) {
      const double d = std::abs(static_cast<double>(a.pixels[i][c]) - static_cast<double>(b.pixels[i][c]));
      largest = std::isnan(d) ? INFINITY : std::max(largest, d);
    }
  return largest;
}

constexpr std::uint32_t kSamplesOfPicture = 8;  ///< path, unless path.samples is set

std::vector<double> logRatios(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> result;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) result.push_back(std::log(a[i] / b[i]));
  return result;
}

Saving::Verdict verdictOf(double logRatio) { return logRatio < 0.0 ? Saving::Verdict::saves : Saving::Verdict::costs; }

/// Programs are compiled once in each run: the ranges of two runs of each must lie apart, by more than their width.
Saving compileSaving(const std::array<double, 2>& without, const std::array<double, 2>& with) {
  const auto [a, b] = std::minmax(without[0], without[1]);
  const auto [c, d] = std::minmax(with[0], with[1]);
  Saving saving;
  if (!(a > 0.0 && c > 0.0)) return saving;
  const double ratio = 0.5 * std::log(a * b / (c * d)), same = std::log(std::max(b / a, d / c));
  saving.ratio = std::exp(ratio);
  saving.low = a / d;
  saving.high = b / c;
  saving.sameRuns = std::exp(same) - 1.0;
  const bool apart = (b < c || d < a) && std::abs(ratio) > same;
  saving.verdict = apart ? verdictOf(ratio) : Saving::Verdict::none;
  return saving;
}

}  // namespace

Saving savingOf(const std::array<std::vector<double>, 2>& without, const std::array<std::vector<double>, 2>& with) {
  std::vector<double> ratios = logRatios(without[0], with[0]);
  const std::vector<double> others = logRatios(without[1], with[1]);
  for (std::size_t i = 0; i < ratios.size() && i < others.size(); ++i) ratios[i] = 0.5 * (ratios[i] + others[i]);
  Saving saving;
  if (ratios.empty()) return saving;
  const double middle = median(ratios);
  saving.ratio = std::exp(middle);
  const MedianInterval interval = medianInterval(ratios);
  if (!std::isfinite(interval.low)) return saving;
  saving.low = std::exp(interval.low);
  saving.high = std::exp(interval.high);
  double same = 0.0;
  for (const auto* kind : {&without, &with}) {
    const MedianInterval of = medianInterval(logRatios((*kind)[0], (*kind)[1]));
    same = std::max({same, std::abs(of.low), std::abs(of.high)});
  }
  saving.sameRuns = std::exp(same) - 1.0;
  const bool differs = (interval.low > 0.0 || interval.high < 0.0) && std::abs(middle) > same;
  saving.verdict = differs ? verdictOf(middle) : Saving::Verdict::none;
  return saving;
}

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
  const bool isPath = settings.technique == "path";
  PathSettings& path = settings.of<PathSettings>();
  if (isPath && path.samples == PathSettings{}.samples) path.samples = kSamplesOfPicture;
  if (isPath) result.samples = static_cast<int>(path.samples);
  // Two runs of each, since only they say what runs of one configuration differ by. Those of path have other paths.
  RenderSettings second = settings;
  ++second.of<PathSettings>().seed;
  if (settings.technique != "radiosity")
    const Run warmUp(context, full, settings);  // a driver's compiler starts slowly
  Run lean(context, scene, settings), complete(context, full, settings), complete2(context, full, second),
      lean2(context, scene, second);
  std::array<Run*, 4> runs{&lean, &complete, &lean2, &complete2};
  for (Run* run : runs) {
    run->draw(camera);
    run->ms.clear();  // drivers finish programs on first use
  }
  for (int i = 0; i < frames && !interrupted(); ++i) {
    for (Run* run : runs) run->draw(camera);
    std::rotate(runs.begin(), runs.begin() + 1, runs.end());  // other load on the machine affects all alike
  }
  for (Run* run : runs) run->findVariance();
  const auto compileMs = [](const Run& run) { return 1e3 * run.programs.statistics().compileSeconds; };
  const auto costOf = [&](const Run& a, const Run& b) {
    std::vector<double> ms = a.ms;
    ms.insert(ms.end(), b.ms.begin(), b.ms.end());
    return FeaturesResult::Cost{a.renderer->gpuBytes(), a.programs.programs().size(),
                                0.5 * (compileMs(a) + compileMs(b)), median(ms), 0.5 * (a.variance + b.variance)};
  };
  const Image leanPicture = lean.renderer->readRadiance();
  result.leftOut = lean.renderer->leftOut();
  for (const std::string& name : complete.renderer->leftOut()) std::erase(result.leftOut, name);
  result.without = costOf(lean, lean2);
  result.with = costOf(complete, complete2);
  result.compile = compileSaving({compileMs(lean), compileMs(lean2)}, {compileMs(complete), compileMs(complete2)});
  result.picture = savingOf({lean.costs(), lean2.costs()}, {complete.costs(), complete2.costs()});
  result.maxDifference = largestDifference(leanPicture, complete.renderer->readRadiance());
  for (const glm::vec3& p : leanPicture.pixels)
    result.maxRadiance =
        std::max({result.maxRadiance, static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z)});
  result.scene = scene.name;
  result.technique = std::string(settings.technique);
  return result;
}

namespace {

nlohmann::ordered_json savingJson(const Saving& s) {
  return {{"ratio", s.ratio},
          {"low", s.low},
          {"high", s.high},
          {"same_runs", s.sameRuns},
          {"verdict", std::string(lucerna::nameOf(s.verdict))}};
}

std::string savingText(const Saving& s) {
  using Verdict = Saving::Verdict;
  std::string text = fmt::format("{:>8.3f}", s.ratio);
  if (std::isfinite(s.low)) text += fmt::format(" ({:.3f} to {:.3f})", s.low, s.high);
  text += fmt::format("  {}", lucerna::nameOf(s.verdict));
  if (s.verdict == Verdict::saves || s.verdict == Verdict::costs)
    text +=
        fmt::format(" {:.1f} %, a factor of {:.2f}", 100.0 * std::abs(1.0 - s.ratio), std::max(s.ratio, 1.0 / s.ratio));
  if (std::isfinite(s.sameRuns)) text += fmt::format("; two runs alike differ by {:.2f}", 1.0 + s.sameRuns);
  return text;
}

}  // namespace

nlohmann::ordered_json featuresJson(const FeaturesResult& r) {
  return {{"scene", r.scene},
          {"technique", r.technique},
          {"left_out", r.leftOut},
          {"gpu_bytes_with", r.with.gpuBytes},
          {"gpu_bytes_without", r.without.gpuBytes},
          {"picture", savingJson(r.picture)},
          {"compile", savingJson(r.compile)},
          {"samples", r.samples},
          {"variance_with", r.with.variance},
          {"variance_without", r.without.variance},
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
  const auto line = [](const char* what, double with, double without, const char* unit, const std::string& ratio) {
    return fmt::format("  {:<22}{:>12.2f}{:>12.2f} {:<5}{}\n", what, with, without, unit, ratio);
  };
  const double mebibytesWith = static_cast<double>(r.with.gpuBytes) / 1048576.0,
               mebibytesWithout = static_cast<double>(r.without.gpuBytes) / 1048576.0;
  const bool isPath = r.with.variance > 0.0 && r.without.variance > 0.0;
  std::string text = fmt::format("{}, {}: left out: {}\n  {:<22}{:>12}{:>12} {:<5}{:>8}\n", r.scene, r.technique,
                                 names.empty() ? "nothing" : names, "", "forced on", "left out", "", "ratio") +
                     line("compile time", r.with.compileMs, r.without.compileMs, "ms", savingText(r.compile)) +
                     line("GPU memory", mebibytesWith, mebibytesWithout, "MiB",
                          fmt::format("{:>8.3f}", mebibytesWithout / mebibytesWith));
  if (isPath) {
    // Of the same samples; then the variance makes it the time of the same error.
    text += line(fmt::format("{} samples", r.samples).c_str(), r.with.ms, r.without.ms, "ms", "");
    text += line("to the same error", r.with.ms, r.without.ms * r.without.variance / r.with.variance, "ms",
                 savingText(r.picture));
  } else {
    text += line("a picture", r.with.ms, r.without.ms, "ms", savingText(r.picture));
  }
  return text + fmt::format("  largest difference of a pixel {:.3g}, of radiances to {:.3g}\n", r.maxDifference,
                            r.maxRadiance);
}

}  // namespace bench

namespace {

struct FeaturesOptions {
  CommonOptions common;
  PictureOptions picture;
  std::vector<std::string> scenes;
  std::string camera;
  int frames = 10;
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
  app.addOption("--frames", options->frames, "pictures of each of two runs of both kinds, in turn; a verdict needs 6")
      .showDefault()
      .range(1, 10000);
  options->picture.declare(app);
  options->common.declare(app);
  return [options] { return runFeatures(*options); };
}

}  // namespace lucerna::demo
