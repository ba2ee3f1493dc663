// Stiff and extreme cases of whole pictures: units, scale, position, resolution, nothing to light. A room without a
// roof, lit by the sun; answers are ratios that must be 1, or exact zeros.
#include "bench/stability.hpp"
#include "bench/stability_room.hpp"
#include "radiosity/radiosity_view.hpp"
#include "render/renderer.hpp"
#include "rsm/reflective_shadow_map.hpp"
#include "rsm/rsm_gather.hpp"

#include <fmt/core.h>

#include <cmath>
#include <limits>

namespace lucerna::demo::bench {

namespace {

struct PictureView {
  std::string_view technique;
  Component component = Component::all;
  glm::ivec2 size{48, 32};
  int rsmSize = 128, samples = 400;
  float radius = 0.3f;
  bool interpolate = true;
};

Image picture(const StabilityContext& c, const Room& room, const PictureView& view) {
  RenderSettings settings;
  settings.technique = view.technique;
  settings.shadow.size = 512;
  settings.of<ReflectiveShadowMap::Settings>().size = view.rsmSize;
  settings.of<RsmGather::Settings>().samples = view.samples;
  settings.of<RsmGather::Settings>().radius = view.radius;
  settings.of<RsmGather::Settings>().interpolate = view.interpolate;
  settings.size = view.size;
  settings.component = view.component;
  settings.fullFloatTarget = true;
  settings.of<RadiosityView::Settings>().solution.patches.longestEdge = 3.0 * room.scale;
  settings.of<RadiosityView::Settings>().solution.hemicubes.resolution = 32;
  const Scene scene = makeRoom(room);
  Renderer renderer(c.context, c.programs, scene, settings);
  renderer.render(scene.cameras.front());
  return renderer.readRadiance();
}

double meanOfPicture(const StabilityContext& c, const Room& room, const PictureView& view) {
  const glm::dvec3 mean = meanOf(picture(c, room, view));
  return (mean.x + mean.y + mean.z) / 3.0;
}

double notFinite(const Image& image) {
  double count = 0.0;
  for (const glm::vec3& p : image.pixels) count += !(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
  return count;
}

void addPictureRow(std::vector<StabilityCase>& cases, std::string_view technique, std::string name,
                   std::string parameter, std::function<Measurement(const StabilityContext&)> run) {
  cases.push_back({std::string(technique), std::move(name), std::move(parameter), std::move(run)});
}

void addUnits(std::vector<StabilityCase>& cases, const PictureView& view) {
  for (const float factor : {1e-9f, 1e9f})
    addPictureRow(cases, view.technique, "mean over the sun's irradiance, against 1x",
                  fmt::format("sun {:g}x", static_cast<double>(factor)), [view, factor](const StabilityContext& c) {
                    Room room;
                    const double usual = meanOfPicture(c, room, view);
                    room.irradiance *= factor;
                    return Measurement{1.0, meanOfPicture(c, room, view) / factor / usual, 1e-3};
                  });
  for (const double scale : {std::exp2(-20), std::exp2(20), 1e-3, 1e6})
    addPictureRow(cases, view.technique, "mean of a scaled scene, against 1x", fmt::format("scale {:g}", scale),
                  [view, scale](const StabilityContext& c) {
                    Room room;
                    const double usual = meanOfPicture(c, room, view);
                    room.scale = scale;
                    // Powers of two change no rounding; other factors may shift a cell or a texel.
                    return Measurement{1.0, meanOfPicture(c, room, view) / usual,
                                       std::exp2(std::round(std::log2(scale))) == scale ? 1e-5 : 5e-3};
                  });
  for (const double distance : {1e3, 1e4})
    addPictureRow(cases, view.technique, "mean of a scene far from the origin",
                  fmt::format("{:g} room sides", 0.1 * distance), [view, distance](const StabilityContext& c) {
                    Room room;
                    const double usual = meanOfPicture(c, room, view);
                    room.place = glm::dvec3(distance, -0.5 * distance, 0.7 * distance);
                    return Measurement{1.0, meanOfPicture(c, room, view) / usual, 0.02};
                  });
}

void addExtremes(std::vector<StabilityCase>& cases, const PictureView& view) {
  const auto finite = [&](const char* name, const char* parameter, const Room& room, PictureView v) {
    addPictureRow(cases, view.technique, std::string(name) + ": pixels not finite", parameter,
                  [room, v](const StabilityContext& c) {
                    return Measurement{0.0, notFinite(picture(c, room, v)), 0.0};
                  });
  };
  Room room;
  room.place = glm::dvec3(1e6);
  finite("very far from the origin", "1e5 room sides", room, view);
  room = {};
  room.albedo = 1.0f;
  finite("walls that absorb nothing", "albedo 1", room, view);
  room = {};
  room.sun = {-1.0, 0.0, -1e-7};
  finite("sun along the floor", "grazing", room, view);
  room = {};
  PictureView tiny = view;
  tiny.size = {1, 1};
  finite("a picture of one pixel", "1x1", room, tiny);
  addPictureRow(cases, view.technique, "no light: mean", "sun 0", [view](const StabilityContext& c) {
    Room dark;
    dark.irradiance = 0.0f;
    return Measurement{0.0, meanOfPicture(c, dark, view), 0.0};
  });
  addPictureRow(cases, view.technique, "zero-area, needle and doubled triangles: mean", "3 more",
                [view](const StabilityContext& c) {
                  Room bad;
                  bad.badTriangles = true;
                  return Measurement{1.0, meanOfPicture(c, bad, view) / meanOfPicture(c, {}, view), 2e-3};
                });
}

void addIndirect(std::vector<StabilityCase>& cases, PictureView view) {
  view.component = Component::indirect;
  addPictureRow(cases, view.technique, "black walls: mean of indirect light", "albedo 0",
                [view](const StabilityContext& c) {
                  Room room;
                  room.albedo = 0.0f;
                  return Measurement{0.0, meanOfPicture(c, room, view), 0.0};
                });
  for (const int size : {32, 64, 512})
    addPictureRow(
        cases, view.technique, "mean of indirect light, against a map of 128", fmt::format("rsm.size={}", size),
        [view, size](const StabilityContext& c) {
          PictureView other = view;
          other.rsmSize = size;
          return Measurement{1.0, meanOfPicture(c, {}, other) / meanOfPicture(c, {}, view), size < 64 ? 0.15 : 0.05};
        });
}

void addRsm(std::vector<StabilityCase>& cases) {
  PictureView view{"rsm"};
  view.component = Component::indirect;
  addPictureRow(cases, "rsm", "one sample: pixels not finite", "rsm.samples=1", [view](const StabilityContext& c) {
    PictureView one = view;
    one.samples = 1;
    return Measurement{0.0, notFinite(picture(c, {}, one)), 0.0};
  });
  addPictureRow(cases, "rsm", "mean of 16384 samples, against 1024", "rsm.samples=16384",
                [view](const StabilityContext& c) {
                  PictureView usual = view;
                  usual.size = {24, 16}, usual.samples = 1024, usual.interpolate = false;
                  PictureView many = usual;
                  many.samples = 16384;
                  return Measurement{1.0, meanOfPicture(c, {}, many) / meanOfPicture(c, {}, usual), 0.03};
                });
  addPictureRow(cases, "rsm", "reach of half a texel: pixels not finite", "rsm.radius=0.004",
                [view](const StabilityContext& c) {
                  PictureView near = view;
                  near.radius = 0.004f;
                  return Measurement{0.0, notFinite(picture(c, {}, near)), 0.0};
                });
}

}  // namespace

void addPictureCases(std::vector<StabilityCase>& cases) {
  for (const std::string_view technique : {"direct", "rsm", "lpv", "radiosity"}) {
    const PictureView view{technique};
    addUnits(cases, view);
    addExtremes(cases, view);
    if (technique == "rsm" || technique == "lpv") addIndirect(cases, view);
  }
  addRsm(cases);
}

}  // namespace lucerna::demo::bench
