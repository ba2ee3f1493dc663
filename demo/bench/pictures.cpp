// lucerna bench pictures --original NAME [SCENE] -o FILE.png: pictures 7.3 to 7.7 of the LPV original, or those of the
// VPT one, on one labelled sheet.
#include "base/error.hpp"
#include "base/files.hpp"
#include "bench/bench.hpp"
#include "bench/contact_sheet.hpp"
#include "bench/lpv_pictures.hpp"
#include "bench/rad.hpp"
#include "offers.hpp"
#include "settings/deviations.hpp"

#include <fmt/core.h>

#include <algorithm>

namespace lucerna::demo {

namespace {

struct Options {
  CommonOptions common;
  std::string original, scene, output, camera, fidelity = "corrected", size;
  std::optional<double> exposure, scale;
};

struct Picture {
  std::string label;
  RenderSettings settings;
  Bitmap display;
  glm::dvec3 mean{0.0};
};

// What b has and a has not, four times as strong, about grey.
Bitmap difference(const Bitmap& a, const Bitmap& b) {
  Bitmap result = a;
  for (std::size_t i = 0; i < a.rgba.size(); ++i)
    result.rgba[i] = i % 4 == 3 ? std::uint8_t{255}
                                : static_cast<std::uint8_t>(std::clamp(128 + 4 * (b.rgba[i] - a.rgba[i]), 0, 255));
  return result;
}

}  // namespace

namespace bench {

VptSheet drawLpvPictures(const LpvPicturesInput& input) {
  std::vector<Picture> pictures;
  const auto add = [&](const std::string& label, auto change) {
    pictures.push_back({label, input.usual, {}, {}});
    change(pictures.back().settings);
    return pictures.size() - 1;
  };
  const std::size_t rsm128 = add("RSM 128", [](RenderSettings& s) { s.rsm.size = 128; });
  const std::size_t plain = add("RSM 256", [](RenderSettings&) {});
  const std::size_t rsm512 = add("RSM 512", [](RenderSettings& s) { s.rsm.size = 512; });
  const std::size_t single =
      add("one 64^3", [](RenderSettings& s) { s.lpv.cascades.cascades = 1, s.lpv.cascades.cells = 64; });
  const std::size_t unblocked = add("without blocking", [](RenderSettings& s) { s.lpv.blocking = false; });
  const std::size_t indirect =
      add("indirect light alone", [](RenderSettings& s) { s.component = Component::indirect; });
  const std::size_t direct = add("without indirect light", [](RenderSettings& s) { s.component = Component::direct; });

  Progress progress("bench pictures", static_cast<int>(pictures.size()), input.quiet);
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    if (interrupted()) return {};
    Renderer renderer(input.context, input.programs, input.scene, pictures[i].settings);
    if (input.exposure) renderer.setExposure(static_cast<float>(*input.exposure));
    renderer.renderToTheEnd(input.camera);
    pictures[i].display = renderer.readDisplay();
    pictures[i].mean = meanOf(renderer.readRadiance());
    progress.update(static_cast<int>(i) + 1);
  }

  const auto luminance = [](const glm::dvec3& c) { return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z; };
  std::vector<Tile> tiles;
  const auto tile = [&](const std::string& label, std::size_t picture) {
    tiles.push_back(
        {fmt::format("{}  (mean {:.4g})", label, luminance(pictures[picture].mean)), pictures[picture].display});
  };
  const auto compare = [&](const std::string& label, std::size_t a, std::size_t b) {
    tiles.push_back({label, difference(pictures[a].display, pictures[b].display)});
  };
  tile("7.3  RSM 128 x 128", rsm128);
  tile("7.3  RSM 256 x 256", plain);
  tile("7.3  RSM 512 x 512", rsm512);
  tile("7.4  one grid, 64^3", single);
  tile("7.4  three grids, 32^3", plain);
  compare("7.4  three less one, x 4, grey: none", single, plain);
  tile("7.5  without blocking", unblocked);
  tile("7.5  with blocking", plain);
  compare("7.5  with less without, x 4, grey: none", unblocked, plain);
  tile("7.6  indirect alone, 8 iterations", indirect);
  tile("7.7  without indirect light", direct);
  tile("7.7  with indirect light", plain);
  const std::string title = fmt::format(
      "LPV original, pictures 7.3 to 7.7, {}: {}; three grids of 32^3, 8 iterations, RSM 256, blocking, where not said "
      "otherwise",
      input.fidelity, input.scene.name);
  VptSheet result;
  result.tiles = tiles.size();
  for (const Picture& picture : pictures)
    result.json.push_back({{"picture", picture.label}, {"mean", {picture.mean.x, picture.mean.y, picture.mean.z}}});
  result.sheet = contactSheet(title, tiles, 3);
  return result;
}

}  // namespace bench

