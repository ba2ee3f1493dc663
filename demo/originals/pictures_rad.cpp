// lucerna bench pictures --original rad -o FILE.png: the radiosity original's figures, from the three models, on one
// sheet; --progressive: pictures_progressive.cpp.
#include "originals/rad.hpp"

#include "base/data.hpp"
#include "base/image.hpp"
#include "shared/contact_sheet.hpp"
#include "radiosity/original/display.hpp"
#include "radiosity/original/rad_models.hpp"
#include "radiosity/original/solver.hpp"

#include <fmt/core.h>
#include <glm/gtc/constants.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace lucerna::demo::bench {

namespace {

/// A point on an unfolded hemicube in half widths of a face: u, v from the middle of the top; a, b as in the maps; on a
/// side, b is the height above the patch.
struct Place {
  double u, v, a, b;
};

/// Values over an unfolded hemicube, white is 1 [RAD2008, figures 3.5, 3.7 to 3.9]: the top in the middle, a half face
/// on each side. Calls value(top, place).
template <class Value>
Bitmap unfoldedTile(glm::ivec2 size, Value value) {
  Bitmap tile;
  tile.width = size.x, tile.height = size.y;
  tile.rgba.assign(4 * static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y), 0);
  const double half = 0.24 * std::min(size.x, size.y);  // of a face, in pixels: the cross is four of them wide
  for (int y = 0; y < size.y; ++y)
    for (int x = 0; x < size.x; ++x) {
      const double u = (x + 0.5 - 0.5 * size.x) / half, v = (0.5 * size.y - y - 0.5) / half, a = std::abs(u),
                   b = std::abs(v);
      double shown = 0.0;
      if (a <= 1.0 && b <= 1.0) shown = value(true, Place{u, v, a, b});
      else if (a <= 1.0 && b <= 2.0) shown = value(false, Place{u, v, a, 2.0 - b});
      else if (b <= 1.0 && a <= 2.0) shown = value(false, Place{u, v, b, 2.0 - a});
      const auto at =
          4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(size.x) + static_cast<std::size_t>(x));
      for (std::size_t c = 0; c < 3; ++c)
        tile.rgba[at + c] = static_cast<std::uint8_t>(std::lround(255.0 * std::clamp(shown, 0.0, 1.0)));
      tile.rgba[at + 3] = 255;
    }
  return tile;
}

/// The five views of a hemicube, unfolded like the maps, times a weight [RAD2008, figure 3.9].
class Unfolded {
 public:
  Unfolded(gl::ProgramLibrary& programs, const RadTriangle& triangle, std::span<const RadTriangle> scene, int side)
      : side_(side) {
    const auto vec = [](const std::array<float, 3>& a) { return glm::dvec3(a[0], a[1], a[2]); };
    const glm::dvec3 middle = (vec(triangle.p1) + vec(triangle.p2) + vec(triangle.p3)) / 3.0,
                     normal = glm::normalize(vec(triangle.n)), up = glm::normalize(vec(triangle.p1) - middle),
                     right = glm::cross(normal, up);
    RadView view(programs, glm::ivec2(side));
    view.show(scene, {});
    const std::array<glm::dvec3, 5> towards{normal, right, -right, up, -up};
    for (std::size_t i = 0; i < towards.size(); ++i) {
      Camera camera;
      camera.position = middle, camera.direction = towards[i], camera.up = i == 0 ? up : normal;
      camera.verticalFov = glm::half_pi<double>();
      view.record(camera);
      Face& face = faces_[i];
      face.towards = towards[i], face.up = camera.up, face.right = glm::cross(towards[i], camera.up);
      face.picture = view.read();
    }
    normal_ = normal, up_ = up, right_ = right;
  }

  /// The view from the triangle through (u, v) of the unfolded hemicube, in half widths of a face; 0..1.
  double at(double u, double v) const {
    const bool top = std::abs(u) <= 1.0 && std::abs(v) <= 1.0;
    glm::dvec3 towards;
    if (top) towards = normal_ + u * right_ + v * up_;
    else if (std::abs(u) > 1.0) towards = std::copysign(1.0, u) * right_ + v * up_ + (2.0 - std::abs(u)) * normal_;
    else towards = std::copysign(1.0, v) * up_ + u * right_ + (2.0 - std::abs(v)) * normal_;
    const Face& face = top ? faces_[0] : faces_[std::abs(u) > 1.0 ? (u > 0.0 ? 1 : 2) : (v > 0.0 ? 3 : 4)];
    const double depth = glm::dot(towards, face.towards);
    const auto pixel = [&](double along) {
      return std::clamp(static_cast<int>(0.5 * (along / depth + 1.0) * side_), 0, side_ - 1);
    };
    const int x = pixel(glm::dot(towards, face.right)), y = side_ - 1 - pixel(glm::dot(towards, face.up));
    return face.picture.rgba[4 * static_cast<std::size_t>(y * side_ + x)] / 255.0;
  }

