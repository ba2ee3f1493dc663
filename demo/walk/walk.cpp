// lucerna walk [SCENE]: the walkthrough. In a window the path plays in real time, views are skipped where drawing is slow, and it
// ends by itself; without one, or with --record, views spread over the path are drawn and written, with the time of every stage.
#include "base/data.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/log.hpp"
#include "commands.hpp"
#include "settings/deviations.hpp"
#include "scene/key_frames.hpp"
#include "walk/free_camera.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>

namespace lucerna::demo {

namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

struct Options {
  CommonOptions common;
  PictureOptions picture;
  std::string scene, keys, record, views;
  bool flicker = false;
  int frames = 0;  ///< 0: 12 when recording, the whole path in a window
};

double secondsSince(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

// A path where the scene names none: once round the middle of its bounds, looking at the centre.
std::vector<KeyFrame> orbit(const Scene& scene) {
  const glm::dvec3 centre = scene.bounds.centre();
  const Camera& first = scene.cameras.front();
  const glm::dvec3 arm = first.position - centre;
  std::vector<KeyFrame> keys;
  for (int i = 0; i <= 8; ++i) {
    const double angle = 2.0 * M_PI * i / 8.0;
    const glm::dvec3 turned(std::cos(angle) * arm.x + std::sin(angle) * arm.z, arm.y, std::cos(angle) * arm.z - std::sin(angle) * arm.x);
    const glm::dvec3 direction = glm::length(turned) > 0.0 ? -glm::normalize(turned) : glm::dvec3(0.0, 0.0, -1.0);
    keys.push_back({centre + turned, direction, {0.0, 1.0, 0.0}, first.verticalFov});
  }
  return keys;
}

Spline makePath(const Options& options, const Scene& scene) {
  const fs::path file = options.keys.empty() ? scene.keyFrames : fs::path(options.keys);
  return Spline(file.empty() ? orbit(scene) : readKeyFrames(file));
}

// "FIRST:LAST", views of the path; empty: all.
std::pair<int, int> parseViews(const std::string& text, int viewCount) {
  if (text.empty()) return {0, viewCount - 1};
  int first = -1, last = -1;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%d:%d%c", &first, &last, &rest) != 2 || first < 0 || last < first || last >= viewCount)
    throwBadInput("--views {}: expected FIRST:LAST within 0:{}", text, viewCount - 1);
  return {first, last};
}

// How much two pictures of one view differ: their means, and the 16x16 block that differs most, relative to its own mean or, in the dark, to the picture's.
struct Change {
  double mean = 0.0, block = 0.0;
};

Change changeBetween(const Image& before, const Image& after) {
  constexpr int kBlock = 16;
  const auto luminance = [](const glm::vec3& c) { return static_cast<double>(c.x + c.y + c.z) / 3.0; };
  const glm::dvec3 means[2] = {meanOf(before), meanOf(after)};
  const double reference = std::max(luminance(glm::vec3(means[0])), 1e-30);
  Change change;
  change.mean = std::abs(luminance(glm::vec3(means[1])) / reference - 1.0);
  for (int y = 0; y + kBlock <= before.height; y += kBlock)
    for (int x = 0; x + kBlock <= before.width; x += kBlock) {
      double sum = 0.0, own = 0.0;
      for (int j = 0; j < kBlock; ++j)
        for (int i = 0; i < kBlock; ++i) {
          own += luminance(before.at(x + i, y + j));
          sum += luminance(after.at(x + i, y + j)) - luminance(before.at(x + i, y + j));
        }
      change.block = std::max(change.block, std::abs(sum) / std::max(own, reference * kBlock * kBlock));
    }
  return change;
}

nlohmann::ordered_json resultJson(const Options& options, const Host& host, const gl::Context& context, Renderer& renderer, int frames,
                                  double seconds) {
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
  if (renderer.gather()) json["rsm"] = gatherJson(*renderer.gather());
  if (renderer.receivers()) json["lpv"] = receiversJson(*renderer.receivers());
  return json;
}

int record(const Options& options, const Host& host, const gl::Context& context, Renderer& renderer, const Spline& path) {
  const fs::path folder = options.record.empty() ? fs::path("walk") : fs::path(options.record);
  std::error_code error;
  fs::create_directories(folder, error);
  if (error || !fs::is_directory(folder)) throwBadInput("--record {}: the folder cannot be made ({})", folder.string(), error.message());
  const auto [first, last] = parseViews(options.views, path.viewCount());
  const int frames = options.frames > 0 ? options.frames : 12;

  watchForInterrupt();
  renderer.render(path.view(first));  // warm-up: shaders are finished on first use; its times are dropped
  Progress progress("walk", frames, options.common.quiet);
  std::vector<double> frameSeconds;
  std::optional<int> before;
  Change largest;
  int done = 0;
  for (; done < frames && !interrupted(); ++done) {
    const int view = frames > 1 ? first + static_cast<int>(std::lround(static_cast<double>(last - first) * done / (frames - 1))) : first;
    const auto start = Clock::now();
    renderer.render(path.view(view));
    glFinish();
    frameSeconds.push_back(secondsSince(start));
    writePng(folder / fmt::format("frame_{:04}.png", done), renderer.readDisplay());
    if (options.flicker && before) {
      // The same view, once with its own volume and once with that of the view before: motion drops out, flicker stays.
      const Image now = renderer.readRadiance();
      renderer.render(path.view(view), path.view(*before));
      const Change change = changeBetween(renderer.readRadiance(), now);
      largest = {std::max(largest.mean, change.mean), std::max(largest.block, change.block)};
    }
    before = view;
    progress.update(done + 1);
  }
  renderer.drain();
  double seconds = 0.0;
  for (double s : frameSeconds) seconds += s;
  if (!options.common.quiet) {
    fmt::print("{} pictures {}x{} in {}, {:.2f} frames a second\n", done, renderer.size().x, renderer.size().y, folder.string(), done / seconds);
    fmt::print("{}", stagesTable(renderer.timer().statistics(), context.capabilities().renderer));
    if (renderer.gather()) fmt::print("{}", gatherLine(*renderer.gather()));
    if (options.flicker)
      fmt::print("flicker, largest change of a view when its volume is that of the view before: {:.3f} % of the mean, {:.2f} % in any 16x16 block\n",
                 100.0 * largest.mean, 100.0 * largest.block);
  }
  nlohmann::ordered_json json = resultJson(options, host, context, renderer, done, seconds);
  json["frames_per_second"] = done / seconds;
  if (options.flicker) json["flicker"] = {{"mean", largest.mean}, {"block", largest.block}};
  options.common.writeJson(json);
  return exitCode();
}

int play(const Options& options, Host& host, const gl::Context& context, gl::ProgramLibrary& programs, Renderer& renderer, const Spline& path,
         const Scene& scene) {
  watchForInterrupt();
  const auto [first, last] = parseViews(options.views, path.viewCount());
  const SplinePlayback playback(last - first + 1);
  FreeCamera freeCamera(path.view(first), 0.08 * glm::length(scene.bounds.extent()));
  bool playing = true;
  const auto start = Clock::now();
  auto frameStart = start, titleTime = start;
  double playedSeconds = 0.0;
  int frames = 0, framesSinceTitle = 0;
  while (!interrupted()) {
    const HostInput input = host.poll();
    if (input.closeRequested) break;
    const double dt = secondsSince(frameStart);
    frameStart = Clock::now();
    bool quit = false;
    for (const char key : input.pressed) {
      if (key == '\x1b') quit = true;
      if (key == 'R') playing = !playing;
      if (key == '=') renderer.setExposure(renderer.exposure() * 1.25f);
      if (key == '-') renderer.setExposure(renderer.exposure() / 1.25f);
      if (key == 'L') {
        const auto reload = programs.reloadChanged();
        renderer.forget();  // what was made by the programs before
        fmt::print(stderr, "{} programs reloaded\n", reload.reloaded);
        for (const std::string& failure : reload.failures) fmt::print(stderr, "{}\n", failure);
      }
    }
    if (quit) break;
    if (playing && frames > 0) playedSeconds += dt;
    if (playing) {
      const auto view = playback.viewAt(playedSeconds);
      if (!view) break;  // the walk ends by itself
      freeCamera.place(path.view(first + *view));
    } else {
      freeCamera.move(input, std::min(dt, 0.1));  // a slow frame must not throw the camera across the room
    }
    renderer.resize(host.framebufferSize());
    renderer.render(freeCamera.camera());
    host.present(renderer.displayFramebuffer().id(), renderer.size());
    ++frames;
    ++framesSinceTitle;
    if (secondsSince(titleTime) > 0.5) {
      host.setTitle(fmt::format("Lucerna - {:.1f} frames a second - R path/free, WASD and drag, - = exposure, L reload, Esc", framesSinceTitle / secondsSince(titleTime)));
      titleTime = Clock::now();
      framesSinceTitle = 0;
    }
    if (options.frames > 0 && frames >= options.frames) break;
  }
  renderer.drain();
  const double seconds = secondsSince(start);
  if (!options.common.quiet)
    fmt::print("{} frames in {:.1f} s\n{}", frames, seconds, stagesTable(renderer.timer().statistics(), context.capabilities().renderer));
  options.common.writeJson(resultJson(options, host, context, renderer, frames, seconds));
  return exitCode();
}

int run(Options options) {
  options.common.apply();
  options.picture.readSettingsFile();
  const RenderSettings settings = options.picture.parse();
  if (options.scene.empty()) options.scene = (dataFolder() / "assets/atrium/atrium.json").string();
  if (!options.record.empty() && fs::exists(options.record) && !fs::is_directory(options.record))
    throwBadInput("--record {}: there is a file of that name; a folder is wanted", options.record);
  const Scene scene = loadScene(options.scene);
  const Spline path = makePath(options, scene);
  parseViews(options.views, path.viewCount());

  HostOptions hostOptions;
  hostOptions.windowSize = settings.size;
  hostOptions.windowTitle = "Lucerna - " + scene.name;
  hostOptions.swapAtRefresh = options.common.json.empty();  // with --json frames are measured
  const auto host = options.common.makeHost(options.record.empty(), hostOptions);
  const gl::Context context;
  gl::ProgramLibrary programs;
  Renderer renderer(context, programs, scene, settings);
  if (host->kind() == HostKind::window && options.record.empty()) return play(options, *host, context, programs, renderer, path, scene);
  return record(options, *host, context, renderer, path);
}

}  // namespace

Work addWalk(CLI::App& app) {
  auto options = std::make_shared<Options>();
  app.add_option("SCENE", options->scene, "a scene file (default: the atrium)");
  app.add_option("--keys", options->keys, "key frames of the camera path (default: the scene's, else once round it)");
  app.add_option("--record", options->record, "draw off-screen and write pictures into this folder (without a window: walk)");
  app.add_option("--frames", options->frames, "how many pictures (12), or frames in a window (the whole path)")->check(CLI::Range(1, 1000000));
  app.add_option("--views", options->views, "FIRST:LAST: only these views of the path, 200 between two keys");
  app.add_flag("--flicker", options->flicker, "measure how much the light changes between pictures by itself, not by the camera's motion");
  options->picture.declare(app);
  options->common.declare(app);
  return [options] { return run(*options); };
}

}  // namespace lucerna::demo
