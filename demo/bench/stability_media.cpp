// Stiff and extreme cases of participating media: optical depths 1e-6 to 1e6, phase functions from isotropic to
// needle-like, albedo 1, channels that differ by a factor of ten thousand, nested boundaries, cameras inside, scale and
// position. Slabs have exact answers [Chandrasekhar1960] [vandeHulst1980]; a medium without absorption must return all
// light. Statistical: within 4 standard errors, and the error itself is bounded.
#include "bench/stability.hpp"
#include "bench/stability_room.hpp"
#include "pathtracer/path_tracer.hpp"

#include <fmt/core.h>

#include <cmath>
#include <limits>
#include <tuple>

namespace lucerna::demo::bench {

namespace {

void addMediaRow(std::vector<StabilityCase>& cases, std::string name, std::string parameter,
                 std::function<Measurement(const StabilityContext&)> run) {
  cases.push_back({"path", std::move(name), std::move(parameter), std::move(run)});
}

PathTracer::Statistics trace(const StabilityContext& c, const Scene& scene, std::uint32_t samples, int side = 16) {
  PathTracer::Settings settings;
  settings.size = {side, side};
  settings.seed = 1;
  settings.nextEvent = false;  // an environment of two halves is hit by every escaping path
  PathTracer tracer(c.context, c.programs, scene, settings);
  tracer.setCamera(scene.cameras.front());
  tracer.record(samples);
  return tracer.statistics();
}

/// Allows 1e-5 in addition to 4 standard errors: the error estimated from a few counts is unreliable.
Measurement within(double value, double error, double exact, double worstError) {
  const bool precise = error <= worstError && std::isfinite(value);
  return {exact, precise ? value : NAN, 4.0 * error + 1e-5 * std::max(1.0, exact)};
}

Medium medium(const glm::dvec3& extinction, const glm::dvec3& albedo, double g = 0.0) {
  Medium m;
  m.scattering = glm::vec3(extinction * albedo);
  m.absorption = glm::vec3(extinction * (1.0 - albedo));
  m.anisotropy = glm::vec3(static_cast<float>(g));
  return m;
}
Medium grey(double depth, double albedo, double g = 0.0) { return medium(glm::dvec3(depth), glm::dvec3(albedo), g); }

struct Slab {
  double scale = 1.0;
  glm::dvec3 place{0.0};
  Bsdf bsdf = Bsdf::none;
  double ior = 1.0;
  double halfWidth = 30.0;  ///< in units of the thickness
};

/// Thickness 1, so wide that nothing leaves through its sides, seen straight from above; light 1 in red from above and
/// in green from below, in all channels if `white`. Red is then the reflectance, green the transmittance.
Scene slabScene(const Medium& filling, const Slab& slab = {}, bool white = false) {
  SceneParts parts("slab");
  const int boundary = parts.material(glm::vec3(0.0f));
  parts.materialAt(boundary).bsdf = slab.bsdf;
  parts.materialAt(boundary).ior = static_cast<float>(slab.ior);
  parts.materialAt(boundary).interior = 0;
  const double h = slab.halfWidth * slab.scale;
  parts.box(slab.place - glm::dvec3(h, 0.5 * slab.scale, h), slab.place + glm::dvec3(h, 0.5 * slab.scale, h), boundary);
  Scene& scene = parts.scene();
  scene.media = {filling};
  scene.media[0].scattering /= static_cast<float>(slab.scale);
  scene.media[0].absorption /= static_cast<float>(slab.scale);
  Environment environment;
  environment.radiance = glm::vec3(1.0f);
  if (!white) {
    Image halves(1, 2);
    halves.at(0, 0) = {1.0f, 0.0f, 0.0f};
    halves.at(0, 1) = {0.0f, 1.0f, 0.0f};
    environment.picture = halves;
  }
  scene.environment = environment;
  Camera camera;
  camera.position = slab.place + slab.scale * glm::dvec3(0.013, 2.5, 0.007);  // off the diagonals of the box's faces
  camera.direction = {0.0, -1.0, 0.0};
  camera.up = {0.0, 0.0, 1.0};
  camera.verticalFov = 1e-4;
  scene.cameras = {camera};
  return scene;
}

void addDepths(std::vector<StabilityCase>& cases) {
  struct Row {
    double depth, transmittance;
    std::uint32_t samples;
    int side;
  };
  // Without absorption each path's throughput stays 1, so reflection and transmission add up to all light, and no path
  // is lost at a boundary.
  constexpr Row kRows[] = {{1e-6, 1.0 - 4.9999975e-7, 256, 16},
                           {1e-3, 1.0 - 4.9975038e-4, 1024, 16},
                           {100.0, .016553, 16, 16},
                           {1e3, NAN, 1, 8}};
  for (const Row& row : kRows) {
    if (std::isfinite(row.transmittance))
      addMediaRow(cases, "slab that absorbs nothing, transmittance", fmt::format("optical depth {:g}", row.depth),
                  [row](const StabilityContext& c) {
                    const auto s = trace(c, slabScene(grey(row.depth, 1.0)), row.samples, row.side);
                    return within(s.mean.y, s.meanError.y, row.transmittance, 0.02);
                  });
    addMediaRow(cases, "slab that absorbs nothing, both sides", fmt::format("optical depth {:g}", row.depth),
                [row](const StabilityContext& c) {
                  Slab slab;
                  if (row.depth >= 1e3) slab.halfWidth = 0.5;  // a block: coordinates no larger than necessary
                  const auto s = trace(c, slabScene(grey(row.depth, 1.0), slab), row.samples, row.side);
                  // in a thin medium what scatters is followed now and then
                  const double chance = row.depth < 1.0 ? 4.0 * std::hypot(s.meanError.x, s.meanError.y) : 0.0;
                  return Measurement{1.0, s.mean.x + s.mean.y, 2e-5 + chance};
                });
  }
  // A block as wide as it is thick: coordinates resolve a mean free path of 1e-6 of it, but none shorter.
  for (const double depth : {1e3, 1e4, 1e5, 1e6})
    for (const auto& [albedo, reflectance] : {std::pair{.5, .115225878}, std::pair{.99, .752720717}})
      addMediaRow(cases, "half-space, 1 - H(1) sqrt(1 - albedo)", fmt::format("depth {:g}, albedo {:g}", depth, albedo),
                  [depth, albedo = albedo, reflectance = reflectance](const StabilityContext& c) {
                    Slab block;
                    block.halfWidth = 0.5;
                    const auto s = trace(c, slabScene(grey(depth, albedo), block), albedo > .9 ? 64 : 256);
                    return within(s.mean.x, s.meanError.x, reflectance, 0.005);
                  });
  for (const double depth : {1e-6, 1e-3, 1.0, 1e3})
    addMediaRow(cases, "absorption alone: what a medium emits", fmt::format("optical depth {:g}", depth),
                [depth](const StabilityContext& c) {
                  Scene scene = slabScene(grey(depth, 0.0));
                  scene.environment.reset();
                  scene.media[0].emission = scene.media[0].absorption / static_cast<float>(depth);
                  // A share of the radiance, relative to that of an infinitely thin one.
                  const auto s = trace(c, scene, 256);
                  return within(s.mean.x, s.meanError.x, -std::expm1(-depth) / depth,
                                0.01 * std::min(1.0, 1.0 / depth));
                });
}

/// Reflectance of matter that only scatters straight back, the limit g = -1: light of one direction, there and back.
double rodReflectance(double albedo, double depth) {
  const double k = std::sqrt(1.0 - albedo * albedo), s = std::sinh(k * depth);
  return albedo * s / (k * std::cosh(k * depth) + s);
}

void addPhases(std::vector<StabilityCase>& cases) {
  struct Row {
    double g, albedo, reflectance, transmittance;
  };
  const Row rows[] = {{1e-6, .9, .267410, .591625}, {1e-3, .9, .267168, .591865},
                      {.99, .5, 4.30e-4, .60503},   {.9999, .5, 4.30e-6, std::exp(-.5)},
                      {-.99, .5, .22227, .39539},   {-.9999, .5, rodReflectance(.5, 1.0), NAN}};
  for (const Row& row : rows) {
    addMediaRow(cases, "slab of depth 1, reflectance", fmt::format("g {:g}, albedo {:g}", row.g, row.albedo),
                [row](const StabilityContext& c) {
                  const auto s = trace(c, slabScene(grey(1.0, row.albedo, row.g)), 256);
                  return within(s.mean.x, s.meanError.x, row.reflectance, 0.003);
                });
    if (std::isfinite(row.transmittance))
      addMediaRow(cases, "slab of depth 1, transmittance", fmt::format("g {:g}, albedo {:g}", row.g, row.albedo),
                  [row](const StabilityContext& c) {
                    const auto s = trace(c, slabScene(grey(1.0, row.albedo, row.g)), 256);
                    return within(s.mean.y, s.meanError.y, row.transmittance, 0.003);
                  });
  }
  for (const double g : {.9999, -.9999})
    addMediaRow(cases, "slab of depth 10 that absorbs nothing, both sides", fmt::format("g {:g}", g),
                [g](const StabilityContext& c) {
                  const auto s = trace(c, slabScene(grey(10.0, 1.0, g)), 64);
                  return Measurement{1.0, s.mean.x + s.mean.y, 2e-5};
                });
}

void addSpectra(std::vector<StabilityCase>& cases) {
  // Next to a dense channel, one ten thousand times thinner that only absorbs, and one without effect.
  const auto spectral = [] {
    Scene scene = slabScene(medium({1e-2, 100.0, 0.0}, {0.0, .99, 0.0}));
    scene.environment->picture->at(0, 0) = {0.0f, 1.0f, 0.0f};
    scene.environment->picture->at(0, 1) = {1.0f, 0.0f, 1.0f};
    return scene;
  };
  const char* const names[] = {"absorber of depth 0.01, transmittance", "depth 100, albedo 0.99, reflectance",
                               "no medium in this channel, transmittance"};
  const double exact[] = {std::exp(-1e-2), .752720717, 1.0};
  for (int k = 0; k < 3; ++k)
    addMediaRow(cases, std::string("extinctions 0.01 : 100 : 0, ") + names[k], "ratio 1e4",
                [=](const StabilityContext& c) {
                  const auto s = trace(c, spectral(), 256);
                  return within(s.mean[k], s.meanError[k], exact[k], 0.01);
                });
  for (int k = 0; k < 3; ++k)
    addMediaRow(cases, "extinctions 0.001 : 0.3 : 10, nothing absorbed, radiance",
                fmt::format("ratio 1e4, {}", k == 0   ? "red"
                                             : k == 1 ? "green"
                                                      : "blue"),
                [k](const StabilityContext& c) {
                  const auto s = trace(c, slabScene(medium({1e-3, .3, 10.0}, glm::dvec3(1.0)), {}, true), 256);
                  return within(s.mean[k], s.meanError[k], 1.0, 0.01);
                });
  addMediaRow(cases, "medium of no extinction at all, transmittance", "depth 0", [](const StabilityContext& c) {
    const auto s = trace(c, slabScene(grey(0.0, .5)), 16);
    return Measurement{1.0, s.mean.y, 0.0};
  });
  addMediaRow(cases, "medium next to nothing, transmittance", "depth 1e-30", [](const StabilityContext& c) {
    const auto s = trace(c, slabScene(grey(1e-30, .5)), 16);
    return Measurement{1.0, s.mean.y, 1e-6};
  });
}

void addBoundaries(std::vector<StabilityCase>& cases) {
  const Medium usual = grey(2.0, .9, .75);
  const double reflectance = .097395;
  for (const auto& [name, bsdf, ior] :
       {std::tuple{"none", Bsdf::none, 1.7}, std::tuple{"index 1", Bsdf::dielectric, 1.0},
        std::tuple{"index 1.0001", Bsdf::dielectric, 1.0001}})
    addMediaRow(cases, "matched boundary, reflectance of a slab", name,
                [=, bsdf = bsdf, ior = ior](const StabilityContext& c) {
                  const auto s = trace(c, slabScene(usual, {1.0, glm::dvec3(0.0), bsdf, ior}), 512);
                  return within(s.mean.x, s.meanError.x, reflectance, 0.002);
                });
  for (const double scale : {std::exp2(-20), 1e-3, 1e3, std::exp2(20)})
    addMediaRow(cases, "reflectance of a scaled slab", fmt::format("scale {:g}", scale),
                [=](const StabilityContext& c) {
                  const auto s = trace(c, slabScene(usual, {scale}), 512);
                  return within(s.mean.x, s.meanError.x, reflectance, 0.002);
                });
  for (const double distance : {1e3, 1e4, 1e6})
    addMediaRow(
        cases, "reflectance of a slab far from the origin", fmt::format("{:g} thicknesses", distance),
        [=](const StabilityContext& c) {
          const auto s = trace(c, slabScene(usual, {1.0, glm::dvec3(distance, -0.5 * distance, 0.75 * distance)}), 512);
          return within(s.mean.x, s.meanError.x, reflectance, 0.002);
        });
}

/// Nested boxes: a wall of glass, milk in it that overlaps the glass, and in the milk a crystal that overlaps both and
/// has a lower priority.
Scene nested() {
  SceneParts parts("nested");
  const auto dielectric = [&](double ior, int interior, int priority) {
    const int m = parts.material(glm::vec3(0.0f));
    parts.materialAt(m).bsdf = Bsdf::dielectric;
    parts.materialAt(m).ior = static_cast<float>(ior);
    parts.materialAt(m).interior = interior;
    parts.materialAt(m).priority = priority;
    return m;
  };
  parts.box(glm::dvec3(-1.0), glm::dvec3(1.0), dielectric(1.5, -1, 2));
  parts.box(glm::dvec3(-0.8), glm::dvec3(0.81), dielectric(1.33, 0, 3));
  parts.box({0.3, -0.4, -0.5}, {1.3, 0.6, 0.5}, dielectric(2.0, 1, 1));
  Scene& scene = parts.scene();
  scene.media = {medium({2.0, 9.0, 0.1}, glm::dvec3(1.0), 0.6), grey(5.0, 1.0, -0.5)};
  scene.environment = Environment{glm::vec3(1.0f), {}, 0.0};
  Camera camera;
  camera.position = {0.2, 0.3, 5.0};
  camera.direction = glm::normalize(glm::dvec3(0.0, -0.2, -5.0));
  camera.verticalFov = 0.4;
  scene.cameras = {camera};
  return scene;
}

void addInside(std::vector<StabilityCase>& cases) {
  addMediaRow(cases, "glass, milk and crystal overlapping, nothing absorbed, radiance", "outside",
              [](const StabilityContext& c) {
                const auto s = trace(c, nested(), 128);
                return within(s.mean.y, s.meanError.y, 1.0, 0.01);
              });
  addMediaRow(cases, "the same with the camera in the milk, radiance n^2", "n 1.33", [](const StabilityContext& c) {
    Scene scene = nested();
    scene.cameras[0].position = glm::dvec3(0.1, 0.0, 0.0);
    scene.cameras[0].direction = glm::normalize(glm::dvec3(1.0, 0.2, 0.3));
    const auto s = trace(c, scene, 128);
    const double exact = std::pow(static_cast<double>(1.33f), 2);
    return within(s.mean.y, s.meanError.y, exact, 0.02);
  });
  for (const double depth : {1e-3, 1.0, 100.0})
    addMediaRow(cases, "camera inside of a glowing slab, up: 1 - exp(-depth / 2)",
                fmt::format("optical depth {:g}", depth), [depth](const StabilityContext& c) {
                  Scene scene = slabScene(grey(depth, 0.0));
                  scene.environment.reset();
                  scene.media[0].emission = scene.media[0].absorption;
                  scene.cameras[0].position.y = 0.0;
                  scene.cameras[0].direction.y = 1.0;
                  const auto s = trace(c, scene, 256);
                  return within(s.mean.x, s.meanError.x, -std::expm1(-0.5 * depth), 0.01);
                });
  addMediaRow(cases, "camera inside of what absorbs nothing, all around lit, radiance", "depth 20",
              [](const StabilityContext& c) {
                Scene scene = slabScene(grey(20.0, 1.0, 0.9), {}, true);
                scene.cameras[0].position.y = 0.0;
                const auto s = trace(c, scene, 64);
                return Measurement{1.0, s.mean.y, 2e-5};
              });
  addMediaRow(cases, "camera without a boundary about it: exp(-depth) through an endless medium", "a black wall 2 away",
              [](const StabilityContext& c) {
                SceneParts parts("endless");
                const int wall = parts.material(glm::vec3(0.0f), glm::vec3(1.0f));
                parts.plate({0.013, 0.007, -2.0}, {4, 0, 0}, {0, 4, 0}, wall);
                Scene& scene = parts.scene();
                scene.media = {grey(0.7, 0.0)};
                scene.cameraMedium = 0;
                Camera camera;
                camera.verticalFov = 1e-4;
                scene.cameras = {camera};
                const auto s = trace(c, scene, 256);
                return within(s.mean.x, s.meanError.x, std::exp(-1.4), 0.005);
              });
}

}  // namespace

void addMediaCases(std::vector<StabilityCase>& cases) {
  addDepths(cases);
  addPhases(cases);
  addSpectra(cases);
  addBoundaries(cases);
  addInside(cases);
}

}  // namespace lucerna::demo::bench
