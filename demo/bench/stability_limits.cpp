// Light at its limits: lamps as narrow as needles, lamps in a surface's plane, media of 1e7 mean free paths under the
// sun, media within media, light that four samples do not find, rooms and lamps wound the other way, a sky of one
// texel. Each has a closed form or a scene that it must equal.
#include "base/angles.hpp"
#include "base/log.hpp"
#include "bench/stability.hpp"
#include "bench/stability_room.hpp"
#include "irradiance_cache/settings.hpp"
#include "pathtracer/path_tracer.hpp"
#include "radiosity/radiosity_view.hpp"
#include "render/renderer.hpp"

#include <fmt/core.h>

#include <array>
#include <cmath>

namespace lucerna::demo::bench {

namespace {

constexpr glm::ivec2 kLimitsSize{8, 8};

Camera limitsCamera(const glm::dvec3& position, const glm::dvec3& target, double fov) {
  Camera camera;
  camera.position = position;
  camera.direction = glm::normalize(target - position);
  camera.up = std::abs(camera.direction.y) > 0.9 ? glm::dvec3(0.0, 0.0, -1.0) : glm::dvec3(0.0, 1.0, 0.0);
  camera.verticalFov = fov;
  return camera;
}

PathTracer::Statistics limitsPath(const StabilityContext& c, const Scene& scene, std::uint32_t samples,
                                  std::uint32_t bounces = PathTracer::kUnlimited) {
  PathTracer::Settings settings;
  settings.size = kLimitsSize;
  settings.seed = 1;
  settings.bounces = bounces;
  PathTracer tracer(c.context, c.programs, scene, settings);
  tracer.setCamera(scene.cameras.front());
  tracer.record(samples);
  return tracer.statistics();
}

Measurement limitsWithin(const PathTracer::Statistics& s, double expected) {
  const bool precise = s.meanError.x <= 0.01 * expected;
  return {expected, precise ? s.mean.x : NAN, 4.0 * s.meanError.x + 1e-4 * expected};
}

double limitsPicture(const StabilityContext& c, const Scene& scene, const char* technique, double longestEdge,
                     int pixelSamples = 1) {
  RenderSettings settings;
  settings.pixelSamples = pixelSamples;
  settings.technique = technique;
  settings.component = Component::direct;
  settings.size = kLimitsSize;
  settings.fullFloatTarget = true;
  settings.of<RadiosityView::Settings>().solution.patches.longestEdge = longestEdge;
  settings.of<RadiosityView::Settings>().direct = RadiosityView::Direct::pixels;
  Renderer renderer(c.context, c.programs, scene, settings);
  renderer.renderToTheEnd(scene.cameras.front());
  double sum = 0.0;
  const Image picture = renderer.readRadiance();
  for (const glm::vec3& p : picture.pixels) sum += static_cast<double>(p.x);
  return sum / static_cast<double>(picture.pixels.size());
}

/// Form factor of an element to a parallel rectangle of sides 2a and 2b at a height, its centre above the element
/// [Howell B-3].
double toRectangle(double a, double b, double height) {
  const double x = a / height, y = b / height, rx = std::sqrt(1.0 + x * x), ry = std::sqrt(1.0 + y * y);
  return 2.0 / kPi * (x / rx * std::atan(y / rx) + y / ry * std::atan(x / ry));
}

/// A lamp of length 2 over a floor of albedo 0.5, of radiance 1 over its width; turned about the vertical, so that its
/// edges are not exact.
Scene needle(double width, double height) {
  SceneParts parts("needle");
  const glm::dvec3 along(std::cos(0.3), 0.0, std::sin(0.3)), across(-std::sin(0.3), 0.0, std::cos(0.3));
  parts.plate({0, 0, 0}, {0, 0, 2}, {2, 0, 0}, parts.material(glm::vec3(0.5f)));
  parts.plate({0, height, 0}, 2.0 * along, width * across,
              parts.material(glm::vec3(0.0f), glm::vec3(static_cast<float>(1.0 / width))));
  parts.scene().cameras.push_back(limitsCamera({0, 0.5 * height, 0}, {0, 0, 0}, 1e-3));
  return std::move(parts.scene());
}

void addNeedles(std::vector<StabilityCase>& cases) {
  for (const glm::dvec2& size : {glm::dvec2(1e-3, 0.2), glm::dvec2(1e-4, 0.6), glm::dvec2(1e-6, 0.2)}) {
    const double width = size.x, height = size.y;
    const double expected = 0.5 * toRectangle(1.0, 0.5 * width, height) / width;
    const std::string parameter = fmt::format("2 x {:g}, {:g} above", width, height);
    cases.push_back({"path", "a lamp as narrow as a needle over a floor", parameter, [=](const StabilityContext& c) {
                       return limitsWithin(limitsPath(c, needle(width, height), 1024, 1), expected);
                     }});
    cases.push_back(
        {"radiosity", "a lamp as narrow as a needle over a floor", parameter, [=](const StabilityContext& c) {
           return Measurement{expected, limitsPicture(c, needle(width, height), "radiosity", 1.0), 1e-3 * expected};
         }});
  }
}

enum class Flush { point, spot, corner, emissive };

/// A room of albedo 0.6 with the ceiling at y = 0.7 and a lamp in its plane, `below` it.
Scene flush(Flush kind, double below) {
  SceneParts parts("flush");
  const int wall = parts.material(glm::vec3(0.6f));
  parts.plate({0, -1, 0}, {0, 0, 2}, {2, 0, 0}, wall);
  parts.plate({0, 0.7, 0}, {2, 0, 0}, {0, 0, 2}, wall);
  parts.plate({-1, -0.15, 0}, {0, 1.7, 0}, {0, 0, 2}, wall);
  parts.plate({0, -0.15, -1}, {2, 0, 0}, {0, 1.7, 0}, wall);
  Scene& scene = parts.scene();
  const double y = 0.7 - below;
  switch (kind) {
    case Flush::point: scene.points.push_back({{0.1, y, 0.2}, glm::vec3(1.0f)}); break;
    case Flush::spot: scene.spots.push_back({{0.1, y, 0.2}, {0, -1, 0}, glm::vec3(1.0f), 1.2, 1.3}); break;
    case Flush::corner: scene.points.push_back({{-1.0 + below, y, -1.0 + below}, glm::vec3(1.0f)}); break;
    case Flush::emissive:
      parts.plate({0.1, y, 0.2}, {0.3, 0, 0}, {0, 0, 0.3}, parts.material(glm::vec3(0.0f), glm::vec3(5.0f)));
  }
  scene.cameras.push_back(limitsCamera({0.2, 0.5, 0.1}, {0.2, -1.0, 0.1}, 0.6));
  return std::move(scene);
}

void addFlush(std::vector<StabilityCase>& cases) {
  const std::array kinds{std::pair{Flush::point, "point"}, std::pair{Flush::spot, "spot"},
                         std::pair{Flush::corner, "point in a corner"}, std::pair{Flush::emissive, "emissive"}};
  for (const auto& [kind, name] : kinds)
    for (const char* technique : {"path", "direct", "rsm", "irradiance-cache", "radiosity"}) {
      if (kind == Flush::emissive && std::string_view(technique) != "path" &&
          std::string_view(technique) != "radiosity")
        continue;
      cases.push_back({technique, "a lamp in the ceiling's plane, against 1e-5 lower", name,
                       [kind = kind, technique](const StabilityContext& c) {
                         const auto mean = [&](double below) {
                           return std::string_view(technique) == "path"
                                      ? limitsPath(c, flush(kind, below), 256, 1).mean.x
                                      : limitsPicture(c, flush(kind, below), technique, 2.0);
                         };
                         return Measurement{1.0, mean(0.0) / mean(1e-5), 5e-3};
                       }});
    }
}

/// A slab below y = 0 of albedo 0.8 under a sun at 40 degrees, seen at 25.
Scene denseSlab(double extinction, double halfWidth, bool grid) {
  SceneParts parts("dense");
  const int boundary = parts.material(glm::vec3(0.0f));
  parts.materialAt(boundary).bsdf = Bsdf::none;
  parts.materialAt(boundary).interior = 0;
  parts.box({-halfWidth, -1, -halfWidth}, {halfWidth, 0, halfWidth}, boundary);
  Scene& scene = parts.scene();
  Medium medium;
  medium.scattering = glm::vec3(static_cast<float>(0.8 * extinction));
  medium.absorption = glm::vec3(static_cast<float>(0.2 * extinction));
  if (grid)
    medium.grid =
        DensityGrid{{4, 4, 4}, std::vector<float>(64, 1.0f), {-halfWidth, -1, -halfWidth}, {halfWidth, 0, halfWidth}};
  scene.media = {medium};
  const double sun = 40.0 * kPi / 180.0, view = 25.0 * kPi / 180.0;
  scene.sun = DirectionalLight{{std::sin(sun), -std::cos(sun), 0.0}, glm::vec3(1.0f)};
  scene.cameras.push_back(limitsCamera({-0.3 * std::tan(view), 0.3, 0.0}, {0, 0, 0}, 1e-3));
  return std::move(scene);
}

void addDense(std::vector<StabilityCase>& cases) {
  // Light scattered once: 0.8 / (4 pi) mu0 / (mu + mu0); all light: times H(mu) H(mu0) [Chandrasekhar1960].
  struct Dense {
    double extinction, halfWidth;
    bool grid;
  };
  for (const Dense& d : {Dense{1e6, 1.0, false}, Dense{1e6, 10.0, false}, Dense{1e6, 100.0, false},
                         Dense{3e3, 30.0, true}, Dense{3e3, 300.0, true}})
    for (const bool once : {true, false}) {
      if (d.grid && !once) continue;
      cases.push_back({"path",
                       fmt::format("a dense medium{} under the sun, {}", d.grid ? " on a grid" : "",
                                   once ? "scattered once" : "all light"),
                       fmt::format("{:g} free paths", d.extinction * d.halfWidth), [=](const StabilityContext& c) {
                         return limitsWithin(limitsPath(c, denseSlab(d.extinction, d.halfWidth, d.grid),
                                                        once ? 512u : 4096u, once ? 1u : PathTracer::kUnlimited),
                                             once ? 0.0291613 : 0.0697929);
                       }});
    }
}

/// Fog of extinction 1 and 2 across around fog of 3 and 1 across, in light of radiance 1.
Scene nested(bool denseFirst) {
  SceneParts parts("nested");
  const int first = parts.material(glm::vec3(0.0f)), second = parts.material(glm::vec3(0.0f)),
            dense = denseFirst ? first : second, thin = denseFirst ? second : first;
  parts.box({-1, -1, -1}, {1, 1, 1}, thin);
  parts.box({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}, dense);
  Scene& scene = parts.scene();
  scene.media.resize(2);
  for (const int m : {first, second}) {
    Material& material = parts.materialAt(m);
    material.bsdf = Bsdf::none;
    material.interior = m - first;
    scene.media[static_cast<std::size_t>(material.interior)].absorption = glm::vec3(m == dense ? 3.0f : 1.0f);
  }
  scene.environment = Environment{glm::vec3(1.0f), {}, 0.0};
  scene.cameras.push_back(limitsCamera({0.01, 0.02, 3}, {0.01, 0.02, 0}, 1e-3));
  return std::move(scene);
}

/// A closed room of albedo 0.6 with a lamp below its ceiling, wound inwards and down, or turned.
Scene turned(bool room, bool lamp) {
  SceneParts parts("turned");
  const int wall = parts.material(glm::vec3(0.6f));
  const auto plate = [&](const glm::dvec3& centre, const glm::dvec3& u, const glm::dvec3& v, bool other, int material) {
    parts.plate(centre, other ? v : u, other ? u : v, material);
  };
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) {
      glm::dvec3 centre(0.0), u(0.0), v(0.0);
      centre[axis] = side;
      u[(axis + 1) % 3] = v[(axis + 2) % 3] = 2.0;
      plate(centre, u, v, (side > 0.0) != room, wall);
    }
  plate({0, 0.5, 0}, {0.5, 0, 0}, {0, 0, 0.5}, lamp, parts.material(glm::vec3(0.0f), glm::vec3(4.0f)));
  parts.scene().cameras.push_back(limitsCamera({0.5, 0.2, 0.6}, {-0.3, -1.0, -0.2}, 0.9));
  return std::move(parts.scene());
}

/// A floor under a sky that is one bright texel; with an albedo of 0.5 it has this radiance.
Scene oneTexel(double& expected) {
  SceneParts parts("texel");
  parts.plate({0, 0, 0}, {0, 0, 2}, {2, 0, 0}, parts.material(glm::vec3(0.5f)));
  Environment sky{glm::vec3(1.0f), Image(64, 32), 0.0};
  sky.picture->at(20, 7) = glm::vec3(1000.0f);
  parts.scene().environment = sky;
  parts.scene().cameras.push_back(limitsCamera({0, 1, 0}, {0, 0, 0}, 0.9));
  const double top = std::cos(kPi * 7 / 32), bottom = std::cos(kPi * 8 / 32);
  expected = 0.5 * 1000.0 / 64.0 * (top * top - bottom * bottom);
  return std::move(parts.scene());
}

double cachePicture(const StabilityContext& c, const Scene& scene, CacheTransport transport) {
  RenderSettings settings;
  settings.technique = "irradiance-cache";
  settings.size = kLimitsSize;
  settings.fullFloatTarget = true;
  settings.of<IrradianceCacheSettings>().transport = transport;
  Renderer renderer(c.context, c.programs, scene, settings);
  renderer.renderToTheEnd(scene.cameras.front());
  return meanOf(renderer.readRadiance()).x;
}

/// A closed room with a lamp of radiance 1, and another with one of radiance `beside`, if that is above 0.
Scene dimRoom(float beside) {
  SceneParts parts("dim");
  const int wall = parts.material(glm::vec3(0.6f));
  for (const double x : {0.0, 4.0}) {
    const float radiance = x > 0.0 ? beside : 1.0f;
    if (!(radiance > 0.0f)) continue;
    for (int axis = 0; axis < 3; ++axis)
      for (const double side : {-1.0, 1.0}) {
        glm::dvec3 centre(0.0), u(0.0), v(0.0);
        centre[axis] = side;
        centre.x += x;
        u[(axis + 1) % 3] = v[(axis + 2) % 3] = 2.0;
        parts.plate(centre, side < 0.0 ? u : v, side < 0.0 ? v : u, wall);
      }
    parts.plate({x, 0.6, 0}, {0.4, 0, 0}, {0, 0, 0.4}, parts.material(glm::vec3(0.0f), glm::vec3(radiance)));
  }
  parts.scene().cameras.push_back(limitsCamera({0.8, 0.3, 0.8}, {-0.5, -0.6, -0.5}, 1.2));
  return std::move(parts.scene());
}

void addBeyondHalfFloats(std::vector<StabilityCase>& cases) {
  for (const float beside : {1e5f, 1e9f})
    cases.push_back({"irradiance-cache", "rays: a dim room beside a bright one, against alone",
                     fmt::format("{:g} times as bright", static_cast<double>(beside)), [=](const StabilityContext& c) {
                       return Measurement{1.0,
                                          cachePicture(c, dimRoom(beside), CacheTransport::rays) /
                                              cachePicture(c, dimRoom(0.0f), CacheTransport::rays),
                                          0.05};
                     }});
}

/// The wall beside a lit floor: one bounce, by reflective shadow maps and by paths.
void addReach(std::vector<StabilityCase>& cases) {
  for (const bool sun : {true, false})
    cases.push_back({"rsm", "one bounce of a lit floor on a wall, against paths", sun ? "sun" : "point lamp",
                     [sun](const StabilityContext& c) {
                       SceneParts parts("reach");
                       const int grey = parts.material(glm::vec3(0.7f));
                       parts.plate({0, 0, 0}, {0, 0, 4}, {4, 0, 0}, grey);
                       parts.plate({0, 1.5, -2}, {4, 0, 0}, {0, 3, 0}, grey);
                       Scene& scene = parts.scene();
                       if (sun) scene.sun = DirectionalLight{{0.001, -1.0, 0.001}, glm::vec3(3.0f)};
                       else scene.points.push_back({{0, 1.5, 1}, glm::vec3(1.0f)});
                       scene.cameras.push_back(limitsCamera({0, 1.5, 3}, {0, 1.2, -2}, 0.2));
                       RenderSettings settings;
                       settings.technique = "rsm";
                       settings.component = Component::indirect;
                       settings.size = kLimitsSize;
                       settings.fullFloatTarget = true;
                       Renderer renderer(c.context, c.programs, scene, settings);
                       renderer.renderToTheEnd(scene.cameras.front());
                       const double all = limitsPath(c, scene, 512, 2).mean.x,
                                    direct = limitsPath(c, scene, 512, 1).mean.x;
                       return Measurement{1.0, meanOf(renderer.readRadiance()).x / (all - direct), 0.03};
                     }});
}

/// A closed room with a lamp of 4 cm `below` its ceiling, whose bright spot is smaller than the cells of records.
Scene spotOnCeiling(double halfSide, double below) {
  SceneParts parts("spot");
  const int wall = parts.material(glm::vec3(0.6f));
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-halfSide, halfSide}) {
      glm::dvec3 centre(0.0), u(0.0), v(0.0);
      centre[axis] = side;
      u[(axis + 1) % 3] = v[(axis + 2) % 3] = 2.0 * halfSide;
      parts.plate(centre, side < 0.0 ? u : v, side < 0.0 ? v : u, wall);
    }
  parts.plate({0, halfSide - below, 0}, {0.04, 0, 0}, {0, 0, 0.04}, parts.material(glm::vec3(0.0f), glm::vec3(400.0f)));
  parts.scene().cameras.push_back(
      limitsCamera(halfSide * glm::dvec3(0.9, -0.2, 0.9), halfSide * glm::dvec3(-0.5, 0.25, -0.5), 1.309));
  return std::move(parts.scene());
}

