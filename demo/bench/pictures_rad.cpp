// lucerna bench pictures --original rad -o FILE.png: what the radiosity original's figures show, on the three models,
// on one sheet.
#include "bench/rad.hpp"

#include "bench/contact_sheet.hpp"
#include "radiosity/original/display.hpp"
#include "radiosity/original/rad_models.hpp"
#include "radiosity/original/solver.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace lucerna::demo::bench {

namespace {

/// A map of weights over an unfolded hemicube, white 1 [RAD2008, figures 3.5, 3.7, 3.8]: the top in the middle, a half
/// face on each side of it. value(top, a, b): a and b as there, in half widths of a face; on a side b is the height
/// above the patch.
template <class Value>
Bitmap weightTile(glm::ivec2 size, Value value) {
  Bitmap tile;
  tile.width = size.x, tile.height = size.y;
  tile.rgba.assign(4 * static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y), 0);
  const double half = 0.24 * std::min(size.x, size.y);  // of a face, in pixels: the cross is four of them wide
  for (int y = 0; y < size.y; ++y)
    for (int x = 0; x < size.x; ++x) {
      const double u = std::abs(x + 0.5 - 0.5 * size.x) / half, v = std::abs(y + 0.5 - 0.5 * size.y) / half;
      double weight = 0.0;
      if (u <= 1.0 && v <= 1.0) weight = value(true, u, v);
      else if (u <= 1.0 && v <= 2.0) weight = value(false, u, 2.0 - v);
      else if (v <= 1.0 && u <= 2.0) weight = value(false, v, 2.0 - u);
      const auto at =
          4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(size.x) + static_cast<std::size_t>(x));
      for (std::size_t c = 0; c < 3; ++c)
        tile.rgba[at + c] = static_cast<std::uint8_t>(std::lround(255.0 * std::clamp(weight, 0.0, 1.0)));
      tile.rgba[at + 3] = 255;
    }
  return tile;
}

}  // namespace

