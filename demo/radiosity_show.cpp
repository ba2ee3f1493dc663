// lucerna radiosity show FILE [s|c]: a triangle file in a window, or as one picture with -o.
#include "radiosity.hpp"

#include "base/clock.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/log.hpp"
#include "shared/completions.hpp"
#include "radiosity/original/display.hpp"
#include "scene/scene.hpp"
#include "walk/free_camera.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace lucerna::demo {

namespace {

struct RadiosityShowOptions {
  CommonOptions common;
  std::string file, mode, output, mapping, camera, fidelity, scene, size = "1280x720";
  double constant = 0.0;
  std::optional<double> edge;
  std::optional<unsigned> triangles;
  bool mesh = false, falseColours = false, interpolate = false;
};

RadDisplay displayOf(const RadiosityShowOptions& options) {
  RadDisplay display;
  if (!options.mode.empty() && options.mode != "s" && options.mode != "c")
    throwBadInput("{}: unknown; expected s (back-facing triangles too) or c (the computed colours)", options.mode);
  if (!options.mapping.empty()) display.mapping = parseName<RadMapping>(options.mapping, "--mapping");
  if (options.falseColours) display.mapping = RadMapping::falseColours;
  if (options.mode == "c") display.mapping = RadMapping::bits24;
  display.backCorners = options.mode == "s";
  if (!(options.constant >= 0.0 && std::isfinite(options.constant)))
    throwBadInput("--constant {}: expected a number above 0, or 0 to choose one", options.constant);
  display.constant = options.constant;
  display.mesh = options.mesh;
  const bool isOurs = display.mapping == RadMapping::filmic || display.mapping == RadMapping::falseColours;
  if (options.fidelity == "original" && isOurs)
    throwBadInput("--mapping {}: the published program has log, linear and bits", nameOf(display.mapping));
  if (options.fidelity == "corrected" && !options.interpolate)
    throwBadInput("--fidelity corrected: only with --interpolate; flat triangles are shown as published");
  if (!options.interpolate) return display;
  if (display.mapping == RadMapping::bits24)
    throwBadInput("--interpolate: not with the colours of the computation, whose packed numbers have no mean");
  display.shading = options.fidelity == "corrected" ? RadShading::withinFaces : RadShading::acrossEdges;
  return display;
}

/// The window's content; its pictures lie in the scene.
struct Shown {
  std::span<const RadTriangle> triangles;
  RadDisplay display;
  RadTextures textures;
};

constexpr double kRest = 0.25;  // seconds between looks at whether the program was interrupted

void walkAround(Host& host, gl::ProgramLibrary& programs, Shown shown, const Camera& camera) {
  watchForInterrupt();
  const std::span<const RadTriangle> triangles = shown.triangles;
  RadDisplay& display = shown.display;
  RadTextures& textures = shown.textures;
  FreeCamera freeCamera(camera, 0.08 * diagonalOf(triangles));
  glm::ivec2 size = host.framebufferSize();
  auto view = std::make_unique<RadView>(programs, size);
  view->show(triangles, display, textures);
  host.setTitle(
      "Lucerna radiosity - 1 log, 2 linear, 3 filmic, 4 false colours, 5 bits, M mesh, B backs, I interpolated, "
      "- = constant, WASD QE and drag, Esc");
  const auto apply = [&](char key) {
    if (key >= '1' && key <= '5') display.mapping = static_cast<RadMapping>(key - '1');
    if (key == 'M') display.mesh = !display.mesh;
    if (key == 'B') display.backCorners = !display.backCorners;
    if (key == 'I') display.shading = static_cast<RadShading>((static_cast<int>(display.shading) + 1) % 3);
    if (display.mapping == RadMapping::bits24) display.shading = RadShading::flat;
    const double constant = display.constant > 0.0 ? display.constant : exposureOf(triangles);
    if (key == '=') display.constant = 1.25 * constant;
    if (key == '-') display.constant = constant / 1.25;
  };
  auto frameStart = Clock::now();
  double waits = 0.0;
  while (!interrupted()) {
    host.pump(waits);
    if (host.input().closes() || host.input().takeEscape()) return;
    if (waits > 0.0 && !host.input().waits()) continue;
    const double dt = waits > 0.0 ? 0.0 : secondsSince(frameStart);
    frameStart = Clock::now();
    bool changed = host.framebufferSize() != size;
    if (changed) view = std::make_unique<RadView>(programs, size = host.framebufferSize());
    HostInput input;
    do {
      input = host.input().take();
      for (const char key : input.pressed) apply(key);
      changed = changed || !input.pressed.empty();
      freeCamera.look(input);
    } while (host.input().waits());
    freeCamera.move(input, std::min(dt, 0.1));
    if (changed) view->show(triangles, display, textures);
    view->record(freeCamera.camera());
    host.present(view->framebuffer().id(), size);
    waits = input.move == glm::dvec3(0.0) ? kRest : 0.0;  // nothing moves by itself
  }
}

int runRadiosityShow(const RadiosityShowOptions& options) {
  options.common.apply();
  const RadDisplay display = displayOf(options);
  const glm::ivec2 size = parseSize(options.size);
  if (!options.output.empty() && lowerExtension(options.output) != ".png")
    throwBadInput("-o {}: the extension must be png", options.output);
  const std::vector<RadTriangle> triangles = readRadFile(options.file);
  checkRadTriangles(triangles, options.file);
  Shown shown{triangles, display, {}};
  RadSource source;
  if (!options.scene.empty()) {
    source = loadRadSource(options.scene, options.edge, options.triangles);
    shown.textures = texturesOf(source.model.scene, source.edge, triangles, options.file);
  } else if (options.edge || options.triangles) {
    throwBadInput("--edge, --triangles: of the triangles of --scene SCENE, which is not given");
  }
  if (isUnsolved(triangles) && !display.mesh)
    logWarning("{}: no light is computed yet, so all but its sources is black: lucerna radiosity solve {} SOLVED",
               options.file, options.file);
  Scene cameras;
  cameras.cameras = {overviewOf(triangles)};
  const Camera camera = chooseCamera(cameras, options.camera);

  HostOptions hostOptions;
  hostOptions.windowSize = size;
  const auto host = options.common.makeHost(options.output.empty(), hostOptions);
  const gl::Context context;
  if (std::max(size.x, size.y) > context.capabilities().maxTextureSize)
    throwMissingCapability("--size {}: this driver's limit is {} pixels", options.size,
                           context.capabilities().maxTextureSize);
  gl::ProgramLibrary programs;
  if (options.output.empty()) {
    if (host->kind() != HostKind::window) throwMissingCapability("show: no window is available; use -o OUT.png");
    walkAround(*host, programs, shown, camera);
  } else {
    RadView view(programs, size);
    view.show(triangles, display, shown.textures);
    view.record(camera);
    writePng(options.output, view.read());
    if (!options.common.quiet)
      fmt::print("{}: {}x{}, {} triangles, {}, on {}\n", options.output, size.x, size.y, triangles.size(),
                 nameOf(display.mapping), context.capabilities().renderer);
  }
  nlohmann::ordered_json json;
  json["renderer"] = context.capabilities().renderer;
  json["host"] = nameOf(host->kind());
  json["triangles"] = triangles.size();
  json["mapping"] = nameOf(display.mapping);
  json["shading"] = nameOf(display.shading);
  json["pictures"] = shown.textures.pictures.size();
  json["constant"] = display.constant > 0.0 ? display.constant : exposureOf(triangles);
  json["size"] = {size.x, size.y};
  options.common.writeJson(json);
  return exitCode();
}

}  // namespace