/// Of what is lit by the ceiling's bright spot: the lower rows of a picture in which the spot is, too.
void addSmallLamps(std::vector<StabilityCase>& cases) {
  for (const glm::dvec2& room : {glm::dvec2(2.0, 0.1), glm::dvec2(1.0, 0.02)})
    cases.push_back({"irradiance-cache", "rays: a lamp of 4 cm below a ceiling: all light over direct and indirect",
                     fmt::format("{:g} cm below, room of {:g} m", 100.0 * room.y, 2.0 * room.x),
                     [room](const StabilityContext& c) {
                       const Scene scene = spotOnCeiling(room.x, room.y);
                       const auto floor = [&](Component component) {
                         RenderSettings settings;
                         settings.technique = "irradiance-cache";
                         settings.component = component;
                         settings.size = {32, 32};
                         settings.fullFloatTarget = true;
                         settings.of<IrradianceCacheSettings>().samples = 2048;
                         Renderer renderer(c.context, c.programs, scene, settings);
                         renderer.renderToTheEnd(scene.cameras.front());
                         const Image picture = renderer.readRadiance();
                         double sum = 0.0;
                         for (int y = 20; y < 32; ++y)
                           for (int x = 0; x < 32; ++x) sum += static_cast<double>(picture.at(x, y).x);
                         return sum;
                       };
                       return Measurement{
                           1.0, floor(Component::all) / (floor(Component::direct) + floor(Component::indirect)), 0.03};
                     }});
  // The spot is smaller than the cells of the bounce cache, too.
  for (const int cells : {8, 11, 16})
    cases.push_back({"irradiance-cache", "gather: a lamp of 4 cm 10 cm below a ceiling: reflected light over paths",
                     fmt::format("{} cells in the room's 4 m", cells), [cells](const StabilityContext& c) {
                       const Scene scene = spotOnCeiling(2.0, 0.1);
                       RenderSettings settings;
                       settings.technique = "irradiance-cache";
                       settings.component = Component::indirect;
                       settings.size = {32, 32};
                       settings.fullFloatTarget = true;
                       settings.of<IrradianceCacheSettings>().transport = CacheTransport::gather;
                       settings.of<IrradianceCacheSettings>().bounceCells = cells;
                       Renderer renderer(c.context, c.programs, scene, settings);
                       renderer.renderToTheEnd(scene.cameras.front());
                       const double all = limitsPath(c, scene, 1024).mean.x,
                                    direct = limitsPath(c, scene, 1024, 1).mean.x;
                       return Measurement{1.0, meanOf(renderer.readRadiance()).x / (all - direct), 0.2};
                     }});
}

