// lucerna bench pictures --original NAME [SCENE] -o FILE.png: pictures 6.1, 6.6 and 7.3 to 7.7 of the LPV original, or
// those of the VPT one, on one labelled sheet.
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/statistics.hpp"
#include "originals/originals.hpp"
#include "shared/contact_sheet.hpp"
#include "originals/lpv_pictures.hpp"
#include "originals/rad.hpp"
#include "shared/completions.hpp"
#include "scene/place.hpp"
#include "render/deviations.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace lucerna::demo {

namespace {

struct PicturesOptions {
  CommonOptions common;
  std::string original, scene, output, camera, fidelity = "corrected", size;
  std::optional<double> exposure, scale;
  bool progressive = false;
};

struct SheetPicture {
  std::string label;
  RenderSettings settings;
  Camera camera;
  Bitmap display;
  glm::dvec3 mean{0.0};
};

/// The camera of that name, or `otherwise`.
const Camera& cameraOf(const Scene& scene, std::string_view name, const Camera& otherwise) {
  const auto found = std::find_if(scene.cameras.begin(), scene.cameras.end(),
                                  [&](const Camera& camera) { return camera.name == name; });
  return found == scene.cameras.end() ? otherwise : *found;
}

/// A target of the first reflective shadow map as a square in the middle of a tile: positions relative to the scene's
/// bounds, normals as 0.5 + 0.5 n, flux relative to the value reached by 99 % of its texels.
Bitmap mapTile(const StagePicture& stage, const Bounds& bounds, glm::ivec2 size) {
  const std::vector<glm::vec4> texels = stage.texture->readRgba();
  const int side = stage.texture->size().x;
  const auto pixels = static_cast<std::size_t>(side) * static_cast<std::size_t>(side);
  std::vector<double> lights;
  for (std::size_t i = 0; i < pixels; ++i)
    lights.push_back(static_cast<double>(std::max({texels[i].x, texels[i].y, texels[i].z})));
  const double white = std::max(percentile(lights, 0.99), 1e-30);
  const auto shown = [&](const glm::dvec3& v) {
    switch (stage.kind) {
      case StagePicture::Kind::position: return (v - bounds.min) / glm::max(bounds.extent(), glm::dvec3(1e-30));
      case StagePicture::Kind::normal: return 0.5 + 0.5 * v;
      default: return glm::sqrt(glm::clamp(v / white, 0.0, 1.0));  // close enough to a display's encoding
    }
  };
  Bitmap tile;
  tile.width = size.x, tile.height = size.y;
  tile.rgba.reserve(4 * static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y));
  const int square = std::min(size.x, size.y);
  for (int y = 0; y < size.y; ++y)
    for (int x = 0; x < size.x; ++x) {
      const int u = (x - (size.x - square) / 2) * side / square, v = (size.y - 1 - y) * side / square;
      glm::dvec3 colour(0.0);
      if (x >= (size.x - square) / 2 && u < side && v < side)
        colour = shown(glm::dvec3(
            texels[static_cast<std::size_t>(v) * static_cast<std::size_t>(side) + static_cast<std::size_t>(u)]));
      for (int c = 0; c < 3; ++c)
        tile.rgba.push_back(static_cast<std::uint8_t>(std::lround(255.0 * std::clamp(colour[c], 0.0, 1.0))));
      tile.rgba.push_back(255);
    }
  return tile;
}

// The difference of b from a, amplified four times, around grey.
Bitmap difference(const Bitmap& a, const Bitmap& b) {
  Bitmap result = a;
  for (std::size_t i = 0; i < a.rgba.size(); ++i)
    result.rgba[i] = i % 4 == 3 ? std::uint8_t{255}
                                : static_cast<std::uint8_t>(std::clamp(128 + 4 * (b.rgba[i] - a.rgba[i]), 0, 255));
  return result;
}

}  // namespace

