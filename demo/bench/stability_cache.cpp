// Stiff and extreme cases of the irradiance cache: units, scale and position,
// light that is hardly absorbed, thin sheets, a lamp in a corner, tiny and huge cells. Answers are exact, bounds, or
// ratios that must be 1 up to noise.
#include "bench/stability.hpp"
#include "bench/stability_room.hpp"
#include "irradiance_cache/settings.hpp"
#include "render/renderer.hpp"

#include <fmt/core.h>

#include <cmath>

namespace lucerna::demo::bench {

namespace {

RenderSettings settingsOf(int bounces = 1, int samples = 256) {
  RenderSettings settings;
  settings.size = {48, 32};
  settings.fullFloatTarget = true;
  settings.shadow.size = 512;
  settings.technique = "irradiance-cache";
  settings.of<IrradianceCacheSettings>().bounces = bounces;
  settings.of<IrradianceCacheSettings>().samples = samples;
  return settings;
}

Image picture(const StabilityContext& c, const Scene& scene, const RenderSettings& settings) {
  Renderer renderer(c.context, c.programs, scene, settings);
  renderer.renderToTheEnd(scene.cameras.front());
  return renderer.readRadiance();
}

double mean(const Image& image) {
  const glm::dvec3 m = meanOf(image);
  return (m.x + m.y + m.z) / 3.0;
}

void addCacheRow(std::vector<StabilityCase>& cases, std::string name, std::string parameter,
                 std::function<Measurement(const StabilityContext&)> run) {
  cases.push_back({"irradiance-cache", "rays: " + std::move(name), std::move(parameter), std::move(run)});
}

void addCacheUnits(std::vector<StabilityCase>& cases) {
  for (const float factor : {1e-9f, 1e9f})
    addCacheRow(cases, "mean over the sun's irradiance, against 1x",
                fmt::format("sun {:g}x", static_cast<double>(factor)), [factor](const StabilityContext& c) {
                  Room room;
                  const double usual = mean(picture(c, makeRoom(room), settingsOf()));
                  room.irradiance *= factor;
                  return Measurement{
                      1.0, mean(picture(c, makeRoom(room), settingsOf())) / static_cast<double>(factor) / usual, 1e-3};
                });
  for (const double scale : {std::exp2(-20), std::exp2(20), 1e-3, 1e6})
    addCacheRow(cases, "mean of a scaled scene, against 1x", fmt::format("scale {:g}", scale),
                [scale](const StabilityContext& c) {
                  Room room;
                  const double usual = mean(picture(c, makeRoom(room), settingsOf()));
                  room.scale = scale;
                  // Powers of two change no rounding; other factors may select other points of the same surfaces.
                  return Measurement{1.0, mean(picture(c, makeRoom(room), settingsOf())) / usual,
                                     std::exp2(std::round(std::log2(scale))) == scale ? 1e-5 : 5e-3};
                });
  for (const double sides : {1e3, 1e4})
    addCacheRow(cases, "mean of a scene far from the origin", fmt::format("{:g} room sides", sides),
                [sides](const StabilityContext& c) {
                  Room room;
                  const double usual = mean(picture(c, makeRoom(room), settingsOf()));
                  room.place = 10.0 * sides * glm::dvec3(1.0, -0.5, 0.7);
                  return Measurement{1.0, mean(picture(c, makeRoom(room), settingsOf())) / usual, 0.02};
                });
}

/// A closed room whose walls emit 1 and absorb almost nothing: after N bounces its radiance is that of N + 2 terms of 1
/// + a + a^2 + ...
void addAlbedo(std::vector<StabilityCase>& cases) {
  constexpr double kAlbedo = 1.0 - 1e-6;
  static const auto shining = [] {
    Room room;
    room.closed = true;
    room.albedo = static_cast<float>(kAlbedo);
    room.emission = glm::vec3(1.0f);
    return makeRoom(room);
  };
  for (const int bounces : {1, 8, 64})
    addCacheRow(cases, "closed room of albedo 1 - 1e-6, radiance over the exact one",
                fmt::format("cache.bounces={}", bounces), [bounces](const StabilityContext& c) {
                  return Measurement{1.0, mean(picture(c, shining(), settingsOf(bounces, 64))) / (bounces + 2.0), 0.02};
                });
  addCacheRow(cases, "the same, all bounces: no more than there is", "cache.bounces=all",
              [](const StabilityContext& c) {
                return Measurement{1.0 / (1.0 - kAlbedo),
                                   mean(picture(c, shining(), settingsOf(IrradianceCacheSettings::kAllBounces, 128))),
                                   0.0, Rule::atMost};
              });
  addCacheRow(cases, "the same: more than 64 bounces have", "cache.bounces=all", [](const StabilityContext& c) {
    return Measurement{66.0, mean(picture(c, shining(), settingsOf(IrradianceCacheSettings::kAllBounces, 128))), 0.0,
                       Rule::atLeast};
  });
}

/// The same room, gathered: the points that keep the light of all bounces give each other at most what they have.
void addGatheredAlbedo(std::vector<StabilityCase>& cases) {
  constexpr int kAll = IrradianceCacheSettings::kAllBounces, kMostBounces = 64;
  for (const int bounces : {1, 8, kMostBounces, kAll})
    cases.push_back({"irradiance-cache", "gather: closed room of albedo 1 - 1e-6, radiance over that of its bounces",
                     bounces == kAll ? "cache.bounces=all" : fmt::format("cache.bounces={}", bounces),
                     [bounces](const StabilityContext& c) {
                       Room room;
                       room.closed = true;
                       room.albedo = 1.0f - 1e-6f;
                       room.emission = glm::vec3(1.0f);
                       RenderSettings settings = settingsOf(bounces, 64);
                       settings.of<IrradianceCacheSettings>().transport = CacheTransport::gather;
                       const int counted = bounces == kAll ? kMostBounces : bounces;
                       return Measurement{1.0, mean(picture(c, makeRoom(room), settings)) / (counted + 2.0), 0.02};
                     }});
}

/// A room without windows behind a sheet that is brightly lit on its other side: no light may pass, whatever the
/// sheet's thickness.
void addThinSheet(std::vector<StabilityCase>& cases) {
  for (const double thickness : {0.0, 1e-4})
    addCacheRow(
        cases, "dark side of a thin sheet: largest radiance", fmt::format("thickness {:g} sides", thickness),
        [thickness](const StabilityContext& c) {
          SceneParts parts("sheet");
          const int white = parts.material(glm::vec3(0.8f));
          const double t = 10.0 * thickness;
          parts.plate({0, 0, 0}, {0, 0, 10}, {10, 0, 0}, white);
          if (t > 0.0) parts.plate({0, -t, 0}, {0, 0, 10}, {10, 0, 0}, white);
          parts.plate({0, -2, 0}, {0, 0, 40}, {40, 0, 0},
                      parts.material(glm::vec3(0.0f)));  // black ground: no light around the sheet
          parts.scene().sun = DirectionalLight{{0.0, -1.0, 0.0}, glm::vec3(1e4f)};
          Camera camera;
          camera.position = {0.0, -1.9, 0.0};
          camera.direction = glm::normalize(glm::dvec3(0.0, 1.0, 1e-3));
          camera.up = {0.0, 0.0, -1.0};
          parts.scene().cameras.push_back(camera);
          double largest = 0.0;
          for (const glm::vec3& p :
               picture(c, parts.scene(), settingsOf(IrradianceCacheSettings::kAllBounces, 64)).pixels)
            largest = std::max({largest, static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z)});
          return Measurement{0.0, largest, 0.0};
        });
}

/// A small emissive plate or lamp in a corner of the room, almost touching both walls.
void addCornerLamp(std::vector<StabilityCase>& cases) {
  for (const double distance : {0.1, 1e-3, 1e-5}) {
    const auto room = [distance](bool emissive) {
      Room dark;
      dark.closed = true;
      dark.albedo = 0.5f;
      Scene scene = makeRoom(dark);
      const glm::dvec3 corner(-5.0, -5.0, -5.0);
      if (!emissive) {
        scene.points.push_back({corner + 10.0 * distance, glm::vec3(1.0f)});
        return scene;
      }
      SceneParts parts("corner");
      parts.scene() = scene;
      const glm::dvec3 normal = glm::normalize(glm::dvec3(1.0)), u = glm::normalize(glm::dvec3(1.0, -1.0, 0.0)),
                       v = glm::cross(normal, u);
      parts.plate(corner + 10.0 * distance, 2.0 * distance * u, 2.0 * distance * v,
                  parts.material(glm::vec3(0.0f), glm::vec3(static_cast<float>(1.0 / (distance * distance)))));
      return parts.scene();
    };
    for (const bool emissive : {false, true})
      addCacheRow(cases,
                  fmt::format("{} in a corner: pixels not finite or negative", emissive ? "a shining plate" : "a lamp"),
                  fmt::format("{:g} sides away", distance), [room, emissive](const StabilityContext& c) {
                    double count = 0.0;
                    for (const glm::vec3& p :
                         picture(c, room(emissive), settingsOf(IrradianceCacheSettings::kAllBounces, 64)).pixels)
                      count += !(std::isfinite(p.x + p.y + p.z) && std::min({p.x, p.y, p.z}) >= 0.0f);
                    return Measurement{0.0, count, 0.0};
                  });
  }
}

/// In a room of constant radiance cells of any size give that radiance; elsewhere they differ in how finely irradiance
/// is interpolated.
void addCells(std::vector<StabilityCase>& cases) {
  for (const double size : {1e-3, 0.1, 100.0, 1e5})
    addCacheRow(cases, "room in cells of one size, mean against the usual ones",
                fmt::format("cache.cell-size={:g}", size), [size](const StabilityContext& c) {
                  Room room;
                  room.closed = true;
                  room.albedo = 0.5f;
                  room.emission = glm::vec3(1.0f);
                  const Scene scene = makeRoom(room);
                  RenderSettings settings = settingsOf(2, 256);
                  const double usual = mean(picture(c, scene, settings));
                  settings.of<IrradianceCacheSettings>().cascades.cellSize = size;
                  // Cells far smaller than the room cover only its part near the camera. Elsewhere there is nothing to
                  // look up, and surfaces show exactly their own emission.
                  const double now = mean(picture(c, scene, settings));
                  return size < 1.0 ? Measurement{1.0, now, 0.0, Rule::atLeast} : Measurement{1.0, now / usual, 0.02};
                });
}

}  // namespace

void addCacheCases(std::vector<StabilityCase>& cases) {
  addCacheUnits(cases);
  addAlbedo(cases);
  addGatheredAlbedo(cases);
  addThinSheet(cases);
  addCornerLamp(cases);
  addCells(cases);
}

}  // namespace lucerna::demo::bench