/// The foot of a box on a floor 100 wide, in the shadow of a lamp 1,000 away: no light.
void addFarLamp(std::vector<StabilityCase>& cases) {
  cases.push_back({"direct", "a lamp 1,000 away: light in the shadow at the foot of a box of 1 on a floor of 100",
                   "map", [](const StabilityContext& c) {
                     SceneParts parts("foot");
                     const int grey = parts.material(glm::vec3(0.6f));
                     parts.plate({0, 0, 0}, {0, 0, 100}, {100, 0, 0}, grey);
                     parts.box({-0.5, 0, -0.5}, {0.5, 1, 0.5}, grey);
                     parts.scene().points.push_back({{-700, 600, -300}, glm::vec3(1e6f)});
                     parts.scene().cameras.push_back(limitsCamera({0.9, 1.2, 1.4}, {0.55, 0, 0.5}, 0.209));
                     return Measurement{1e-5, limitsPicture(c, parts.scene(), "direct", 1.0), 0.0, Rule::atMost};
                   }});
}

/// The shadow of a box of 2 m on a plain of 5 km, of one material: what a picture shows large has a shadow, however
/// wide the map's texels are.
void addPlain(std::vector<StabilityCase>& cases) {
  const auto plain = [] {
    SceneParts parts("plain");
    const int grey = parts.material(glm::vec3(0.5f));
    parts.plate({0, 0, 0}, {0, 0, 5000}, {5000, 0, 0}, grey);
    parts.box({-1, 0, -1}, {1, 2, 1}, grey);
    parts.scene().cameras.push_back(limitsCamera({2, 12, 0}, {2, 0, 0}, 0.05));
    return std::move(parts.scene());
  };
  for (const char* technique : {"direct", "irradiance-cache"})
    for (const double away : {0.0, 100.0, 1e3, 2e4})
      cases.push_back({technique, "box of 2 on a plain of 5,000: its shadow over the light beside",
                       away > 0.0 ? fmt::format("lamp {:g} away", std::sqrt(2.0) * away) : "sun",
                       [=](const StabilityContext& c) {
                         Scene scene = plain();
                         const auto intensity = glm::vec3(static_cast<float>(2.0 * away * away));
                         if (away > 0.0) scene.points.push_back({{-away, away + 1.0, 0.0}, intensity});
                         else scene.sun = DirectionalLight{glm::normalize(glm::dvec3(1, -1, 0)), glm::vec3(1.0f)};
                         const double dark = limitsPicture(c, scene, technique, 1.0);
                         scene.cameras = {limitsCamera({8, 12, 0}, {8, 0, 0}, 0.05)};
                         return Measurement{1e-3, dark / limitsPicture(c, scene, technique, 1.0), 0.0, Rule::atMost};
                       }});
  cases.push_back({"direct", "box of 2 on a plain of 5,000: its shadow over the light beside", "spot",
                   [=](const StabilityContext& c) {
                     Scene scene = plain();
                     SpotLight spot;
                     spot.position = {-100, 101, 0};
                     spot.direction = glm::normalize(glm::dvec3(1, -1, 0));
                     spot.intensity = glm::vec3(2e4f);
                     spot.innerAngle = 1.0;
                     spot.outerAngle = 1.2;
                     scene.spots = {spot};
                     const double dark = limitsPicture(c, scene, "direct", 1.0);
                     scene.cameras = {limitsCamera({8, 12, 0}, {8, 0, 0}, 0.05)};
                     return Measurement{1e-3, dark / limitsPicture(c, scene, "direct", 1.0), 0.0, Rule::atMost};
                   }});
}