 private:
  struct Face {
    glm::dvec3 towards{0.0}, up{0.0}, right{0.0};
    Bitmap picture;
  };
  std::array<Face, 5> faces_;
  glm::dvec3 normal_{0.0}, up_{0.0}, right_{0.0};
  int side_;
};

std::pair<glm::dvec3, glm::dvec3> boundsOf(std::span<const RadTriangle> triangles) {
  glm::dvec3 low(1e30), high(-1e30);
  for (const RadTriangle& t : triangles)
    for (const auto* corner : {&t.p1, &t.p2, &t.p3}) {
      const glm::dvec3 p((*corner)[0], (*corner)[1], (*corner)[2]);
      low = glm::min(low, p), high = glm::max(high, p);
    }
  return {low, high};
}

/// A view of model 2's table and box, whose shadows lie on the floor [RAD2008, figure 4.4].
Camera shadowsOf(std::span<const RadTriangle> triangles) {
  const auto [low, high] = boundsOf(triangles);
  const auto at = [&, low = low, high = high](double x, double y, double z) {
    return low + (high - low) * glm::dvec3(x, y, z);
  };
  Camera camera;
  camera.position = at(0.26, 0.55, 0.71);
  camera.direction = glm::normalize(at(0.42, 0.0, 0.48) - camera.position);
  camera.verticalFov = glm::radians(50.0);
  return camera;
}

/// The floor triangle nearest to the middle of the scene.
const RadTriangle& middleOfFloor(std::span<const RadTriangle> triangles) {
  const auto [low, high] = boundsOf(triangles);
  const glm::dvec3 middle = 0.5 * (low + high);
  return *std::min_element(triangles.begin(), triangles.end(), [&](const RadTriangle& a, const RadTriangle& b) {
    const auto away = [&](const RadTriangle& t) {
      return t.n[1] < 0.9f
                 ? 1e30
                 : std::hypot(static_cast<double>(t.p1[0]) - middle.x, static_cast<double>(t.p1[1]) - middle.y,
                              static_cast<double>(t.p1[2]) - middle.z);
    };
    return away(a) < away(b);
  });
}

/// A stone wall texture over everything, repeated four times along the scene's diagonal [RAD2008, figure 4.3].
RadTextures stoneOver(std::span<const RadTriangle> triangles, const Texture& stone) {
  const double side = 0.25 * diagonalOf(triangles);
  RadTextures textures;
  textures.pictures = {&stone};
  textures.ofTriangle.assign(triangles.size(), 0);
  for (const RadTriangle& t : triangles) {
    const auto place = [&](const std::array<float, 3>& p) {
      const bool flat = std::abs(t.n[1]) > 0.5f, sideways = std::abs(t.n[0]) > 0.5f;
      return glm::vec2(sideways ? p[2] : p[0], flat ? p[2] : p[1]) * static_cast<float>(1.0 / side);
    };
    textures.texCoords.push_back({place(t.p1), place(t.p2), place(t.p3)});
  }
  return textures;
}

}  // namespace