Work addRadiosityShow(Command app) {
  auto options = std::make_shared<RadiosityShowOptions>();
  app.addOption("FILE", options->file, "a triangle file").required();
  addCompletions(
      app.addOption("MODE", options->mode,
                    "s: back-facing triangles too, by their corners; c: the 24-bit colours of the computation"),
      {"s", "c"});
  app.addOption("-o,--output", options->output, "OUT.png: a picture instead of a window");
  addCompletions(app.addOption("--mapping", options->mapping,
                               "log (as published, default), linear (times a constant), filmic (the engine's), false "
                               "(colours), bits (as c)"),
                 {"log", "linear", "filmic", "false", "bits"});
  app.addOption("--constant", options->constant, "linear and filmic: factor of values, 1 is white (0: from the scene)")
      .showDefault();
  app.addFlag("--interpolate", options->interpolate,
              "colours interpolated between corners, each the mean of all triangles that meet there, as published");
  addCompletions(
      app.addOption("--fidelity", options->fidelity,
                    "original: as published; corrected, with --interpolate: values instead of colours, and never "
                    "across an edge"),
      {"original", "corrected"})
      .oneOf({"original", "corrected"});
  app.addOption("--scene", options->scene, "the scene that FILE was generated from: its textures times the light");
  app.addOption("--edge", options->edge, "with --scene: the --edge that FILE was generated with").positive();
  app.addOption("--triangles", options->triangles, "with --scene: the --triangles that FILE was generated with")
      .range(4u, 100'000'000u);
  app.addFlag("--mesh", options->mesh, "draw the triangles' edges");
  app.addFlag("--false-colours", options->falseColours, "the same as --mapping false");
  app.addOption("--camera", options->camera,
                "px,py,pz,tx,ty,tz,fov (position, target, degrees); default: from above a corner");
  app.addOption("--size", options->size, "WIDTHxHEIGHT in pixels").showDefault();
  options->common.declare(app);
  return [options] { return runRadiosityShow(*options); };
}

}  // namespace lucerna::demo