namespace bench {

namespace {

/// The contents of the LPV original's sheet, each rendered once.
class LpvPictures {
 public:
  explicit LpvPictures(const LpvPicturesInput& input) : input_(input) {
    using S = RenderSettings&;
    rsm128 = add("RSM 128", [](S s) { s.of<ReflectiveShadowMap::Settings>().size = 128; });
    plain = add("RSM 256", [](S) {});
    rsm512 = add("RSM 512", [](S s) { s.of<ReflectiveShadowMap::Settings>().size = 512; });
    const Camera &pillar = cameraOf(input.scene, "pillar", input.camera),
                 &curtain = cameraOf(input.scene, "curtain", input.camera);
    // Only indirect light, brightened as in the text: its details drown in sunlight.
    const auto alone = [](S s) { s.component = Component::indirect; };
    single = add(
        "one 64^3",
        [&](S s) { alone(s), s.of<LpvSettings>().cascades.cascades = 1, s.of<LpvSettings>().cascades.cells = 64; },
        pillar);
    three = add("three 32^3", alone, pillar);
    unblocked = add(
        "without blocking", [&](S s) { alone(s), s.of<LpvSettings>().blocking = false; }, curtain);
    blocked = add("with blocking", alone, curtain);
    indirect = add("indirect light alone", alone);
    direct = add("without indirect light", [](S s) { s.component = Component::direct; });
    flickering = add("without mipmaps", [](S s) {
      s.component = Component::direct, s.textures.mipmaps = false, s.textures.anisotropy = 1.0f;
    });
    smooth = add("with mipmaps", [](S s) { s.component = Component::direct, s.textures.anisotropy = 1.0f; });
  }

  /// False if interrupted.
  bool render() {
    Progress progress("bench pictures", static_cast<int>(pictures_.size()), input_.quiet);
    for (std::size_t i = 0; i < pictures_.size(); ++i) {
      if (interrupted()) return false;
      SheetPicture& picture = pictures_[i];
      Renderer renderer(input_.context, input_.programs, input_.scene, picture.settings);
      if (input_.exposure) renderer.setExposure(static_cast<float>(*input_.exposure));
      if (i == single || i == three || i == unblocked || i == blocked) renderer.setExposure(2.0f * renderer.exposure());
      renderer.renderToTheEnd(picture.camera);
      picture.display = renderer.readDisplay();
      picture.mean = meanOf(renderer.readRadiance());
      if (i == plain) readMap(renderer);
      progress.update(static_cast<int>(i) + 1);
    }
    return true;
  }

  VptSheet sheet() {
    addMapTiles();
    tile("6.6  without mipmaps", flickering);
    tile("6.6  with mipmaps", smooth);
    compare("6.6  with less without, x 4, grey: none", flickering, smooth);
    tile("7.3  RSM 128 x 128", rsm128);
    tile("7.3  RSM 256 x 256", plain);
    tile("7.3  RSM 512 x 512", rsm512);
    tile("7.4  one grid, 64^3, indirect, twice as bright", single);
    tile("7.4  three grids, 32^3", three);
    compare("7.4  three less one, x 4, grey: none", single, three);
    tile("7.5  without blocking, indirect, twice as bright", unblocked);
    tile("7.5  with blocking", blocked);
    compare("7.5  with less without, x 4, grey: none", unblocked, blocked);
    tile("7.6  indirect alone, 8 iterations", indirect);
    tile("7.7  without indirect light", direct);
    tile("7.2, 7.7  with indirect light", plain);
    VptSheet result;
    result.tiles = tiles_.size();
    for (const SheetPicture& picture : pictures_)
      result.json.push_back({{"picture", picture.label}, {"mean", {picture.mean.x, picture.mean.y, picture.mean.z}}});
    result.sheet = contactSheet(
        fmt::format("LPV original, pictures 6.1 to 7.7, {}: {}; three grids of 32^3, 8 iterations, RSM 256, blocking, "
                    "where not said otherwise",
                    input_.fidelity, input_.scene.name),
        tiles_, 3);
    return result;
  }

 private:
  template <class Change>
  std::size_t add(const std::string& label, Change change) {
    return add(label, change, input_.camera);
  }
  template <class Change>
  std::size_t add(const std::string& label, Change change, const Camera& camera) {
    pictures_.push_back({label, input_.usual, camera, {}, {}});
    change(pictures_.back().settings);
    return pictures_.size() - 1;
  }