/// Of a room like Cornell's, whose pixels look into the slit between its lamp and the ceiling: light in there is
/// bright, and the records' cells are wider.
void addSlit(std::vector<StabilityCase>& cases) {
  cases.push_back({"irradiance-cache", "lamp a thousandth of a room below the ceiling: indirect, over paths", "48x48",
                   [](const StabilityContext& c) {
                     SceneParts parts("slit");
                     const int white = parts.material(glm::vec3(0.725f));
                     const double side = 0.55, middle = 0.5 * side, up = side - 5e-4;
                     parts.plate({middle, 0, middle}, {0, 0, side}, {side, 0, 0}, white);
                     parts.plate({middle, side, middle}, {side, 0, 0}, {0, 0, side}, white);
                     parts.plate({middle, middle, side}, {0, side, 0}, {side, 0, 0}, white);
                     parts.plate({0, middle, middle}, {0, side, 0}, {0, 0, side}, white);
                     parts.plate({side, middle, middle}, {0, 0, side}, {0, side, 0}, white);
                     parts.plate({0.278, up, 0.2795}, {0.13, 0, 0}, {0, 0, 0.105},
                                 parts.material(glm::vec3(0.78f), glm::vec3(17.0f)));
                     parts.scene().cameras.push_back(limitsCamera({0.278, 0.273, -0.8}, {0.278, 0.273, 0.0}, 0.68605));
                     RenderSettings settings;
                     settings.component = Component::indirect;
                     settings.size = {48, 48};
                     settings.pixelSamples = 16;
                     settings.fullFloatTarget = true;
                     const auto shown = [&](const char* technique) {
                       settings.technique = technique;
                       settings.of<PathSettings>().samples = 64;
                       Renderer renderer(c.context, c.programs, parts.scene(), settings);
                       renderer.renderToTheEnd(parts.scene().cameras.front());
                       return meanOf(renderer.readRadiance()).x;
                     };
                     return Measurement{1.0, shown("irradiance-cache") / shown("path"), 0.08};
                   }});
}