VptSheet drawRadPictures(gl::ProgramLibrary& programs, glm::ivec2 size, double scale, bool quiet) {
  RadView view(programs, size);
  std::vector<Tile> tiles;
  constexpr int kTiles = 32;
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
  /// Solves for this many sweeps beyond those in the file.
  const auto solve = [&](const std::vector<RadTriangle>& triangles, const Settings& settings, int sweeps) {
    OriginalRadiosity solver(programs, triangles, settings);
    OriginalProgress p = solver.start();
    for (int sweep = 0; sweep < sweeps && !interrupted(); ++sweep)
      solver.sweep(p, [](const OriginalProgress&) { return !interrupted(); });
    return solver.withReceived(p.received);
  };
  const auto addFrom = [&](const Camera& camera, const std::string& label, const std::vector<RadTriangle>& triangles,
                           const RadDisplay& display, const RadTextures& textures = {}) {
    view.show(triangles, display, textures);
    view.record(camera);
    tiles.push_back({label, view.read()});
    progress.update(static_cast<int>(tiles.size()));
  };
  const auto add = [&](const std::string& label, const std::vector<RadTriangle>& triangles, RadDisplay display = {}) {
    addFrom(overviewOf(triangles), label, triangles, display);
  };
  const auto with = [](RadMapping mapping, bool mesh = false, bool backs = false) {
    RadDisplay display;
    display.mapping = mapping, display.mesh = mesh, display.backCorners = backs;
    return display;
  };

  const auto distance = [](double a, double b) { return std::sqrt(1.0 + a * a + b * b); };
  const auto addMap = [&](const std::string& label, auto weight) {
    tiles.push_back({label, unfoldedTile(size, [&](bool top, const Place& p) { return weight(top ? 1.0 : p.b, p); })});
  };
  addMap("3.5 shape of the hemicube, 1/r", [&](double, const Place& p) { return 1.0 / distance(p.a, p.b); });
  addMap("3.7 the cosine law, 1/r and b/r", [&](double cosine, const Place& p) { return cosine / distance(p.a, p.b); });
  addMap("3.8 both, as published",
         [&](double cosine, const Place& p) { return cosine / std::pow(distance(p.a, p.b), 2.0); });
  addMap("the delta form factor: 1/r^4 and b/r^4",
         [&](double cosine, const Place& p) { return cosine / std::pow(distance(p.a, p.b), 4.0); });

  const std::vector<RadTriangle> cube = model(1, 10.0, 0.3, 1000000);
  const std::vector<RadTriangle> lit = solve(cube, settingsOf(100), 3);
  const RadDisplay constant = with(RadMapping::linear);  // shows small differences better than the logarithm
  add("3.10a camera at the centroid, 3 sweeps", lit, constant);
  Settings corners = settingsOf(100);
  corners.deviations.centroid = false;
  add("3.10b camera at the three corners, 1 sweep", solve(cube, corners, 1), constant);
  // The wall between the chambers is 2 units thick: next to it, a camera with its near plane 4 units away looks through
  // it.
  Settings far = settingsOf(48);
  far.nearPlane = 4.0;
  add("3.13 near plane too far: bright seams along the wall", solve(model(3, 5.0, 0.3, 10000000), far, 2));
  if (interrupted()) return {};

  // Model 2 has 2,700 triangles at its coarsest; a hemicube of each for eight sweeps is not small.
  const int large = scale >= 0.1 ? 2 : 3;
  const std::vector<RadTriangle> hall = model(large, 100.0, 0.3, 1000000);
  const std::vector<RadTriangle> once = solve(hall, settingsOf(32), 1), twice = solve(once, settingsOf(32), 1);
  if (interrupted()) return {};
  add(fmt::format("4.1 model {}, mesh", large), hall, with(RadMapping::logarithmic, true));
  add(fmt::format("4.5a model {} after sweep 1", large), once);
  add("4.5b after sweep 2", twice);
  add("4.5c after sweep 5", solve(twice, settingsOf(32), 3));
  add("3.16a as the computation draws it", twice, with(RadMapping::bits24));
  add("3.16b as it is shown", twice);
  add("3.17a times a constant", twice, with(RadMapping::linear));
  add("3.17b logarithm", twice);
  add("3.17 the filmic curve of the engine", twice, with(RadMapping::filmic));
  const Unfolded seen(programs, middleOfFloor(twice), twice, std::max(8, std::min(size.x, size.y) / 2));
  tiles.push_back({"3.9 a triangle of the floor: its five views",
                   unfoldedTile(size, [&](bool, const Place& p) { return seen.at(p.u, p.v); })});
  tiles.push_back({"3.9 times the map", unfoldedTile(size, [&](bool top, const Place& p) {
                     return seen.at(p.u, p.v) * (top ? 1.0 : p.b) / std::pow(distance(p.a, p.b), 2.0);
                   })});
  RadDisplay smooth = with(RadMapping::logarithmic);
  smooth.shading = RadShading::acrossEdges;
  add("4.2 interpolated, over edges too, as published", twice, smooth);
  smooth.shading = RadShading::withinFaces;
  add("4.2 interpolated within faces", twice, smooth);
  const std::filesystem::path stoneFile = dataFolder() / "assets/atrium/textures/limestone.png";
  const Texture stone{stoneFile, readBitmap(stoneFile)};
  addFrom(overviewOf(lit), "4.3 model 1, a stone wall modulated by light", lit, constant, stoneOver(lit, stone));
  add("3.18 triangles turned away, by their corners", twice, with(RadMapping::logarithmic, false, true));

  for (int pixels : {25, 50, 100, 200, 400, 800})
    add(fmt::format("4.6 {} x {} px", viewOf(pixels), viewOf(pixels)),
        pixels == 100 ? lit : solve(cube, settingsOf(pixels), 3), constant);
  if (interrupted()) return {};
  // The published 5, 1 and 0.25 units would take an hour here: forty times as large, with the same ratios.
  for (double threshold : {200.0, 40.0, 10.0}) {
    const std::vector<RadTriangle> finer = solve(model(large, threshold, 0.3, 1000000), settingsOf(32), 1);
    addFrom(large == 2 ? shadowsOf(finer) : overviewOf(finer),
            fmt::format("4.4 model {}, triangles below {:.4g} units", large, threshold / scale), finer,
            with(RadMapping::logarithmic));
    if (interrupted()) return {};
  }
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

int runRadPictures(const CommonOptions& common, const std::string& output, glm::ivec2 size, double scale,
                   bool progressive) {
  const auto host = common.makeHost(false);
  const gl::Context context;
  gl::ProgramLibrary programs;
  watchForInterrupt();
  const VptSheet sheet = progressive ? drawProgressivePictures(context, programs, size, scale, common.quiet)
                                     : drawRadPictures(programs, size, scale, common.quiet);
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