VptSheet drawRadPictures(gl::ProgramLibrary& programs, glm::ivec2 size, double scale, bool quiet) {
  RadView view(programs, size);
  std::vector<Tile> tiles;
  constexpr int kTiles = 27;
  Progress progress("bench pictures", kTiles, quiet);

  using Settings = OriginalRadiosity::Settings;
  // Smaller work: larger triangles, fewer pixels.
  const auto viewOf = [&](int pixels) {
    return std::max(8, 2 * static_cast<int>(std::lround(0.5 * pixels * std::sqrt(scale))));
  };
  const auto model = [&](int number, double threshold, double reflectance, std::uint32_t power) {
    return makeRadModel(number, {threshold / scale, reflectance, power});
  };
  const auto settingsOf = [&](int pixels) {
    Settings settings;
    settings.view = viewOf(pixels);
    return settings;
  };
  /// After so many sweeps more than what is in the file.
  const auto solve = [&](const std::vector<RadTriangle>& triangles, const Settings& settings, int sweeps) {
    OriginalRadiosity solver(programs, triangles, settings);
    OriginalProgress p = solver.start();
    for (int sweep = 0; sweep < sweeps && !interrupted(); ++sweep)
      solver.sweep(p, [](const OriginalProgress&) { return !interrupted(); });
    return solver.withReceived(p.received);
  };
  const auto add = [&](const std::string& label, const std::vector<RadTriangle>& triangles, RadDisplay display = {}) {
    view.show(triangles, display);
    view.record(overviewOf(triangles));
    tiles.push_back({label, view.read()});
    progress.update(static_cast<int>(tiles.size()));
  };
  const auto with = [](RadMapping mapping, bool mesh = false, bool backs = false) {
    RadDisplay display;
    display.mapping = mapping, display.mesh = mesh, display.backCorners = backs;
    return display;
  };

  const auto distance = [](double a, double b) { return std::sqrt(1.0 + a * a + b * b); };
  tiles.push_back({"3.5 shape of the hemicube, 1/r",
                   weightTile(size, [&](bool, double a, double b) { return 1.0 / distance(a, b); })});
  tiles.push_back({"3.7 Lambert's law, 1/r and b/r",
                   weightTile(size, [&](bool top, double a, double b) { return (top ? 1.0 : b) / distance(a, b); })});
  tiles.push_back({"3.8 both, as published", weightTile(size, [&](bool top, double a, double b) {
                     return (top ? 1.0 : b) / std::pow(distance(a, b), 2.0);
                   })});
  tiles.push_back({"the delta form factor: 1/r^4 and b/r^4", weightTile(size, [&](bool top, double a, double b) {
                     return (top ? 1.0 : b) / std::pow(distance(a, b), 4.0);
                   })});

  const std::vector<RadTriangle> cube = model(1, 10.0, 0.3, 1000000);
  const std::vector<RadTriangle> lit = solve(cube, settingsOf(100), 3);
  const RadDisplay constant = with(RadMapping::linear);  // shows small differences better than the logarithm
  add("3.10a camera at the centroid, 3 sweeps", lit, constant);
  Settings corners = settingsOf(100);
  corners.deviations.centroid = false;
  add("3.10b camera at the three corners, 1 sweep", solve(cube, corners, 1), constant);
  // The wall between the chambers is 2 units thick: beside it a camera whose near plane lies 4 units off looks through
  // it.
  Settings far = settingsOf(48);
  far.nearPlane = 4.0;
  add("3.13 near plane too far: bright seams along the wall", solve(model(3, 5.0, 0.3, 10000000), far, 2));
  if (interrupted()) return {};

  const std::vector<RadTriangle> hall = model(2, 100.0, 0.3, 1000000);
  const std::vector<RadTriangle> once = solve(hall, settingsOf(32), 1), twice = solve(once, settingsOf(32), 1);
  if (interrupted()) return {};
  add("4.1 model 2, mesh", hall, with(RadMapping::logarithmic, true));
  add("4.5a model 2 after sweep 1", once);
  add("4.5b after sweep 2", twice);
  add("4.5c after sweep 5", solve(twice, settingsOf(32), 3));
  add("3.16a as the computation draws it", twice, with(RadMapping::bits24));
  add("3.16b as it is shown", twice);
  add("3.17a times a constant", twice, with(RadMapping::linear));
  add("3.17b logarithm", twice);
  add("3.17 the filmic curve of the engine", twice, with(RadMapping::filmic));
  add("3.18 triangles turned away, by their corners", twice, with(RadMapping::logarithmic, false, true));

  for (int pixels : {25, 50, 100, 200, 400, 800})
    add(fmt::format("4.6 {} x {} px", viewOf(pixels), viewOf(pixels)),
        pixels == 100 ? lit : solve(cube, settingsOf(pixels), 3), constant);
  if (interrupted()) return {};
  for (double threshold : {80.0, 20.0, 5.0})
    add(fmt::format("4.4 model 3, triangles below {:.4g} units", threshold / scale),
        solve(model(3, threshold, 0.3, 10000000), settingsOf(32), threshold > 5.0 ? 5 : 3));
  const std::vector<RadTriangle> bent = model(3, 10.0, 0.3, 10000000);
  add("model 3, light round the wall, false colours", solve(bent, settingsOf(48), 4), with(RadMapping::falseColours));
  if (interrupted()) return {};

  VptSheet result;
  result.tiles = tiles.size();
  for (const Tile& tile : tiles) {
    double sum = 0.0;
    for (std::size_t i = 0; i < tile.picture.rgba.size(); i += 4)
      sum += tile.picture.rgba[i] + tile.picture.rgba[i + 1] + tile.picture.rgba[i + 2];
    result.json.push_back({{"picture", tile.label}, {"mean", sum / (3.0 * 255.0 * size.x * size.y)}});
  }
  result.sheet =
      contactSheet(std::string("RAD original, its figures on our models 1 to 3 (1 where no number is given), published "
                               "solver; views 25 to 800 px, few sweeps") +
                       (scale < 1.0 ? fmt::format("; --scale {}: triangles larger and pixels fewer by it", scale) : ""),
                   tiles, 4);
  return result;
}

int runRadPictures(const CommonOptions& common, const std::string& output, glm::ivec2 size, double scale) {
  const auto host = common.makeHost(false);
  const gl::Context context;
  gl::ProgramLibrary programs;
  watchForInterrupt();
  const VptSheet sheet = drawRadPictures(programs, size, scale, common.quiet);
  if (interrupted()) return exitCode();
  writePng(output, sheet.sheet);
  if (!common.quiet)
    fmt::print("{}: {} tiles of {}x{}, on {}\n", output, sheet.tiles, size.x, size.y, context.capabilities().renderer);
  nlohmann::ordered_json json;
  json["renderer"] = context.capabilities().renderer;
  json["host"] = nameOf(host->kind());
  json["original"] = "rad";
  json["size"] = {size.x, size.y};
  json["scale"] = scale;
  json["pictures"] = sheet.json;
  common.writeJson(json);
  return 0;
}

}  // namespace lucerna::demo::bench