/// What stands beside the camera in a scene 13,000 km wide is within the near plane: drawn, or named by a warning.
void addNearMesh(std::vector<StabilityCase>& cases) {
  cases.push_back(
      {"direct", "a floor beside a mesh 1.3e7 away: drawn (1) or named by a warning (1)", "sun",
       [](const StabilityContext& c) {
         SceneParts parts("wide");
         const int grey = parts.material(glm::vec3(0.6f));
         parts.box({-0.5, 0, -0.5}, {0.5, 1, 0.5}, grey);
         parts.box({1.3e7, 0, 0}, {1.3e7 + 1, 1, 1}, grey);
         parts.scene().sun = DirectionalLight{{0.0, -1.0, 0.0}, glm::vec3(1.0f)};
         parts.scene().cameras.push_back(limitsCamera({2.2, 2.2, 1.5}, {0, 0.5, 0}, 0.7));
         const std::size_t before = loggedWarnings().size();
         const bool isDrawn = limitsPicture(c, parts.scene(), "direct", 1.0) > 0.01;
         return Measurement{1.0, isDrawn ? 1.0 : static_cast<double>(loggedWarnings().size() - before), 0.0};
       }});
}

/// A lamp in the picture, whose rim covers pixels in part.
void addSeenLamp(std::vector<StabilityCase>& cases) {
  cases.push_back({"radiosity", "a lamp in the picture: emission and direct light, over paths", "256 samples a pixel",
                   [](const StabilityContext& c) {
                     Scene scene = turned(false, false);
                     scene.cameras = {limitsCamera({0.8, -0.5, 0.85}, {-0.3, 0.4, -0.2}, 1.2217)};
                     const double seen = limitsPicture(c, scene, "radiosity", 0.7, 256);
                     return Measurement{1.0, seen / limitsPath(c, scene, 4096, 1).mean.x, 0.01};
                   }});
}

