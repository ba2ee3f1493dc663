// Every technique with every kind of light far from the origin, and on a tilted floor far larger than its visible part.
// Float computations on the GPU must not be affected by the scene's position or its largest face: the picture must
// match that of the same scene at the origin, or on a small floor.
#include "bench/stability.hpp"
#include "bench/stability_room.hpp"
#include "irradiance_cache/settings.hpp"
#include "pathtracer/path_tracer.hpp"
#include "radiosity/radiosity_view.hpp"
#include "render/renderer.hpp"
#include "rsm/reflective_shadow_map.hpp"

#include <fmt/core.h>

#include <array>
#include <cmath>

namespace lucerna::demo::bench {

namespace {

enum class Lamp { sun, spot, point, emissive, environment };
constexpr std::array kLamps{Lamp::sun, Lamp::spot, Lamp::point, Lamp::emissive, Lamp::environment};
constexpr glm::ivec2 kPlacesSize{48, 32};

const char* nameOf(Lamp lamp) {
  switch (lamp) {
    case Lamp::sun: return "sun";
    case Lamp::spot: return "spot";
    case Lamp::point: return "omnidirectional";
    case Lamp::emissive: return "emissive";
    case Lamp::environment: return "environment";
  }
  return "?";
}

void addLamp(SceneParts& parts, Lamp lamp, const glm::dvec3& place) {
  Scene& scene = parts.scene();
  switch (lamp) {
    case Lamp::sun: scene.sun = DirectionalLight{glm::normalize(glm::dvec3(-0.35, -1.0, -0.1)), glm::vec3(3.0f)}; break;
    case Lamp::spot:
      scene.spots.push_back({place + glm::dvec3(2.0, 4.0, 2.0), glm::normalize(glm::dvec3(-0.4, -1.0, -0.5)),
                             glm::vec3(60.0f), 0.5, 0.8});
      break;
    case Lamp::point: scene.points.push_back({place + glm::dvec3(1.0, 3.0, 1.0), glm::vec3(20.0f)}); break;
    case Lamp::emissive:
      parts.plate(place + glm::dvec3(1.0, 4.0, 1.0), {2.0, 0.0, 0.0}, {0.0, 0.0, 2.0},
                  parts.material(glm::vec3(0.0f), glm::vec3(10.0f)));
      break;
    case Lamp::environment:
      scene.environment = Environment{};
      scene.environment->radiance = glm::vec3(1.0f, 0.7f, 0.4f);
      break;
  }
}

void addCamera(SceneParts& parts, const glm::dvec3& position, const glm::dvec3& target) {
  Camera camera;
  camera.position = position;
  camera.direction = glm::normalize(target - position);
  parts.scene().cameras.push_back(camera);
}

/// Side 10, without roof and front; two tilted plates in it, one in the other's shadow. All coordinates are multiples
/// of 1/4 relative to `place`.
Scene farRoom(Lamp lamp, const glm::dvec3& place) {
  SceneParts parts("far room");
  const int white = parts.material(glm::vec3(0.7f)), red = parts.material(glm::vec3(0.6f, 0.1f, 0.1f));
  parts.plate(place + glm::dvec3(0, -5, 0), {0, 0, 10}, {10, 0, 0}, white);
  parts.plate(place + glm::dvec3(0, 0, -5), {10, 0, 0}, {0, 10, 0}, white);
  parts.plate(place + glm::dvec3(-5, 0, 0), {0, 10, 0}, {0, 0, 10}, red);
  parts.plate(place + glm::dvec3(5, 0, 0), {0, 0, 10}, {0, 10, 0}, white);
  parts.plate(place + glm::dvec3(-1, -2, -1), {0.5, 1.5, 4}, {5, -1, 0.5}, white);
  parts.plate(place + glm::dvec3(1, 0.5, 0), {0.5, -0.5, 2}, {2, 1, 0}, red);
  addLamp(parts, lamp, place);
  addCamera(parts, place + glm::dvec3(0.5, 2.0, 12.0), place + glm::dvec3(0.0, -1.0, 0.0));
  return std::move(parts.scene());
}

/// A floor that rises by 1/4 along x and 1/8 along z, seen at (640, 120, -320): from -1000 to 1000 along both, or only
/// the visible part.
Scene tiltedFloor(Lamp lamp, bool large) {
  SceneParts parts("tilted floor");
  const auto at = [](double x, double z) { return glm::dvec3(x, 0.25 * x + 0.125 * z, z); };
  const glm::dvec3 seen = at(640.0, -320.0), middle = large ? glm::dvec3(0.0) : seen;
  const double side = large ? 2000.0 : 128.0;
  parts.plate(middle, at(0.0, side), at(side, 0.0), parts.material(glm::vec3(0.7f)));
  addLamp(parts, lamp, seen);
  addCamera(parts, seen + glm::dvec3(2.0, 12.0, 6.0), seen);
  return std::move(parts.scene());
}

enum class How { direct, rsm, lpv, rays, patches, pixels, path };
constexpr std::array kHows{How::direct, How::rsm, How::lpv, How::rays, How::patches, How::pixels, How::path};

const char* techniqueOf(How how) {
  switch (how) {
    case How::direct: return "direct";
    case How::rsm: return "rsm";
    case How::lpv: return "lpv";
    case How::rays: return "irradiance-cache";
    case How::patches:
    case How::pixels: return "radiosity";
    case How::path: return "path";
  }
  return "?";
}

Image picture(const StabilityContext& c, const Scene& scene, How how, Component component) {
  if (how == How::path) {
    PathTracer::Settings settings;
    settings.size = kPlacesSize;
    settings.transport = component == Component::direct ? Transport::direct : Transport::all;
    settings.filter = PixelFilter::centre;
    PathTracer tracer(c.context, c.programs, scene, settings);
    tracer.setCamera(scene.cameras.front());
    tracer.record(64);
    return tracer.mean();
  }
  RenderSettings settings;
  settings.technique = techniqueOf(how);
  settings.component = component;
  settings.size = kPlacesSize;
  settings.fullFloatTarget = true;
  settings.shadow.size = 512;
  settings.of<ReflectiveShadowMap::Settings>().size = 128;
  settings.of<IrradianceCacheSettings>().samples = 64;
  settings.of<IrradianceCacheSettings>().bounces = 1;
  settings.of<RadiosityView::Settings>().solution.patches.longestEdge = scene.bounds.extent().x > 100.0 ? 500.0 : 2.5;
  settings.of<RadiosityView::Settings>().solution.hemicubes.resolution = 32;
  settings.of<RadiosityView::Settings>().direct =
      how == How::pixels ? RadiosityView::Direct::pixels : RadiosityView::Direct::patches;
  Renderer renderer(c.context, c.programs, scene, settings);
  renderer.renderToTheEnd(scene.cameras.front());
  return renderer.readRadiance();
}

/// Root mean square of the difference over the mean of `b`; NaN for a black picture.
double difference(const Image& a, const Image& b) {
  double sum = 0.0, mean = 0.0;
  for (std::size_t i = 0; i < b.pixels.size(); ++i) {
    const glm::dvec3 d = glm::dvec3(a.pixels[i]) - glm::dvec3(b.pixels[i]);
    sum += glm::dot(d, d) / 3.0;
    mean +=
        (static_cast<double>(b.pixels[i].x) + static_cast<double>(b.pixels[i].y) + static_cast<double>(b.pixels[i].z)) /
        3.0;
  }
  const auto count = static_cast<double>(b.pixels.size());
  return mean > 0.0 ? std::sqrt(sum / count) / (mean / count) : NAN;
}

std::string nameOf(How how, Lamp lamp, const char* what) {
  return fmt::format("{}, {}{}", what, nameOf(lamp),
                     how == How::pixels ? " by radiosity.direct=pixels"
                     : how == How::rays ? " by rays"
                                        : "");
}

}  // namespace

void addPlaceCases(std::vector<StabilityCase>& cases) {
  for (const How how : kHows)
    for (const Lamp lamp : kLamps) {
      if (lamp == Lamp::environment && how != How::path && how != How::rays) continue;  // the others do not support it
      for (const double sides : {1e3, 1e4})
        cases.push_back({techniqueOf(how), nameOf(how, lamp, "room far away against near"),
                         fmt::format("{:g} sides", sides), [how, lamp, sides](const StabilityContext& c) {
                           const glm::dvec3 place = 10.0 * sides * glm::dvec3(1.0, -0.5, 0.75);
                           return Measurement{1e-3,
                                              difference(picture(c, farRoom(lamp, place), how, Component::all),
                                                         picture(c, farRoom(lamp, {}), how, Component::all)),
                                              0.0, Rule::atMost};
                         }});
      // Direct light belongs to technique direct; patches and receivers' cells are as large as the floor.
      if (how == How::rsm || how == How::lpv || how == How::rays || how == How::patches) continue;
      cases.push_back({techniqueOf(how), nameOf(how, lamp, "tilted floor, large against small"), "+-1000 units",
                       [how, lamp](const StabilityContext& c) {
                         return Measurement{1e-3,
                                            difference(picture(c, tiltedFloor(lamp, true), how, Component::direct),
                                                       picture(c, tiltedFloor(lamp, false), how, Component::direct)),
                                            0.0, Rule::atMost};
                       }});
    }
}

}  // namespace lucerna::demo::bench
