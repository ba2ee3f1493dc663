// lucerna bench error SCENE: every technique over a sweep of settings, with its time and its error against a
// path-traced reference. lucerna bench references SCENE: only those references, which may be computed in batches on
// many machines.
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/hash.hpp"
#include "base/image.hpp"
#include "base/provenance.hpp"
#include "bench/bench.hpp"
#include "bench/error_bench.hpp"
#include "scene/motion.hpp"
#include "shared/commands.hpp"
#include "shared/completions.hpp"
#include "shared/shell.hpp"

#include <fmt/core.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace lucerna::demo {

namespace bench {

namespace {

/// There are at least as many patches as triangles, and form factors grow with their square: above this limit the
/// radiosity sweep would take hours on two cores.
constexpr std::size_t kMostTrianglesOfRadiosity = 30000;

/// Pictures that are asked for stand alone, unless techniques are named too.
bool hasSweeps(const ErrorBenchOptions& options) {
  return !options.techniques.empty() || !(options.bounds || !options.points.empty());
}

/// Sweeps for which a scene is too large, one line each; only if none was requested by name.
std::vector<std::string> leftOutOf(const ErrorBenchOptions& options, const Scene& scene) {
  if (!options.techniques.empty() || !hasSweeps(options) || scene.triangleCount() <= kMostTrianglesOfRadiosity)
    return {};
  return {fmt::format(
      "radiosity: left out but for its row as published, which has a coarser model; {} triangles, each at least one "
      "patch, and it is measured up to {} (--techniques radiosity measures it all the same)",
      scene.triangleCount(), kMostTrianglesOfRadiosity)};
}

std::vector<std::string> chosenTechniques(const ErrorBenchOptions& options) {
  if (!hasSweeps(options)) return {};
  std::vector<std::string> known = sweepTechniques();
  known.emplace_back("path");
  if (options.techniques.empty()) return known;
  std::string list;
  for (const std::string& t : known) list += (list.empty() ? "" : ", ") + t;
  for (const std::string& t : options.techniques)
    if (std::find(known.begin(), known.end(), t) == known.end())
      throwBadInput("--techniques {}: unknown; expected one of {}", t, list);
  return options.techniques;
}

std::vector<SweepPoint> pointsOf(const ErrorBenchOptions& options, const std::vector<std::string>& techniques,
                                 const Bounds& bounds) {
  std::vector<std::string> raster;
  for (const std::string& t : techniques)
    if (t != "path") raster.push_back(t);
  if (options.deviations) return deviationPoints(raster);
  std::vector<SweepPoint> points;
  for (const std::string& t : raster)
    for (SweepPoint& point :
         sweepOf(t, options.small, std::max({bounds.extent().x, bounds.extent().y, bounds.extent().z})))
      points.push_back(std::move(point));
  if (options.bounds)
    for (SweepPoint& point : boundPoints()) points.push_back(std::move(point));
  for (const std::string& asked : options.points) points.push_back(parseSweepPoint(asked));
  return points;
}

void addSampling(std::vector<std::string>& words, const ErrorBenchOptions& options) {
  if (options.time != 0.0) words.insert(words.end(), {"--time", fmt::format("{:.17g}", options.time)});
  if (options.pixelSamples != PictureOptions::kPixelSamples)
    words.insert(words.end(), {"--pixel-samples", std::to_string(options.pixelSamples)});
  if (options.filter != "box") words.insert(words.end(), {"--filter", options.filter});
}

/// The command that repeats this measurement, except for --techniques and the folder.
std::string benchCommand(const ErrorBenchOptions& options) {
  std::vector<std::string> words{"lucerna", "bench",      "error",    options.scene,
                                 "--size",  options.size, "--frames", std::to_string(options.frames)};
  if (!options.camera.empty()) words.insert(words.end(), {"--camera", options.camera});
  words.insert(words.end(), {"--budget", fmt::format("{:g}", options.budget)});
  if (options.referenceSamples > 0)
    words.insert(words.end(), {"--reference-spp", std::to_string(options.referenceSamples)});
  addSampling(words, options);
  if (options.small) words.emplace_back("--small");
  if (options.deviations) words.emplace_back("--deviations");
  if (options.bounds) words.emplace_back("--bounds");
  for (const std::string& point : options.points) words.insert(words.end(), {"--point", point});
  return shellCommand(words);
}

std::string pictureCommand(const ErrorBenchOptions& options) {
  std::vector<std::string> words{"lucerna", "render", options.scene, "--size", options.size};
  if (!options.camera.empty()) words.insert(words.end(), {"--camera", options.camera});
  addSampling(words, options);
  return shellCommand(words);
}

}  // namespace

Scene withoutHighlights(Scene scene) {
  for (Material& m : scene.materials)
    if (m.bsdf == Bsdf::diffuse) m.specular = glm::vec3(0.0f);
  return scene;
}

void ErrorBenchOptions::declareView(Command app) {
  app.addOption("--time", time, "seconds at which a scene that moves is shown").range(-1e12, 1e12).showDefault();
  app.addOption("--camera", camera, "a camera's name, or px,py,pz,tx,ty,tz,fov (position, target, degrees)");
  app.addOption("--size", size, "WIDTHxHEIGHT of the pictures").showDefault();
  addCompletions(app.addOption("--filter", filter,
                               "pixel filter of references and pictures: box, gaussian, blackman-harris, or centre, "
                               "through pixels' centres")
                     .showDefault(),
                 {"box", "gaussian", "blackman-harris", "centre"});
  app.addOption("--references", references,
                "folder of cached references (default: LUCERNA_REFERENCES, or lucerna in the user's cache)");
  addCompletions(app.addOption("--techniques", techniques,
                               "only these of direct, rsm, lpv, irradiance-cache, radiosity, path; default: all")
                     .delimiter(','),
                 {"direct", "rsm", "lpv", "irradiance-cache", "radiosity", "path"});
  app.addOption("--pixel-samples", pixelSamples, "points of each pixel that techniques draw")
      .showDefault()
      .range(1, 1024);
  app.addFlag("--small", small, "leave out the most expensive points");
  app.addFlag(
      "--bounds", bounds,
      "how much of the error of propagate and gather is the map's, and how much the cells'; without --techniques "
      "there are no sweeps; through pixels' centres");
  app.addOption("--point", points,
                "\"TECHNIQUE [SETTING=VALUE]...\": a picture with these settings besides the sweeps; without "
                "--techniques there are no sweeps");
}

void ErrorBenchOptions::declare(Command app) {
  declareView(app);
  app.addOption("--budget", budget, "seconds for references and path tracing; known references are reused")
      .showDefault()
      .range(0.01, 1e6);
  app.addOption("--reference-spp", referenceSamples, "paths per pixel of every reference, instead of by time")
      .range(2, 1 << 30);
  app.addOption("--frames", frames, "minimum number of pictures per point").showDefault().range(1, 10000);
  app.addOption("--out", out, "folder for the report; an interrupted bench continues where it was");
  app.addOption("--before", before, "a report of an earlier program (its JSON or folder), drawn beside this one");
}

ErrorBenchPlan::ErrorBenchPlan(const Scene& original, const ErrorBenchOptions& options)
    : scene(withoutHighlights(original)),
      camera(chooseCamera(scene, options.camera)),
      size(parseSize(options.size)),
      techniques(chosenTechniques(options)),
      leftOut(leftOutOf(options, scene)) {
  // The parts that bounds replace are known at pixels' centres.
  filter = options.bounds ? PixelFilter::centre : parseName<PixelFilter>(options.filter, "--filter");
  pixelSamples = filter == PixelFilter::centre ? 1 : options.pixelSamples;
  points = pointsOf(options, techniques, scene.bounds);
  if (!leftOut.empty())
    std::erase_if(
        points, [](const SweepPoint& point) { return point.picture.technique == "radiosity" && !point.byReadPixels; });
  title =
      fmt::format("{}, camera {}, {}x{}", scene.name, camera.name.empty() ? "default" : camera.name, size.x, size.y);
  if (options.time != 0.0) title += fmt::format(", at {:g} s", options.time);
  withPath = std::find(techniques.begin(), techniques.end(), "path") != techniques.end();
  for (const SweepPoint& point : points)
    if (const TechniqueModel model = modelOf(point, measure::kindsOf(scene));
        std::find(models.begin(), models.end(), model) == models.end())
      models.push_back(model);
}

ReferenceRequest ErrorBenchPlan::references(const gl::Context& context, gl::ProgramLibrary& programs,
                                            const ErrorBenchOptions& options, const std::filesystem::path& own) const {
  return {context,
          programs,
          scene,
          camera,
          size,
          filter,
          (withPath ? 0.7 : 1.0) * options.budget,
          models,
          options.referenceSamples,
          options.references,
          options.quiet,
          withPath,
          own};
}

std::unique_ptr<ErrorBenchResult> runErrorBench(const gl::Context& context, gl::ProgramLibrary& programs,
                                                const Scene& original, const ErrorBenchOptions& options,
                                                const std::string& hostName) {
  const ErrorBenchPlan plan(original, options);
  const Scene& scene = plan.scene;
  const std::vector<SweepPoint>& points = plan.points;
  // Rows of other processors or renderers have other times.
  const auto kept = [&](const PartOptions& part) {
    if (options.referenceSamples == 0)
      throwBadInput("--part, --checkpoint: need --reference-spp, since references by time differ between machines");
    return PartFolder(part, "bench error",
                      fmt::format("{}, {}, {} points of {}, references of {} samples, scene {}, {} on {}", plan.title,
                                  options.deviations ? "deviations" : "sweeps", points.size(),
                                  fmt::join(plan.techniques, ", "), options.referenceSamples,
                                  measure::keyOf(scene, plan.camera, plan.size, Transport::all, "rows 2").name(),
                                  context.capabilities().renderer, cpuName()),
                      points.size() + plan.withPath);
  };
  auto result = std::make_unique<ErrorBenchResult>();
  if (!options.before.empty()) {
    result->report.before = readErrorReport(options.before);
    if (const auto bench = result->report.before.at("bench"); bench != plan.title)
      throwBadInput("--before {}: is of {}; this is {}", options.before, bench.get<std::string>(), plan.title);
  }
  // Open the folder, with results of an earlier run or of parts.
  const bool isPart = options.part.isPart();
  if (isPart && options.referenceSamples > 0 && !hasReferences(plan.references(context, programs, options)))
    throwBadInput(
        "--part {}: the references are missing: lucerna bench references with the same scene, --size, --camera, "
        "--techniques and --reference-spp makes them, in parts too",
        options.part.part);
  std::optional<PartFolder> part;
  if (!options.part.checkpoint.empty()) {
    if (!isPart && !isPartFolder(options.part.checkpoint))
      throwBadInput("--checkpoint {}: is no folder of lucerna merge; a bench's own results are resumed by --out",
                    options.part.checkpoint);
    part.emplace(kept(options.part));
  } else if (isPart) {
    options.part.rangeOf(1);  // reports missing parts
  }
  const std::filesystem::path folder = isPart ? *part->folder() : std::filesystem::path(options.out);
  makeFolder(folder);
  if (part && !isPart) copyUnits(*part->folder(), folder);

  auto references = obtainReferences(plan.references(context, programs, options, folder / "references"));
  if (!references) return result;
  result->references = std::move(*references);
  if (meanOf(result->references.all().mean) == glm::dvec3(0.0))
    throwBadInput("the reference is black: {}", kNoLightSeen);
  // Rows are judged by the reference in use: a better reference makes it another bench.
  claimFolder(folder, fmt::format("{}, {}, {}, scene {}, reference of {} samples", plan.title,
                                  options.deviations ? "deviations" : "sweeps", context.capabilities().renderer,
                                  measure::keyOf(scene, plan.camera, plan.size, Transport::all, "rows 2").name(),
                                  result->references.all().samples));

  // Rows: first the raster sweeps, then path tracing.
  const ErrorBench bench{context,
                         programs,
                         scene,
                         plan.camera,
                         plan.size,
                         plan.filter,
                         plan.pixelSamples,
                         result->references,
                         folder,
                         0.3 * options.budget,
                         options.frames,
                         benchCommand(options),
                         pictureCommand(options),
                         !plan.techniques.empty()};
  writePng(folder / "pictures/reference.png", toneMapped(result->references.all().mean, scene.exposure));
  std::vector<ErrorRow> rows;
  const std::size_t first = isPart ? part->first() : 0, last = isPart ? part->last() : points.size() + plan.withPath;
  Progress progress(options.deviations ? "deviations" : "sweeps", static_cast<int>(last - first), options.quiet);
  for (std::size_t i = first; i < std::min(last, points.size()); ++i) {
    const SweepPoint& point = points[i];
    if (interrupted()) return result;
    if (auto known = finishedRow(folder, point)) {
      (*known)["series"] = point.series;
      (*known)["step"] = point.isStep;
      rows.push_back(*known);
    } else {
      rows.push_back(point.byReadPixels           ? measurePublished(bench, point)
                     : point.bound != Bound::none ? measureBound(bench, point)
                                                  : measurePoint(bench, point));
    }
    progress.update(static_cast<int>(rows.size()));
  }
  if (last > points.size())
    for (ErrorRow& row : measurePath(bench, options.deviations)) rows.push_back(std::move(row));
  if (interrupted()) return result;
  if (isPart) {
    part->finish();
    result->partRows = last - first;
    result->complete = true;
    return result;
  }
  markFront(rows);

  // The report.
  ErrorReport& report = result->report;
  report.title = plan.title;
  report.renderer = context.capabilities().renderer;
  report.host = hostName;
  report.cpu = cpuName();
  report.rows = std::move(rows);
  report.model = modelErrors(result->references);
  report.baselines = baselines(result->references);
  report.inside = insideModels(result->references);
  report.references = &result->references;
  report.isDeviationStudy = options.deviations;
  report.exposure = scene.exposure;
  report.driver = context.capabilities().version;
  report.command =
      bench.command +
      (options.techniques.empty() ? "" : fmt::format(" --techniques {}", fmt::join(options.techniques, ",")));
  report.leftOut = plan.leftOut;
  for (const ErrorRow& row : report.rows)
    if (const std::string line = row.contains("published") ? describePublished(row) : ""; !line.empty())
      report.leftOut.push_back(line);
  writeFileAtomically(folder / "error.csv", csvOf(report));
  writeFileAtomically(folder / "error.json", errorBenchJson(*result, options).dump(2) + "\n");
  plotRows(folder, report);
  HtmlPage page("Lucerna: " + plan.title);
  addToPage(page, folder, report, kPageBytes);
  writeFileAtomically(folder / "report.html", page.text());
  result->complete = true;
  return result;
}

std::unique_ptr<ErrorBenchResult> benchScene(const CommonOptions& common, ErrorBenchOptions& options) {
  common.apply();
  options.quiet = common.quiet;
  options.scene = sceneOrAtrium(options.scene);
  const Scene scene = loadScene(options.scene, options.time);
  const auto host = common.makeHost(false);
  const gl::Context context;
  gl::ProgramLibrary programs;
  watchForInterrupt();
  auto result = runErrorBench(context, programs, scene, options, std::string(nameOf(host->kind())));
  if (result->complete) return result;
  const bool isPart = options.part.isPart();
  fmt::print(stderr, "lucerna: interrupted; the same command with {} {} resumes\n", isPart ? "--checkpoint" : "--out",
             isPart ? options.part.checkpoint : options.out);
  return nullptr;
}

nlohmann::ordered_json errorBenchJson(const ErrorBenchResult& result, const ErrorBenchOptions& options) {
  const ErrorReport& report = result.report;
  nlohmann::ordered_json json;
  json["renderer"] = report.renderer;
  json["host"] = report.host;
  json["cpu"] = report.cpu;
  json["driver"] = report.driver;
  json["program"] = programVersion();
  json["command"] = report.command;
  json["bench"] = report.title;
  json["scene"] = options.scene;
  json["size"] = options.size;
  json["references"] = referencesJson(result.references);
  json["model"] = modelJson(report.model);
  json["inside_models"] = insideModelsJson(report.inside);
  json["left_out"] = report.leftOut;
  json["relmse_epsilon"] = measure::kRelativeEpsilon;
  json["sweeps"] = sweepsJson(report.rows);
  json["choices"] = choiceJson(report.rows);
  json["path_slope"] = pathSlopeJson(report.rows);
  json["baselines"] = report.baselines;
  json["rows"] = report.rows;
  return json;
}

}  // namespace bench