/// A dark floor under a coat and a lamp, whose highlight is in the picture.
void addCoat(std::vector<StabilityCase>& cases) {
  for (const char* technique : {"direct", "radiosity"})
    cases.push_back({technique, "a coated floor under a lamp, against paths", "alpha 0.2, albedo 0.03",
                     [technique](const StabilityContext& c) {
                       SceneParts parts("coat");
                       const int floor = parts.material(glm::vec3(0.03f));
                       parts.materialAt(floor).specular = glm::vec3(0.5f);
                       parts.materialAt(floor).roughness = 0.45f;
                       parts.plate({0, 0, 0}, {0, 0, 4}, {4, 0, 0}, floor);
                       parts.scene().points.push_back({{0, 1.5, -2}, glm::vec3(3.0f)});
                       parts.scene().cameras.push_back(limitsCamera({0, 1.5, 2}, {0, 0, 0}, 0.7));
                       return Measurement{1.0,
                                          limitsPicture(c, parts.scene(), technique, 1.0) /
                                              limitsPath(c, parts.scene(), 512, 1).mean.x,
                                          0.03};
                     }});
}

/// What the published form factors and masks do to radiosity's light, which its picture must show.
void addAsPublished(std::vector<StabilityCase>& cases) {
  cases.push_back({"radiosity", "direct light between plates as published, over the exact one: its error shows",
                   "--fidelity original", [](const StabilityContext& c) {
                     SceneParts parts("plates");
                     parts.plate({0, 0, 0}, {0, 0, 2}, {2, 0, 0}, parts.material(glm::vec3(0.5f)));
                     parts.plate({0, 1, 0}, {2, 0, 0}, {0, 0, 2}, parts.material(glm::vec3(0.0f), glm::vec3(1.0f)));
                     parts.scene().cameras.push_back(limitsCamera({0, 0.5, 0}, {0, 0, 0}, 1e-3));
                     RenderSettings settings;
                     settings.technique = "radiosity";
                     settings.component = Component::direct;
                     settings.size = kLimitsSize;
                     settings.fullFloatTarget = true;
                     auto& view = settings.of<RadiosityView::Settings>();
                     view.solution.patches.longestEdge = 0.5;
                     view.direct = RadiosityView::Direct::patches;
                     for (bool RadiosityDeviations::*deviation :
                          {&RadiosityDeviations::publishedMap, &RadiosityDeviations::centroid,
                           &RadiosityDeviations::fixedOrientation, &RadiosityDeviations::noNearField})
                       view.solution.deviations.*deviation = true;
                     Renderer renderer(c.context, c.programs, parts.scene(), settings);
                     renderer.renderToTheEnd(parts.scene().cameras.front());
                     return Measurement{0.95, meanOf(renderer.readRadiance()).x / (0.5 * toRectangle(1.0, 1.0, 1.0)),
                                        0.0, Rule::atMost};
                   }});
  cases.push_back({"radiosity", "light through a sheet that its mask cuts away: it blocks, with a warning", "mask",
                   [](const StabilityContext& c) {
                     SceneParts parts("mask");
                     parts.plate({0, 0, 0}, {0, 0, 2}, {2, 0, 0}, parts.material(glm::vec3(0.5f)));
                     const int leaf = parts.material(glm::vec3(0.5f));
                     Texture& texture = parts.scene().textures.emplace_back();
                     texture.bitmap = {1, 1, {255, 255, 255, 0}};
                     texture.bitmap.hasAlpha = true;
                     parts.materialAt(leaf).diffuseTexture = 0;
                     parts.materialAt(leaf).alphaMasked = true;
                     parts.plate({0, 1, 0}, {0, 0, 4}, {4, 0, 0}, leaf);
                     parts.scene().points.push_back({{0, 1.5, 0}, glm::vec3(1.0f)});
                     parts.scene().cameras.push_back(limitsCamera({0, 0.5, 0}, {0, 0, 0}, 0.5));
                     const std::size_t before = loggedWarnings().size();
                     const double arrives = limitsPicture(c, parts.scene(), "radiosity", 1.0);
                     return Measurement{1.0, arrives + static_cast<double>(loggedWarnings().size() - before), 0.0};
                   }});
  cases.push_back(
      {"radiosity", "a lamp in the ceiling's plane, seen: share of the picture that shines", "32 x 32",
       [](const StabilityContext& c) {
         SceneParts parts("seen");
         parts.plate({0, 0.7, 0}, {2, 0, 0}, {0, 0, 2}, parts.material(glm::vec3(0.0f)));
         parts.plate({0.013, 0.7, 0.021}, {1, 0, 0}, {0, 0, 1}, parts.material(glm::vec3(0.0f), glm::vec3(1.0f)));
         parts.scene().cameras.push_back(limitsCamera({0.1, -0.7, 0.07}, {0.013, 0.7, 0.021}, 1.0));
         Scene alone = parts.scene();
         alone.meshes.erase(alone.meshes.begin());
         RenderSettings settings;
         settings.technique = "radiosity";
         settings.size = {32, 32};
         settings.fullFloatTarget = true;
         const auto shines = [&](const Scene& scene) {
           Renderer renderer(c.context, c.programs, scene, settings);
           renderer.renderToTheEnd(scene.cameras.front());
           return meanOf(renderer.readRadiance()).x;
         };
         return Measurement{1.0, shines(parts.scene()) / shines(alone), 1e-3};
       }});
}

}  // namespace

