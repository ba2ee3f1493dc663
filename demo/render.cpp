// lucerna render SCENE ... -o OUT: one picture. PNG is tone mapped; hdr, exr and pfm keep linear radiance.
#include "inspect.hpp"
#include "base/clock.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/log.hpp"
#include "irradiance_cache/irradiance_cache_frame.hpp"
#include "radiosity/radiosity_frame.hpp"
#include "radiosity/radiosity_view.hpp"
#include "rsm/rsm_frame.hpp"
#include "shared/commands.hpp"
#include "gl/draw.hpp"
#include "shared/completions.hpp"
#include "pathtracer/inspect_paths.hpp"
#include "render_path.hpp"
#include "scene/scene_file.hpp"
#include "render/deviations.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace lucerna::demo {

namespace {

struct RenderOptions {
  CommonOptions common;
  PictureOptions picture;
  PathOptions path;
  SceneAt scene;
  std::string output, inspected;
  int repeat = 1;
};

/// Radiosity's direct light, unless it is chosen: by pixels, but by patches where a deviation is switched on, whose
/// error shadow rays would hide.
void chooseDirectLight(RenderSettings& settings) {
  auto& view = settings.of<RadiosityView::Settings>();
  if (view.direct == RadiosityView::Direct::automatic)
    view.direct = activeRadiosityDeviations(view.solution.deviations).empty() ? RadiosityView::Direct::pixels
                                                                              : RadiosityView::Direct::patches;
}

/// Radiosity is solved here, for minutes: it can be interrupted and resumed. What follows takes seconds.
std::unique_ptr<Renderer> makeRenderer(const RenderOptions& options, const gl::Context& context,
                                       gl::ProgramLibrary& programs, const Scene& scene,
                                       const RenderSettings& settings) {
  if (settings.technique != "radiosity") return std::make_unique<Renderer>(context, programs, scene, settings);
  watchForInterrupt();
  Progress progress("hemicubes", 1000, options.common.quiet);
  const auto watch = watchSolutions([&](const RadiosityStage& stage) {
    showProgress(progress, stage);
    return true;
  });
  auto renderer = std::make_unique<Renderer>(context, programs, scene, settings);
  endAtInterrupt();
  return renderer;
}

/// --inspect: prints what lit a pixel. Path tracing traces only that pixel's paths.
int inspect(const RenderOptions& options) {
  if (!options.output.empty())
    throwBadInput("--inspect {}: prints JSON and writes no picture; cannot be combined with -o", options.inspected);
  const PathOptions& path = options.path;
  if (path.seconds || path.error || !path.samples.empty() || !path.part.empty() || !path.checkpoint.empty())
    throwBadInput("--inspect {}: with path tracing accepts --spp, --bounces and --seed", options.inspected);
  RenderSettings settings = options.picture.parse();
  settings.pixelSamples = 1;  // what lit its centre
  settings.fullFloatTarget = true;
  chooseDirectLight(settings);
  const glm::ivec2 pixel = parsePixel(options.inspected, settings.size);
  const auto [scene, camera] = options.scene.load();
  settings.wholePictures = !scene.motion;  // else it is the picture that a recording has of the moment
  const auto host = options.common.makeHost(false);
  const gl::Context context;
  gl::ProgramLibrary programs;
  PixelInspection answer;
  if (settings.technique == "path") {
    answer = inspectPaths(context, programs, scene, camera, tracerSettings(options.picture, path, settings),
                          path.spp.value_or(static_cast<std::uint32_t>(settings.of<PathSettings>().samples)), pixel);
  } else {
    const auto made = makeRenderer(options, context, programs, scene, settings);
    Renderer& renderer = *made;
    renderer.renderToTheEnd(camera);
    answer = renderer.inspect(programs, camera, pixel);
    renderer.drain();
  }
  answer.checkSum();
  answer.condense(kInspectedShares);
  const nlohmann::ordered_json json = toJson(answer);
  fmt::print("{}\n", json.dump(2));
  options.common.writeJson(json);
  return 0;
}

int runRender(RenderOptions options) {
  // Check the request before any work.
  options.common.apply();
  if (!options.output.empty()) checkWritable(options.output);
  options.picture.readSettingsFile();
  if (!options.path.spp) options.path.spp = options.picture.settingsSpp;
  if (options.picture.technique != "path") options.path.refuseIfGiven(options.picture.technique);
  if (!options.inspected.empty()) return inspect(options);
  if (options.picture.technique == "path")
    return renderPath(options.common, options.picture, options.path, options.scene, options.output);
  if (options.output.empty()) throwBadInput("--output is missing: the file for the picture");
  RenderSettings settings = options.picture.parse();
  settings.fullFloatTarget = true;
  chooseDirectLight(settings);
  if (!isWritableImageName(options.output))
    throwBadInput("-o {}: the extension must be png, hdr, exr or pfm", options.output);
  const auto [scene, camera] = options.scene.load();
  settings.wholePictures = !scene.motion;  // else it is the picture that a recording has of the moment

  // Render.
  const auto host = options.common.makeHost(false);
  gl::Context context;
  if (std::max(settings.size.x, settings.size.y) > context.capabilities().maxTextureSize)
    throwMissingCapability("--size {}: this driver's limit is {} pixels", options.picture.size,
                           context.capabilities().maxTextureSize);
  gl::ProgramLibrary programs;
  const auto made = makeRenderer(options, context, programs, scene, settings);
  Renderer& renderer = *made;
  const auto start = Clock::now();
  for (int i = 0; i < options.repeat; ++i) renderer.renderToTheEnd(camera);
  gl::finish();
  const double seconds = secondsSince(start) / options.repeat;
  renderer.drain();

  // Write the picture, then report for people and as JSON.
  const Image image = renderer.readRadiance();
  if (lowerExtension(options.output) == ".png") writePng(options.output, renderer.readDisplay());
  else writeImage(options.output, image);
  const glm::dvec3 mean = meanOf(image);
  if (mean == glm::dvec3(0.0)) logWarning("the picture is black: {}", kNoLightSeen);
  if (!options.common.quiet) {
    fmt::print("{}: {}x{}, {}, {}, mean radiance {:.6g} {:.6g} {:.6g}, {:.3f} s per frame on {}\n", options.output,
               image.width, image.height, options.picture.technique, options.picture.component, mean.x, mean.y, mean.z,
               seconds, context.capabilities().renderer);
    if (renderer.technique()) fmt::print("{}", renderer.technique()->summary());
    if (options.repeat > 1)
      fmt::print("{}", stagesTable(renderer.timer().statistics(), context.capabilities().renderer));
  }
  nlohmann::ordered_json json;
  json["renderer"] = context.capabilities().renderer;
  json["host"] = nameOf(host->kind());
  json["scene"] = options.scene.file;
  if (options.scene.time != 0.0) json["time"] = options.scene.time;
  json["technique"] = options.picture.technique;
  json["component"] = options.picture.component;
  json["fidelity"] = options.picture.fidelity;
  json["deviations"] = activeDeviations(settings);
  json["settings"] = options.picture.settings;
  json["size"] = {image.width, image.height};
  json["seconds"] = seconds;
  json["mean"] = {mean.x, mean.y, mean.z};
  json["gpu_bytes"] = renderer.gpuBytes();
  json["left_out"] = renderer.leftOut();
  if (gatherOf(renderer.technique())) json["rsm"] = gatherJson(*gatherOf(renderer.technique()));
  if (cacheOf(renderer.technique())) json["cache"] = cacheJson(*cacheOf(renderer.technique()));
  if (options.repeat > 1) json["stages"] = stagesJson(renderer.timer().statistics());
  if (const RadiosityView* view = radiosityOf(renderer.technique())) {
    const RadiositySolution& s = view->solution();
    json["radiosity"] = {{"patches", s.mesh.patches.size()},
                         {"degenerate", s.mesh.degenerate},
                         {"solver", nameOf(s.solver)},
                         {"products", s.progress.products},
                         {"error_bound", s.progress.errorBound},
                         {"energy_balance", s.progress.energyBalance},
                         {"hemicubes", s.hemicubes},
                         {"hemicube_seconds", s.hemicubeSeconds},
                         {"solve_seconds", s.solveSeconds},
                         {"repaired", s.repaired},
                         {"entries", s.entries}};
    if (!options.common.quiet)
      fmt::print(
          "radiosity: {} patches, {} hemicubes in {:.2f} s ({:.0f}/s), solved by {} in {:.1f} products to {:.2g} "
          "(guaranteed), energy balance {:.2g}\n",
          s.mesh.patches.size(), s.hemicubes, s.hemicubeSeconds,
          s.hemicubeSeconds > 0.0 ? static_cast<double>(s.hemicubes) / s.hemicubeSeconds : 0.0, nameOf(s.solver),
          s.progress.products, s.progress.errorBound, s.progress.energyBalance);
  }
  options.common.writeJson(json);
  return 0;
}

}  // namespace

Work addRender(Command app) {
  auto options = std::make_shared<RenderOptions>();
  app.addOption("SCENE", options->scene.file,
                "a scene file (JSON, OBJ, glTF, PLY, ...), or the name of a shipped scene")
      .required()
      .scene();
  app.addOption("--camera", options->scene.camera,
                "a camera's name, or px,py,pz,tx,ty,tz,fov (position, target, degrees)");
  app.addOption("-o,--output", options->output,
                "OUT.{png,hdr,exr,pfm}; png is tone mapped, the others are linear; may be left out with --samples");
  options->scene.declare(app);
  app.addOption("--repeat", options->repeat, "draw this many frames, for stage times").range(1, 100000).showDefault();
  app.addOption(
      "--inspect", options->inspected,
      "X,Y: instead of writing a picture, print as JSON what lit this pixel, from the top left: each lamp, texel, "
      "cell, cache record, patch or path, with its share");
  options->picture.declare(app);
  options->path.declare(app);
  options->common.declare(app);
  return [options, size = app.find("--size")] {
    options->path.sizeGiven = size.count() > 0;
    return runRender(*options);
  };
}

}  // namespace lucerna::demo
