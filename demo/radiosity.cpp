// lucerna radiosity generate|solve|show: the three programs of the radiosity original, on its own file format and on
// any mesh.
#include "radiosity.hpp"

#include "base/error.hpp"
#include "base/files.hpp"
#include "base/log.hpp"
#include "shared/completions.hpp"
#include "radiosity/direct_light.hpp"
#include "radiosity/original/rad_file.hpp"
#include "radiosity/original/rad_models.hpp"
#include "radiosity/original/rad_scene.hpp"
#include "scene/features.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <sys/stat.h>

namespace lucerna::demo {

namespace {

struct Generate {
  CommonOptions common;
  std::string file, model;  // 1, 2, 3, or a scene file
  std::vector<double> numbers;  // threshold, reflectance, light power; all or none
  std::optional<double> edge;  // for a scene's triangles
  bool lights = false;  // of a scene: sun, lamps and environment, as its surfaces reflect them
  std::optional<unsigned> triangles;  // of a scene: at most this many, by a coarser model
  std::uint32_t power = RadSceneSettings{}.lightPower;
};

/// Light of sun, lamps and environment on each patch.
std::vector<glm::dvec3> cachedLight(const Generate& options, const Scene& scene, const RadiosityMesh& mesh) {
  const auto host = options.common.makeHost(false);
  const gl::Context context;
  gl::ProgramLibrary programs;
  const RayScene rays(sceneOf(mesh), context.capabilities());
  std::vector<glm::dvec3> light = directLight(programs, rays, scene, mesh);
  if (!analyse(scene).environment) return light;
  const std::vector<glm::dvec3> sky = skyLight(programs, rays, scene, mesh);
  for (std::size_t i = 0; i < light.size(); ++i) light[i] += sky[i];
  return light;
}

int generateFromScene(const Generate& options) {
  if (!options.numbers.empty())
    throwBadInput(
        "{}: AREA_THRESHOLD REFLECTANCE LIGHT_POWER are of the models 1 to 3; a scene has --edge and --power, and its "
        "own reflectances",
        options.numbers[0]);
  if (options.power < 1 || options.power > kRadMost)
    throwBadInput("--power {}: expected 1 to {} (24 bits)", options.power, kRadMost);
  const auto [model, edge] = loadRadSource(options.model, options.edge, options.triangles);
  const Scene& scene = model.scene;
  RadReceived received;
  if (options.lights) received = [&](const RadiosityMesh& mesh) { return cachedLight(options, scene, mesh); };
  const RadScene made = radTrianglesOf(scene, {edge, options.power}, received);
  const bool hasOthers = scene.sun || !scene.spots.empty() || !scene.points.empty() || scene.environment;
  if (hasOthers && !options.lights)
    logWarning(
        "{}: the original's files have no lights except emissive triangles: its sun, lamps and environment are left "
        "out (--lights hands them over)",
        options.model);
  writeRadFile(options.file, made.triangles);
  if (!options.common.quiet && model.cell > 0.0)
    fmt::print(
        "{}: a coarser model: corners within cells of {:.4g} units were joined, {} triangles of {} are left and {:.1f} "
        "% of the area; emissive ones stay as they are\n",
        options.model, model.cell, scene.triangleCount(), model.triangles, 100.0 * model.area);
  if (!options.common.quiet)
    fmt::print(
        "{}: {}, {} triangles with edges of at most {:.6g} units ({} sources, the brightest of power {}), a step of e "
        "and b is {:.6g} W per square unit, {} bytes\n",
        options.file, options.model, made.triangles.size(), made.longestEdge, made.sources, options.power,
        made.exitanceOfStep, 4 + made.triangles.size() * sizeof(RadTriangle));
  nlohmann::ordered_json json;
  json["file"] = options.file;
  json["scene"] = options.model;
  json["triangles"] = made.triangles.size();
  json["sources"] = made.sources;
  json["longest_edge"] = made.longestEdge;
  json["lights"] = options.lights;
  json["model_cell"] = model.cell;
  json["model_area"] = model.area;
  json["light_power"] = options.power;
  json["exitance_of_step"] = made.exitanceOfStep;
  options.common.writeJson(json);
  return 0;
}

int generate(const Generate& options) {
  options.common.apply();
  const bool isModel = options.model.find_first_not_of("0123456789") == std::string::npos;
  if (!isModel) return generateFromScene(options);
  if (options.edge) throwBadInput("--edge {}: of a scene's triangles; the models have AREA_THRESHOLD", *options.edge);
  if (options.lights) throwBadInput("--lights: of a scene; the models have lamps of their own");
  if (options.triangles)
    throwBadInput("--triangles {}: of a scene; the models have AREA_THRESHOLD", *options.triangles);
  const int model = options.model.size() > 9 ? 0 : std::stoi(options.model);
  RadModelSettings settings;
  if (!options.numbers.empty()) {
    if (options.numbers.size() != 3)
      throwBadInput("AREA_THRESHOLD REFLECTANCE LIGHT_POWER: {} given, expected all three or none",
                    options.numbers.size());
    settings.areaThreshold = options.numbers[0];
    settings.reflectance = options.numbers[1];
    double power = options.numbers[2];
    // The manual allows 2^24, which just does not fit into three bytes.
    if (power == 16777216.0) {
      logWarning("LIGHT_POWER 16777216: does not fit into 24 bits; using {}", kRadMost);
      power = kRadMost;
    }
    if (!(power >= 0.0 && power <= kRadMost))
      throwBadInput("LIGHT_POWER {}: expected 0 to {} (24 bits)", power, kRadMost);
    if (power != std::floor(power)) throwBadInput("LIGHT_POWER {}: expected a whole number", power);
    settings.lightPower = static_cast<std::uint32_t>(power);
  }
  const std::vector<RadTriangle> triangles = makeRadModel(model, settings);
  writeRadFile(options.file, triangles);
  const auto sources = std::count_if(triangles.begin(), triangles.end(), [](const RadTriangle& t) { return t.e > 0; });
  double area = 0.0;
  for (const RadTriangle& t : triangles) area += areaOf(t);
  if (!options.common.quiet)
    fmt::print("{}: model {}, {} triangles below {} square units ({} sources of power {}), reflectance {}, {} bytes\n",
               options.file, model, triangles.size(), settings.areaThreshold, sources, settings.lightPower,
               settings.reflectance, 4 + triangles.size() * sizeof(RadTriangle));
  nlohmann::ordered_json json;
  json["file"] = options.file;
  json["model"] = model;
  json["triangles"] = triangles.size();
  json["sources"] = sources;
  json["area"] = area;
  json["area_threshold"] = settings.areaThreshold;
  json["reflectance"] = settings.reflectance;
  json["light_power"] = settings.lightPower;
  options.common.writeJson(json);
  return 0;
}

Work addGenerate(Command app) {
  auto options = std::make_shared<Generate>();
  app.addOption("FILE", options->file, "the triangle file to write").required();
  addCompletions(
      app.addOption("MODEL", options->model,
                    "1: a cube lit by a small square; 2: a hall with columns; 3: light round an obstacle; or a "
                    "scene file: OBJ, glTF, PLY, ...")
          .required(),
      {"1", "2", "3"});
  app.addOption("NUMBERS", options->numbers,
                "AREA_THRESHOLD REFLECTANCE LIGHT_POWER (2.5 0.15 100000): triangles are halved until smaller than "
                "the area; 0 to 1; 0 to 16777215")
      .values(0, 3);
  app.addOption("--edge", options->edge,
                "of a scene: longest edge of the triangles in scene units (a 12th of the scene)")
      .positive();
  app.addOption("--triangles", options->triangles,
                "of a scene: at most this many, by longer edges (without --edge), and by joining corners in cells of a "
                "grid; emissive ones stay")
      .range(4u, 100'000'000u);
  app.addFlag("--lights", options->lights,
              "of a scene: what surfaces reflect of sun, lamps and environment is their own emission");
  app.addOption("--power", options->power, "of a scene: e of its brightest triangle, 1 to 16777215").showDefault();
  app.setFooter("As published: lucerna radiosity generate model1.out 1 2.5 0.15 100000");
  options->common.declare(app);
  return [options] { return generate(*options); };
}

int solve(const RadiositySolve& options) {
  options.common.apply();
  if (options.resolution < 2 || options.resolution > 4096)
    throwBadInput("RESOLUTION {}: expected 2 to 4096 pixels", options.resolution);
  if (options.maxSweeps < 0) throwBadInput("--max-sweeps {}: expected 0 (no limit) or more", options.maxSweeps);
  checkWritable(options.out);
  if (!(options.saveEvery >= 0.0)) throwBadInput("--save-every {}: expected seconds, 0 or more", options.saveEvery);
  if (options.nearPlane && !(*options.nearPlane > 0.0 && std::isfinite(*options.nearPlane)))
    throwBadInput("--near-plane {}: expected a distance above 0", *options.nearPlane);
  if (options.fidelity == "original" && !options.set.empty())
    throwBadInput("--set {}: the published program has no such settings", options.set.front());
  if (options.fidelity == "original")
    for (const auto& [option, assignment] : options.shortSettings)
      if (option == "--visibility")
        throwBadInput("--visibility {}: only with --fidelity corrected; the published program draws colours",
                      assignment.substr(assignment.find('=') + 1));
  if (options.fidelity == "original" && (options.part.isPart() || !options.part.checkpoint.empty()))
    throwBadInput(
        "--part, --checkpoint: the published program makes its hemicubes one after another; they are for --fidelity "
        "corrected");
  if (options.fidelity == "original") return solveOriginal(options);
  if (options.fidelity != "corrected")
    throwBadInput("--fidelity {}: unknown; expected one of corrected, original", options.fidelity);
  return solveCorrected(options);
}

std::string radiosityDeviationsHelp() {
  std::string text = "Deviations (--deviation NAME=on|off; all are on with --fidelity original):\n";
  for (const RadiosityDeviation& deviation : allRadiosityDeviations())
    text += fmt::format("  {:<24} {}\n", deviation.name, deviation.meaning);
  return text;
}

Work addSolve(Command app) {
  auto options = std::make_shared<RadiositySolve>();
  app.addOption("IN", options->in, "a triangle file; corrected: or any scene").required();
  app.addOption("OUT", options->out,
                "file to save every sweep to; may be IN. Ctrl-C stops at any time, the same command resumes")
      .required();
  // Options that are shorthands for settings; the original reads some of them itself.
  auto shorter = std::make_shared<std::vector<std::pair<const char*, Option>>>();
  const auto shortFor = [&](const char* key, Option option) {
    shorter->emplace_back(key, option);
    return option;
  };
  shortFor("radiosity.resolution", app.addOption("RESOLUTION", options->resolution,
                                                 "pixels per side of a hemicube's face (original 500, corrected 64)"));
  addCompletions(app.addOption("--fidelity", options->fidelity, "corrected, or original: as published").showDefault(),
                 {"corrected", "original"});
  addCompletions(
      shortFor("radiosity.solver",
               app.addOption("--solver", options->solver,
                             "original: jacobi (default) or gauss-seidel; corrected: auto, jacobi, gauss-seidel, "
                             "progressive, anderson, cg")),
      {"auto", "jacobi", "gauss-seidel", "progressive", "anderson", "cg"});
  std::vector<std::string> switches;
  for (const RadiosityDeviation& deviation : allRadiosityDeviations())
    for (const char* state : {"=on", "=off"}) switches.push_back(deviation.name + std::string(state));
  addCompletions(app.addOption("--deviation", options->deviations,
                               "NAME=on|off: one deviation of the published original; may be repeated"),
                 switches);
  shortFor("radiosity.products",
           app.addOption("--max-sweeps", options->maxSweeps, "stop after this many sweeps (0: when nothing changes)")
               .showDefault());
  app.addOption("--near-plane", options->nearPlane, "near plane, scene units (1e-4 of the scene's diagonal)");
  shortFor(
      "radiosity.seed",
      app.addOption("--seed", options->seed, "of the random roll with radiosity.fixed-orientation=off").showDefault());
  app.addOption("--save-every", options->saveEvery, "seconds between checkpoints within a sweep").showDefault();
  app.addFlag("--restart", options->restart, "start over instead of resuming a stopped run");
  options->part.declare(app, "rows of hemicubes");
  const auto addShort = [&](const char* option, const char* key, const char* meaning) {
    return shortFor(key, app.addOption(option, std::string("corrected: ") + meaning));
  };
  addShort("--error", "radiosity.error", "stop at this guaranteed relative error (0.001)").typeName("FLOAT");
  addShort("--memory", "radiosity.memory",
           "MiB for form factors; more are read from OUT.rows for each product (half of what is free)")
      .typeName("FLOAT");
  addShort("--edge", "radiosity.edge", "longest edge of a scene's patches in scene units (a 12th of the scene)")
      .typeName("FLOAT");
  addShort("--refinements", "radiosity.refinements",
           "times that a scene's patches are halved where light changes steeply (0)")
      .typeName("INT");
  addCompletions(
      app.addOption(
          "--set", options->set,
          "corrected: radiosity.KEY=VALUE as lucerna render has them; comes after all other options; may be repeated"),
      settingCompletions(&kSolutionCost));
  addCompletions(addShort("--visibility", "radiosity.visibility",
                          "visibility method of pixels: auto (measured at start), raster, rays, item-buffer"),
                 {"auto", "raster", "rays", "item-buffer"});
  app.setFooter(radiosityDeviationsHelp());
  options->common.declare(app);
  return [options, shorter] {
    for (const auto& [key, option] : *shorter) {
      if (option.count() == 0) continue;
      std::string value = option.last();
      if (option.name() == "RESOLUTION" && options->resolution % 2 != 0)
        value = std::to_string(options->resolution + 1);
      if (option.name() == "--max-sweeps" && options->maxSweeps == 0) continue;  // no limit but the setting's own
      options->shortSettings.emplace_back(option.name(), std::string(key) + "=" + value);
    }
    return solve(*options);
  };
}

}  // namespace

std::array<std::int64_t, 4> stampOf(const std::filesystem::path& file) {
  struct stat s {};
  if (::stat(file.c_str(), &s) != 0) return {};
  return {static_cast<std::int64_t>(s.st_ino), static_cast<std::int64_t>(s.st_size),
          static_cast<std::int64_t>(s.st_mtim.tv_sec), static_cast<std::int64_t>(s.st_mtim.tv_nsec)};
}

RadSource loadRadSource(const std::string& file, std::optional<double> edge, std::optional<unsigned> triangles) {
  RadSource source{{loadScene(file)}};
  const Scene& scene = source.model.scene;
  const glm::dvec3 extent = scene.bounds.extent();
  source.edge = edge.value_or(std::max({extent.x, extent.y, extent.z}) / 12.0);
  source.model.triangles = scene.triangleCount();
  if (triangles) {
    PatchSettings patches;
    patches.longestEdge = source.edge;
    const Scene whole = scene;
    source.model = edge ? coarserScene(whole, patches, *triangles) : coarserSceneAndEdge(whole, patches, *triangles);
    source.edge = source.model.longestEdge;
  }
  return source;
}

Work addRadiosity(Command app) {
  Subcommands commands(app);
  commands.add("generate", "Generate one of the original's three models, or triangles of any scene", addGenerate);
  commands.add("solve", "Compute the radiosity of a scene", addSolve);
  commands.add("show", "Show a triangle file in a window, or render a picture of it", addRadiosityShow);
  return commands.work();
}

}  // namespace lucerna::demo