void addLimitCases(std::vector<StabilityCase>& cases) {
  addNeedles(cases);
  addFlush(cases);
  addDense(cases);
  for (const bool denseFirst : {false, true})
    cases.push_back({"path", "a medium within a medium without priorities: exp(-4)",
                     denseFirst ? "inner named first" : "outer named first", [=](const StabilityContext& c) {
                       const PathTracer::Statistics s = limitsPath(c, nested(denseFirst), 64);
                       return Measurement{std::exp(-4.0), s.mean.x, 1e-6 * std::exp(-4.0)};  // a weight, without noise
                     }});
  cases.push_back(
      {"path", "four samples that find no light: relative error", "optical depth 1e-6", [](const StabilityContext& c) {
         Scene thin = denseSlab(1e-6, 1.0, false);
         return Measurement{1.0, std::min(limitsPath(c, thin, 4, 1).relativeError, 1e9), 0.0, Rule::atLeast};
       }});
  for (const char* technique : {"radiosity", "irradiance-cache"})
    cases.push_back({technique, "a sky of one bright texel over a floor",
                     std::string_view(technique) == "radiosity" ? "64 x 32" : "64 x 32, gather",
                     [technique](const StabilityContext& c) {
                       double expected = 0.0;
                       const Scene scene = oneTexel(expected);
                       return Measurement{expected,
                                          std::string_view(technique) == "radiosity"
                                              ? limitsPicture(c, scene, technique, 0.5)
                                              : cachePicture(c, scene, CacheTransport::gather),
                                          (std::string_view(technique) == "radiosity" ? 0.01 : 0.02) * expected};
                     }});
  addBeyondHalfFloats(cases);
  addReach(cases);
  addSmallLamps(cases);
  addFarLamp(cases);
  addPlain(cases);
  addSlit(cases);
  addNearMesh(cases);
  addSeenLamp(cases);
  addAsPublished(cases);
  addCoat(cases);
  cases.push_back({"radiosity", "a lamp whose picture is one white texel of 3 x 3", "1.5 x 1.5, 0.4 above",
                   [](const StabilityContext& c) {
                     SceneParts parts("picture");
                     parts.plate({0, 0, 0}, {0, 0, 2}, {2, 0, 0}, parts.material(glm::vec3(0.5f)));
                     const int lamp = parts.material(glm::vec3(0.0f), glm::vec3(1.0f));
                     Texture& texture = parts.scene().textures.emplace_back();
                     texture.bitmap = {3, 3, std::vector<std::uint8_t>(36, 0)};
                     for (std::size_t k = 16; k < 20; ++k) texture.bitmap.rgba[k] = 255;
                     parts.materialAt(lamp).emissionTexture = 0;
                     parts.materialAt(lamp).emissionScale = glm::vec3(1.0f);
                     parts.plate({0, 0.4, 0}, {1.5, 0, 0}, {0, 0, 1.5}, lamp);
                     Vertex* corners = &parts.scene().vertices.back() - 3;
                     for (const int k : {0, 1, 2, 3}) corners[k].texCoord = {k == 1 || k == 2, k >= 2};
                     parts.scene().cameras.push_back(limitsCamera({0, 0.2, 0}, {0, 0, 0}, 1e-3));
                     const double expected = 0.5 * toRectangle(0.25, 0.25, 0.4);
                     return Measurement{expected, limitsPicture(c, parts.scene(), "radiosity", 2.0), 1e-3 * expected};
                   }});
  for (const auto& [room, lamp] : {std::pair{false, true}, std::pair{true, false}, std::pair{true, true}})
    cases.push_back({"radiosity", "a room or lamp wound the other way, against as it should be",
                     fmt::format("{}{}{}", room ? "room" : "", room && lamp ? " and " : "", lamp ? "lamp" : ""),
                     [room = room, lamp = lamp](const StabilityContext& c) {
                       return Measurement{1.0,
                                          limitsPicture(c, turned(room, lamp), "radiosity", 0.7) /
                                              limitsPicture(c, turned(false, false), "radiosity", 0.7),
                                          0.01};
                     }});
}

}  // namespace lucerna::demo::bench
