// Light that passes walls: two rooms of which one is lit, with a wall, a partition, a sheet or a shelf between them.
// The dark one must stay dark, whatever the mesh of the floor that both share.
#include "bench/stability.hpp"
#include "bench/stability_room.hpp"
#include "irradiance_cache/settings.hpp"
#include "render/renderer.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace lucerna::demo::bench {

namespace {

constexpr double kHalf = 4.0, kHeight = 3.0, kDepth = 2.0;  // of the hall: x from -4 to 4, z from -2 to 2

/// The inside of a box.
void addRoom(SceneParts& parts, const glm::dvec3& min, const glm::dvec3& max, int material) {
  const glm::dvec3 centre = 0.5 * (min + max), size = max - min;
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-0.5, 0.5}) {
      glm::dvec3 place = centre, u(0.0), v(0.0);
      place[axis] += side * size[axis];
      u[(axis + 1) % 3] = size[(axis + 1) % 3];
      v[(axis + 2) % 3] = size[(axis + 2) % 3];
      parts.plate(place, side < 0.0 ? u : v, side < 0.0 ? v : u, material);
    }
}

/// A wall from floor to ceiling and across the hall: its foot runs from x = near at z = 2 to x = far at z = -2.
void addWall(SceneParts& parts, double near, double far, double width, int material) {
  const glm::dvec3 along(far - near, 0.0, -2.0 * kDepth), up(0.0, kHeight, 0.0);
  const glm::dvec3 centre(0.5 * (near + far), 0.5 * kHeight, 0.0), half(0.5 * width, 0.0, 0.0);
  parts.plate(centre + half, along, up, material);
  if (width > 0.0) parts.plate(centre - half, up, along, material);
}

enum class Between { partition, sheet, turnedSheet, oblique, shelf, rooms };

/// Two cameras: of the lit and of the dark part.
Scene darkBeside(Between what, double width) {
  SceneParts parts("dark");
  const int wall = parts.material(glm::vec3(0.7f));
  glm::dvec3 lamp(-1.3, 1.2, 0.2), from(-0.9, 1.5, 1.0), lit(-4.0, 1.0, -1.0), dark(3.5, 1.5, 1.0), at(0.0, 1.0, -0.5);
  if (what == Between::rooms) {
    addRoom(parts, {-kHalf, 0, -kDepth}, {0, kHeight, kDepth}, wall);
    addRoom(parts, {width, 0, -kDepth}, {kHalf + width, kHeight, kDepth}, wall);
  } else {
    addRoom(parts, {-kHalf, 0, -kDepth}, {kHalf, kHeight, kDepth}, wall);
  }
  switch (what) {
    case Between::partition: addWall(parts, 0.0, 0.0, width, wall); break;
    case Between::sheet: addWall(parts, 0.0, 0.0, 0.0, wall); break;
    case Between::turnedSheet: parts.plate({0, 1.5, 0}, {0, kHeight, 0}, {0, 0, -2.0 * kDepth}, wall); break;
    case Between::oblique: addWall(parts, 0.5, -0.7, width, wall); break;
    case Between::shelf:
      parts.box({-kHalf, 1.5, -kDepth}, {kHalf, 1.5 + width, kDepth}, wall);
      lamp = {-1.3, 2.2, 0.2}, from = {2.0, 2.5, 1.0}, lit = {-4.0, 1.8, -1.0};
      dark = {3.0, 0.7, 1.0}, at = {-1.0, 1.2, -1.0};
      break;
    case Between::rooms: break;
  }
  Scene& scene = parts.scene();
  scene.points.push_back({lamp, glm::vec3(1.0f)});
  for (const auto& [position, target] : {std::pair{from, lit}, std::pair{dark, at}}) {
    Camera& camera = scene.cameras.emplace_back();
    camera.position = position;
    camera.direction = glm::normalize(target - position);
    camera.up = {0.0, 1.0, 0.0};
    camera.verticalFov = 1.2;
  }
  return std::move(scene);
}

/// The brightest pixel of the dark part over the mean of the lit part, or the mean.
Measurement leak(const StabilityContext& c, const Scene& scene, const RenderSettings& settings, double brightest,
                 bool ofMean) {
  Renderer renderer(c.context, c.programs, scene, settings);
  renderer.renderToTheEnd(scene.cameras[0]);
  const double lit = meanOf(renderer.readRadiance()).x;
  renderer.renderToTheEnd(scene.cameras[1]);
  const Image picture = renderer.readRadiance();
  double worst = meanOf(picture).x;
  if (!ofMean)
    for (const glm::vec3& pixel : picture.pixels) worst = std::max(worst, static_cast<double>(pixel.x));
  return Measurement{brightest, worst / lit, 0.0, Rule::atMost};
}

RenderSettings leakSettings(const char* technique) {
  RenderSettings settings;
  settings.technique = technique;
  settings.size = {24, 24};
  settings.fullFloatTarget = true;
  return settings;
}

}  // namespace

void addLeakCases(std::vector<StabilityCase>& cases) {
  struct Case {
    Between what;
    double width;
    const char* name;
  };
  for (const Case& k :
       {Case{Between::partition, 0.1, "partition of 0.1"}, Case{Between::partition, 0.3, "partition of 0.3"},
        Case{Between::sheet, 0.0, "sheet that faces the dark"},
        Case{Between::turnedSheet, 0.0, "sheet that faces the light"},
        Case{Between::oblique, 0.1, "oblique wall of 0.1"}, Case{Between::shelf, 0.04, "shelf of 0.04"},
        Case{Between::rooms, 0.0, "rooms that touch"}, Case{Between::rooms, 0.2, "rooms 0.2 apart"}})
    cases.push_back({"radiosity", "a dark room beside a lit one: brightest pixel over the lit mean", k.name,
                     [k](const StabilityContext& c) {
                       return leak(c, darkBeside(k.what, k.width), leakSettings("radiosity"), 1e-4, false);
                     }});
  for (const CacheTransport transport : {CacheTransport::rays, CacheTransport::gather})
    for (const double width : {0.05, 0.2})
      cases.push_back({"irradiance-cache",
                       fmt::format("{}: a dark room beside a lit one: mean over the lit mean", nameOf(transport)),
                       fmt::format("rooms {:g} apart", width), [transport, width](const StabilityContext& c) {
                         RenderSettings settings = leakSettings("irradiance-cache");
                         settings.of<IrradianceCacheSettings>().transport = transport;
                         return leak(c, darkBeside(Between::rooms, width), settings, 0.005, true);
                       }});
}

}  // namespace lucerna::demo::bench