  void readMap(const Renderer& renderer) {
    const glm::dvec3 origin = floatingOrigin(input_.scene.bounds);
    Bounds bounds = input_.scene.bounds;
    bounds.min -= origin, bounds.max -= origin;
    for (const StagePicture& stage : renderer.stagePictures())
      if (stage.name.starts_with("rsm 1 ")) map_[stage.kind] = mapTile(stage, bounds, input_.usual.size);
  }
  void addMapTiles() {
    using Kind = StagePicture::Kind;
    for (const auto& [kind, label] :
         {std::pair(Kind::normal, "6.1a  normals of the RSM"), std::pair(Kind::position, "6.1b  positions"),
          std::pair(Kind::flux, "6.1c  flux")})
      if (map_.contains(kind)) tiles_.push_back({label, map_.at(kind)});
  }
  void tile(const std::string& label, std::size_t picture) {
    const glm::dvec3& c = pictures_[picture].mean;
    tiles_.push_back({fmt::format("{}  (mean {:.4g})", label, 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z),
                      pictures_[picture].display});
  }
  void compare(const std::string& label, std::size_t a, std::size_t b) {
    tiles_.push_back({label, difference(pictures_[a].display, pictures_[b].display)});
  }

  const LpvPicturesInput& input_;
  std::vector<SheetPicture> pictures_;
  std::size_t rsm128, plain, rsm512, single, three, unblocked, blocked, indirect, direct, flickering, smooth;
  std::map<StagePicture::Kind, Bitmap> map_;  ///< for the first light
  std::vector<Tile> tiles_;
};

}  // namespace

VptSheet drawLpvPictures(const LpvPicturesInput& input) {
  LpvPictures pictures(input);
  return pictures.render() ? pictures.sheet() : VptSheet{};
}

}  // namespace bench

namespace {

/// Default tile size, and factor on the published samples.
constexpr const char* kVptTile = "320x180";
constexpr double kVptPicturesScale = 0.02;

int runVpt(const PicturesOptions& options) {
  const glm::ivec2 size = parseSize(options.size.empty() ? kVptTile : options.size);
  const double scale = options.scale.value_or(kVptPicturesScale);
  if (size.x > 1920 || size.y > 1080) throwBadInput("--size {}: a tile of the sheet, at most 1920x1080", options.size);
  if (!(scale > 0.0 && scale <= 1.0)) throwBadInput("--scale {}: expected a number above 0, at most 1", scale);
  if (!options.scene.empty()) throwBadInput("SCENE {}: the pictures of vpt use their own scenes", options.scene);
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

int runPictures(const PicturesOptions& options) {
  options.common.apply();
  checkWritable(options.output);
  bench::checkOriginal(options.original);
  RenderSettings usual;
  usual.technique = "lpv";
  applyFidelity(usual, parseName<Fidelity>(options.fidelity, "--fidelity"));
  if (lowerExtension(options.output) != ".png") throwBadInput("-o {}: the extension must be png", options.output);
  if (options.exposure && !(*options.exposure > 0.0 && *options.exposure <= 1e12))
    throwBadInput("--exposure {}: expected a number above 0, at most 1e12", *options.exposure);
  if (options.progressive && options.original != "rad") throwBadInput("--progressive: only with --original rad");
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
    return bench::runRadPictures(options.common, options.output, usual.size, scale, options.progressive);
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
  auto options = std::make_shared<PicturesOptions>();
  app.addOption("SCENE", options->scene,
                "a scene file for lpv (default: the atrium; the published scene is Crytek Sponza)")
      .scene();
  addCompletions(app.addOption("--original", options->original, "the original: lpv, rad or vpt").required(),
                 {"lpv", "rad", "vpt"});
  app.addOption("-o,--output", options->output, "FILE.png").required();
  app.addOption("--camera", options->camera, "a camera's name, or px,py,pz,tx,ty,tz,fov (position, target, degrees)");
  addCompletions(app.addOption("--fidelity", options->fidelity,
                               "corrected; original: as published; lpv: thesis (original) or demo")
                     .showDefault(),
                 {"corrected", "original", "thesis", "demo"});
  app.addOption("--size", options->size, "WIDTHxHEIGHT of a tile in pixels (lpv and rad 640x360, vpt 320x180)");
  app.addOption("--scale", options->scale,
                "vpt: the published samples times this (0.02); rad: triangles over and pixels times this (1); above "
                "0, at most 1");
  app.addFlag("--progressive", options->progressive,
              "rad: progressive refinement (2.2.3.1) after 1 to 1000 shots, beside Jacobi and Gauss-Seidel");
  app.addOption("--exposure", options->exposure, "multiplies radiance before tone mapping (the scene's)");
  options->common.declare(app);
  return [options] { return runPictures(*options); };
}

}  // namespace lucerna::demo