namespace {

struct ErrorOptions {
  CommonOptions common;
  bench::ErrorBenchOptions bench;
};

int runError(ErrorOptions options) {
  if (options.bench.out.empty()) options.bench.out = options.bench.deviations ? "bench-deviations" : "bench-error";
  const auto result = bench::benchScene(options.common, options.bench);
  if (!result) return exitCode();
  if (options.bench.part.isPart()) {
    if (!options.common.quiet) fmt::print("{}: {} rows\n", options.bench.part.checkpoint, result->partRows);
    options.common.writeJson({{"part", options.bench.part.part}, {"rows", result->partRows}});
    return 0;
  }
  if (!options.common.quiet)
    fmt::print("{}\n{}/report.html\n", bench::terminalTable(result->report), options.bench.out);
  options.common.writeJson(bench::errorBenchJson(*result, options.bench));
  return 0;
}

struct ReferencesOptions {
  CommonOptions common;
  bench::ErrorBenchOptions bench;
};

int runReferences(ReferencesOptions options) {
  options.common.apply();
  bench::ErrorBenchOptions& bench = options.bench;
  bench.quiet = options.common.quiet;
  bench.scene = bench::sceneOrAtrium(bench.scene);
  const Scene scene = loadScene(bench.scene, bench.time);
  const auto host = options.common.makeHost(false);
  const gl::Context context;
  gl::ProgramLibrary programs;
  watchForInterrupt();
  const bench::ErrorBenchPlan plan(scene, bench);
  const bench::ReferenceBatches result =
      bench::sampleReferences(plan.references(context, programs, bench), bench.part, plan.title);
  if (!result.complete) {
    fmt::print(
        stderr, "lucerna: interrupted{}\n",
        bench.part.checkpoint.empty() ? "; nothing is stored without --checkpoint" : "; the same command goes on");
    return exitCode();
  }
  nlohmann::ordered_json json{{"renderer", context.capabilities().renderer},
                              {"bench", plan.title},
                              {"samples", bench.referenceSamples},
                              {"batches", result.batches},
                              {"made", result.made}};
  json["files"] = nlohmann::ordered_json::array();
  for (const auto& file : result.stored) json["files"].push_back(file.string());
  if (!bench.quiet)
    fmt::print("{}: {} batches, {} of them made now{}\n", plan.title, result.batches, result.made,
               bench.part.isPart() ? "" : fmt::format("; {} references", result.stored.size()));
  options.common.writeJson(json);
  return 0;
}

}  // namespace

Work addBenchReferences(Command app) {
  auto options = std::make_shared<ReferencesOptions>();
  app.addOption("SCENE", options->bench.scene, "a scene file (default: the atrium)").scene();
  options->bench.declareView(app);
  app.addOption("--reference-spp", options->bench.referenceSamples, "paths per pixel of every reference")
      .required()
      .range(2, 1 << 30);
  app.addFlag("--deviations", options->bench.deviations, "those of bench error --deviations");
  options->bench.part.declare(app, "batches");
  options->common.declare(app);
  return [options] { return runReferences(*options); };
}

Work addBenchError(Command app) {
  auto options = std::make_shared<ErrorOptions>();
  app.addOption("SCENE", options->bench.scene, "a scene file (default: the atrium)").scene();
  options->bench.declare(app);
  app.addFlag("--deviations", options->bench.deviations,
              "measure each deviation of the originals alone, instead of sweeps of settings");
  options->bench.part.declare(app, "rows");
  options->common.declare(app);
  return [options] { return runError(*options); };
}

}  // namespace lucerna::demo
