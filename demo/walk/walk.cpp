// lucerna walk [SCENE]: the walkthrough. In a window the camera path plays in real time: slow drawing skips views, and
// the walk ends with the path if no panel is shown. Without a window, or with --record, views spread over the path are
// rendered and written, with the time of every stage.
#include "base/clock.hpp"
#include "base/data.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/hash.hpp"
#include "base/log.hpp"
#include "irradiance_cache/irradiance_cache_frame.hpp"
#include "pathtracer/path_frame.hpp"
#include "rsm/rsm_frame.hpp"
#include "shared/commands.hpp"
#include "gl/draw.hpp"
#include "measure/image_errors.hpp"
#include "measure/reference.hpp"
#include "shared/completions.hpp"
#include "scene/fingerprint.hpp"
#include "scene/key_frames.hpp"
#include "render/deviations.hpp"
#include "walk/keys.hpp"
#include "walk/options.hpp"
#include "walk/recent_files.hpp"
#include "shared/paths.hpp"
#include "scene/motion.hpp"
#include "scene/scene_file.hpp"
#include "scene/studio.hpp"
#include "walk/window.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>

namespace lucerna::demo {

namespace {

namespace fs = std::filesystem;

// Views of the path as "FIRST:LAST"; empty means all.
std::pair<int, int> parseViews(const std::string& text, int viewCount) {
  if (text.empty()) return {0, viewCount - 1};
  int first = -1, last = -1;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%d:%d%c", &first, &last, &rest) != 2 || first < 0 || last < first || last >= viewCount)
    throwBadInput("--views {}: expected FIRST:LAST within 0:{}", text, viewCount - 1);
  return {first, last};
}

nlohmann::ordered_json resultJson(const WalkOptions& options, const Host& host, const gl::Context& context,
                                  Renderer& renderer, int frames, double seconds) {
  nlohmann::ordered_json json;
  json["renderer"] = context.capabilities().renderer;
  json["host"] = nameOf(host.kind());
  json["scene"] = options.scene;
  json["technique"] = options.picture.technique;
  json["fidelity"] = options.picture.fidelity;
  json["deviations"] = activeDeviations(renderer.settings());
  json["settings"] = options.picture.settings;
  json["size"] = {renderer.size().x, renderer.size().y};
  if (host.swapInterval()) json["swap_interval"] = *host.swapInterval();
  json["frames"] = frames;
  json["seconds"] = seconds;
  json["stages"] = stagesJson(renderer.timer().statistics());
  json["gpu_bytes"] = renderer.gpuBytes();
  json["left_out"] = renderer.leftOut();
  if (gatherOf(renderer.technique())) json["rsm"] = gatherJson(*gatherOf(renderer.technique()));
  if (cacheOf(renderer.technique())) json["cache"] = cacheJson(*cacheOf(renderer.technique()));
  return json;
}

/// Whether a scene that moves is seen from its first camera, as no path is named.
bool standsStill(const WalkOptions& options, const Scene& scene) {
  return scene.motion && scene.keyFrames.empty() && options.views.empty();
}

/// Seconds of the scene's time from one recorded frame to the next.
double stepOf(const WalkOptions& options, const Scene& scene, int frames) {
  if (!scene.motion) return 0.0;
  if (options.fps > 0.0) return 1.0 / options.fps;
  return std::max(scene.motion->end - options.time, 0.0) / std::max(frames - 1, 1);
}

/// The frames of a walk as units of work. Scene, settings and cameras determine a frame, so they identify the folder.
PartFolder framesOf(const WalkOptions& options, const Scene& scene, const Renderer& renderer,
                    const std::vector<Camera>& cameras, double step) {
  if (options.part.checkpoint.empty()) return PartFolder(options.part, "walk", "", cameras.size());
  if (options.flicker)
    throwBadInput(
        "--flicker: compares a frame with the one before it, which may be another part's: not with --part and "
        "--checkpoint");
  if (cacheOf(renderer.technique()) && !scene.motion)
    throwBadInput(
        "--technique irradiance-cache: a frame goes on from the one before it, which may be another part's: not with "
        "--part and --checkpoint");
  Hash views;
  for (const Camera& camera : cameras) addCamera(views, camera);
  const std::string settings = options.picture.toJson().dump();
  return PartFolder(
      options.part, "walk",
      fmt::format("{}{}, scene {}, views {:016x}, {}", scene.name,
                  scene.motion ? fmt::format(", from {} s, a frame each {} s", options.time, step) : "",
                  measure::keyOf(scene, cameras.front(), renderer.size(), Transport::all, settings).name(),
                  views.value(), settings),
      cameras.size());
}

int record(const WalkOptions& options, const Host& host, const gl::Context& context, gl::ProgramLibrary& programs,
           Scene& scene, std::unique_ptr<Renderer> renderer, const Spline& path) {
  const fs::path folder = options.record.empty() ? fs::path("walk") : fs::path(options.record);
  std::error_code error;
  if (!options.part.isPart()) fs::create_directories(folder, error);
  if (error || (!options.part.isPart() && !fs::is_directory(folder)))
    throwBadInput("--record {}: cannot create folder ({})", folder.string(), error.message());
  const auto [first, last] = parseViews(options.views, path.viewCount());
  const int frames = options.frames > 0 ? options.frames : 12;
  const bool stands = standsStill(options, scene);
  std::vector<int> views;
  std::vector<Camera> cameras;
  for (int i = 0; i < frames; ++i) {
    views.push_back(frames > 1
                        ? first + static_cast<int>(std::lround(static_cast<double>(last - first) * i / (frames - 1)))
                        : first);
    cameras.push_back(path.view(views.back()));
  }
  const RenderSettings settings = renderer->settings();
  const double step = stepOf(options, scene, frames);
  const PartFolder part = framesOf(options, scene, *renderer, cameras, step);

  watchForInterrupt();
  renderer->renderSamples(path.view(first),
                          path.view(first));  // warm-up: drivers finish shaders on first use; its times are dropped
  constexpr int kFramesAtRest = 64;  // flicker of a walk from where one has stood, not of a cut's first frames
  for (int i = 0; options.flicker && i < kFramesAtRest; ++i)
    renderer->renderSamples(path.view(first), path.view(first));
  Progress progress("walk", static_cast<int>(part.last() - part.first()), options.common.quiet);
  std::vector<double> frameSeconds;
  std::optional<int> before;
  measure::Change largest;
  nlohmann::ordered_json changes = nlohmann::ordered_json::array();
  int done = 0;
  for (std::size_t i = part.first(); i < part.last() && !interrupted(); ++i, ++done) {
    const fs::path file = folder / fmt::format("frame_{:04}.png", i);
    if (const auto kept = part.load(i)) {
      frameSeconds.push_back(kept->at("seconds").get<double>());
    } else {
      const auto start = Clock::now();
      if (scene.motion) {
        const SceneChange change = poseAt(scene, options.time + static_cast<double>(i) * step);
        if (!renderer->follow(context, programs, scene, change))
          renderer = std::make_unique<Renderer>(context, programs, scene, settings);
      }
      if (scene.motion) renderer->forget();  // a moment's picture depends on no frame before
      if (stands) cameras[i] = scene.cameras.front();
      // All samples of paths, of which one alone is mere noise; all light, where each frame starts anew.
      if (pathOf(renderer->technique()) || scene.motion) renderer->renderToTheEnd(cameras[i]);
      else renderer->renderSamples(cameras[i], cameras[i]);
      gl::finish();
      frameSeconds.push_back(secondsSince(start));
      writePng(part.folder() ? part.file(i, ".png") : file, renderer->readDisplay());
      part.store(i, {{"seconds", frameSeconds.back()}});  // stored last: it says that the picture is complete
    }
    if (part.folder() && !part.isPart()) writeFileAtomically(file, readFileBytes(part.file(i, ".png")));
    if (options.flicker && before) {
      // The same view, once with its own volume and once with the previous view's: motion cancels, flicker remains.
      const Image now = renderer->readRadiance();
      renderer->renderSamples(cameras[i], path.view(*before));
      const measure::Change change = measure::changeBetween(renderer->readRadiance(), now);
      largest = {std::max(largest.mean, change.mean), std::max(largest.block, change.block)};
      changes.push_back({{"view", views[i]}, {"mean", change.mean}, {"block", change.block}});
    }
    before = views[i];
    progress.update(done + 1);
  }
  if (!interrupted()) part.finish();
  renderer->drain();
  double seconds = 0.0;
  for (double s : frameSeconds) seconds += s;
  if (!options.common.quiet) {
    fmt::print("{} pictures {}x{} in {}, {:.2f} frames per second\n", done, renderer->size().x, renderer->size().y,
               part.isPart() ? part.folder()->string() : folder.string(), done / seconds);
    fmt::print("{}", stagesTable(renderer->timer().statistics(), context.capabilities().renderer));
    if (renderer->technique()) fmt::print("{}", renderer->technique()->summary());
    if (options.flicker)
      fmt::print(
          "flicker, largest change of a view when its volume is that of the view before: {:.3f} % of the mean, {:.2f} "
          "% in any 16x16 block\n",
          100.0 * largest.mean, 100.0 * largest.block);
  }
  nlohmann::ordered_json json = resultJson(options, host, context, *renderer, done, seconds);
  json["frames_per_second"] = done / seconds;
  if (options.flicker) json["flicker"] = {{"mean", largest.mean}, {"block", largest.block}, {"views", changes}};
  options.common.writeJson(json);
  return exitCode();
}

/// Runs the walk in a window, or by recorded input.
int play(const WalkOptions& options, Host& host, const gl::Context& context, gl::ProgramLibrary& programs, Scene scene,
         Spline path) {
  // The initial state of the window.
  watchForInterrupt();
  WalkState state;
  state.scene = std::make_unique<Scene>(std::move(scene));
  state.sceneText = options.scene;
  state.materialsAsLoaded = state.scene->materials;
  state.exposure = state.scene->exposure;
  const auto [first, last] = parseViews(options.views, path.viewCount());
  state.path.first = first;
  state.path.last = last;
  state.camera.emplace(path.view(first), 0.08 * glm::length(state.scene->bounds.extent()));
  state.path.spline = std::move(path);
  if (standsStill(options, *state.scene)) {
    state.path.follows = false;
    state.camera->place(state.scene->cameras.front());
  }
  state.sides[0].options = state.sides[1].options = options.picture;
  state.sides[1].options.technique = options.picture.technique == "direct" ? "irradiance-cache" : "direct";
  state.sides[1].options.settings.clear();
  state.sides[1].options.deviations.clear();
  state.shotFolder = options.shots;
  const bool measures = !options.common.json.empty() && options.playInput.empty();
  state.panel = options.panel == "on" || (options.panel == "auto" && !measures);
  state.path.loops = state.scene->motion && state.panel;  // as its time does
  state.hint = !measures;
  state.messageAge = measures ? 1e9 : 0.0;
  // Run until it is closed, then report.
  if (host.kind() == HostKind::window && options.playInput.empty()) rememberFile(options.scene);
  WalkWindow window(options, host, context, programs, std::move(state));
  window.run();
  SideState& side = window.state().sides[0];
  if (!side.renderer) return exitCode();
  Renderer& renderer = *side.renderer;
  if (!options.common.quiet)
    fmt::print("{} frames in {:.1f} s\n{}", window.frames(), window.seconds(),
               stagesTable(renderer.timer().statistics(), context.capabilities().renderer));
  nlohmann::ordered_json json = resultJson(options, host, context, renderer, window.frames(), window.seconds());
  json["window"] = window.toJson();
  options.common.writeJson(json);
  return exitCode();
}

int runWalk(WalkOptions options) {
  if (options.capture >= 0 && !RenderDoc::find()) {
    RenderDoc::preload();
    throwMissingCapability(
        "--capture {}: librenderdoc.so is not there, or does not work: install RenderDoc (apt install renderdoc)",
        options.capture);
  }
  options.common.apply();
  options.picture.readSettingsFile();
  if (options.scene.empty()) options.scene = (dataFolder() / "assets/atrium/day.json").string();
  if (!options.record.empty() && fs::exists(options.record) && !fs::is_directory(options.record))
    throwBadInput("--record {}: is a file, expected a folder", options.record);
  Scene scene = loadScene(options.scene);
  if (options.records() && !scene.motion) options.picture.usualSamples = 1;  // frames are timed
  RenderSettings settings = options.picture.parse();
  settings.fullFloatTarget = options.records() && scene.motion;  // as render --time
  if (!options.noFloor && scene.studio) addFloor(scene);
  if (!options.keys.empty()) {
    setKeyFrames(scene, options.keys, false);
    finishMotion(scene);
  }
  Spline path = pathOf(scene);
  parseViews(options.views, path.viewCount());

  HostOptions hostOptions;
  hostOptions.windowSize = settings.size;
  hostOptions.windowTitle = "Lucerna - " + scene.name;
  hostOptions.swapAtRefresh = options.common.json.empty();  // with --json, frames are measured
  const auto host = options.common.makeHost(!options.records(), hostOptions);
  const gl::Context context;
  gl::ProgramLibrary programs;
  if ((host->kind() == HostKind::window || !options.playInput.empty()) && !options.records())
    return play(options, *host, context, programs, std::move(scene), std::move(path));
  poseAt(scene, options.time);
  watchForInterrupt();
  const auto watch = watchSolutions();
  return record(options, *host, context, programs, scene,
                std::make_unique<Renderer>(context, programs, scene, settings), path);
}

}  // namespace

Work addWalk(Command app) {
  auto options = std::make_shared<WalkOptions>();
  app.addOption("SCENE", options->scene,
                "a scene file, or the name of a shipped scene, such as cornell (default: a day in the atrium)")
      .scene();
  app.addOption(
      "--keys", options->keys,
      "key frames of the camera path and of what is carried (default: the scene's, else one round around it)");
  app.addOption("--record", options->record,
                "draw off-screen and write pictures into this folder (without a window: walk)");
  options->part.declare(app, "frames of --record");
  app.addOption("--frames", options->frames, "number of pictures (12), or frames in a window (the whole path)")
      .range(1, 1000000);
  app.addOption("--fps", options->fps,
                "with --record, of scenes that move: pictures a second of the scene's time (default: they span it)")
      .range(1e-6, 1e6);
  app.addOption("--time", options->time, "with --record, of scenes that move: seconds at the first picture")
      .range(-1e12, 1e12)
      .showDefault();
  app.addOption("--views", options->views, "FIRST:LAST: only these views of the path; 200 between two key frames");
  app.addFlag("--flicker", options->flicker,
              "measure how much the light itself changes between pictures, without the camera's motion");
  app.addOption("--play-input", options->playInput,
                "drive the window by this file of recorded input (demo/walk/input_file.hpp), on any host");
  app.addOption("--capture", options->capture, "in a window: the frame, from 0, that RenderDoc captures")
      .range(0, 1000000);
  app.addOption("--shots", options->shots, "folder for screenshots").showDefault();
  addCompletions(
      app.addOption("--panel", options->panel,
                    "whether the panel is open at the start: on, off or auto (auto: on, but not with --json)"),
      {"on", "off", "auto"});
  app.addFlag("--no-floor", options->noFloor, "models without light of their own: not on our grey floor");
  options->picture.declare(app);
  options->common.declare(app);
  app.setFooter(keysHelp() + "\n" + app.footer());
  return [options] { return runWalk(*options); };
}

}  // namespace lucerna::demo