namespace {

/// Tiles, and the published samples times this, where nothing else is asked for.
constexpr const char* kVptTile = "320x180";
constexpr double kVptScale = 0.02;

int runVpt(const Options& options) {
  const glm::ivec2 size = parseSize(options.size.empty() ? kVptTile : options.size);
  const double scale = options.scale.value_or(kVptScale);
  if (size.x > 1920 || size.y > 1080) throwBadInput("--size {}: a tile of the sheet, at most 1920x1080", options.size);
  if (!(scale > 0.0 && scale <= 1.0)) throwBadInput("--scale {}: expected a number above 0, at most 1", scale);
  if (!options.scene.empty())
    throwBadInput("SCENE {}: the pictures of vpt are made of their own scenes", options.scene);
  if (!options.camera.empty()) throwBadInput("--camera {}: the pictures of vpt have their own cameras", options.camera);
  const auto host = options.common.makeHost(false);
  const gl::Context context;
  gl::ProgramLibrary programs;
  watchForInterrupt();
  const bench::VptSheet sheet =
      bench::drawVptPictures({context, programs, scale, options.common.quiet,
                              options.fidelity == "original" ? Fidelity::original : Fidelity::corrected},
                             size, options.exposure);
  if (interrupted()) return exitCode();
  writePng(options.output, sheet.sheet);
  if (!options.common.quiet)
    fmt::print("{}: {} tiles of {}x{}, on {}\n", options.output, sheet.tiles, size.x, size.y,
               context.capabilities().renderer);
  nlohmann::ordered_json json;
  json["renderer"] = context.capabilities().renderer;
  json["host"] = nameOf(host->kind());
  json["original"] = options.original;
  json["scale"] = scale;
  json["fidelity"] = options.fidelity;
  json["size"] = {size.x, size.y};
  json["pictures"] = sheet.json;
  options.common.writeJson(json);
  return 0;
}

int run(const Options& options) {
  options.common.apply();
  checkWritable(options.output);
  bench::checkOriginal(options.original);
  RenderSettings usual;
  applyFidelity(usual, parseName<Fidelity>(options.fidelity, "--fidelity"));
  if (lowerExtension(options.output) != ".png") throwBadInput("-o {}: the extension must be png", options.output);
  if (options.exposure && !(*options.exposure > 0.0 && *options.exposure <= 1e12))
    throwBadInput("--exposure {}: expected a number above 0, at most 1e12", *options.exposure);
  if (options.original == "vpt") return runVpt(options);
  if (options.scale && options.original != "rad")
    throwBadInput("--scale {}: only with --original vpt and rad", *options.scale);
  usual.size = parseSize(options.size.empty() ? "640x360" : options.size);
  if (usual.size.x > 1920 || usual.size.y > 1080)
    throwBadInput("--size {}: a tile of the sheet, at most 1920x1080", options.size);
  if (options.original == "rad") {
    if (!options.scene.empty())
      throwBadInput("{}: --original rad makes its own models; expected no SCENE", options.scene);
    if (!options.camera.empty())
      throwBadInput("--camera {}: --original rad has one view of each model", options.camera);
    const double scale = options.scale.value_or(1.0);
    if (!(scale > 0.0 && scale <= 1.0)) throwBadInput("--scale {}: expected a number above 0, at most 1", scale);
    return bench::runRadPictures(options.common, options.output, usual.size, scale);
  }
  const std::string file = bench::sceneOrAtrium(options.scene);
  const Scene scene = loadScene(file);
  const Camera camera = chooseCamera(scene, options.camera);
  const auto host = options.common.makeHost(false);
  const gl::Context context;
  gl::ProgramLibrary programs;
  watchForInterrupt();
  const bench::VptSheet sheet = bench::drawLpvPictures(
      {context, programs, scene, camera, usual, options.fidelity, options.exposure, options.common.quiet});
  if (interrupted()) return exitCode();
  writePng(options.output, sheet.sheet);
  if (!options.common.quiet)
    fmt::print("{}: {} tiles of {}x{}, on {}\n", options.output, sheet.tiles, usual.size.x, usual.size.y,
               context.capabilities().renderer);

  nlohmann::ordered_json json;
  json["renderer"] = context.capabilities().renderer;
  json["host"] = nameOf(host->kind());
  json["original"] = options.original;
  json["scene"] = file;
  json["fidelity"] = options.fidelity;
  json["size"] = {usual.size.x, usual.size.y};
  json["pictures"] = sheet.json;
  options.common.writeJson(json);
  return 0;
}

}  // namespace

Work addBenchPictures(Command app) {
  auto options = std::make_shared<Options>();
  app.addOption("SCENE", options->scene,
                "a scene file for lpv (default: the atrium; the published scene is Crytek Sponza)");
  offer(app.addOption("--original", options->original, "whose pictures: lpv, rad or vpt").required(),
        {"lpv", "rad", "vpt"});
  app.addOption("-o,--output", options->output, "FILE.png").required();
  app.addOption("--camera", options->camera, "a camera's name, or px,py,pz,tx,ty,tz,fov (position, target, degrees)");
  offer(app.addOption("--fidelity", options->fidelity,
                      "corrected; original: as published; lpv: thesis (original) or demo")
            .showDefault(),
        {"corrected", "original", "thesis", "demo"});
  app.addOption("--size", options->size, "WIDTHxHEIGHT of a tile in pixels (lpv and rad 640x360, vpt 320x180)");
  app.addOption("--scale", options->scale,
                "vpt: the published samples times this (0.02); rad: triangles over and pixels times this (1); above "
                "0, at most 1");
  app.addOption("--exposure", options->exposure, "multiplies radiance before tone mapping (the scene's)");
  options->common.declare(app);
  return [options] { return run(*options); };
}

}  // namespace lucerna::demo
