// Stiff and extreme cases of radiosity: walls that absorb almost nothing, patches that nearly touch, tiny and huge
// patches, scale and position. Scenes have no lamps, so that all light comes through form factors and the linear
// system; answers are closed forms, or a solution a million times more accurate.
#include "base/angles.hpp"
#include "base/error.hpp"
#include "bench/stability.hpp"
#include "bench/stability_room.hpp"
#include "radiosity/solution.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace lucerna::demo::bench {

namespace {

constexpr double kSide = 10.0;  ///< a closed room at scale 1

/// Patches of a sixth of a room's side; low-resolution hemicubes suffice for these tests.
RadiositySolutionSettings settingsFor(double longestEdge, double error = 1e-6) {
  RadiositySolutionSettings settings;
  settings.patches.longestEdge = longestEdge;
  settings.wholeTriangles = longestEdge == 0.0;
  settings.hemicubes.resolution = 32;
  settings.error = error;
  return settings;
}

RadiositySolution solve(const StabilityContext& c, const Scene& scene, const RadiositySolutionSettings& settings) {
  return solveScene(c.context, c.programs, scene, settings);
}

void addRadiosityRow(std::vector<StabilityCase>& cases, std::string name, std::string parameter,
                     std::function<Measurement(const StabilityContext&)> run) {
  cases.push_back({"radiosity", std::move(name), std::move(parameter), std::move(run)});
}

/// Area-weighted; channels averaged.
double meanExitance(const RadiositySolution& s) {
  double sum = 0.0, area = 0.0;
  for (std::size_t i = 0; i < s.exitance.size(); ++i) {
    sum += s.mesh.patches[i].area * (s.exitance[i].x + s.exitance[i].y + s.exitance[i].z) / 3.0;
    area += s.mesh.patches[i].area;
  }
  return sum / area;
}

double notFinite(const RadiositySolution& s) {
  double count = 0.0;
  for (const glm::dvec3& b : s.exitance) count += !(std::isfinite(b.x) && std::isfinite(b.y) && std::isfinite(b.z));
  return count;
}

/// Area-weighted irradiance of the patches of a material.
double irradianceOf(const RadiositySolution& s, int material) {
  double sum = 0.0, area = 0.0;
  for (std::size_t i = 0; i < s.irradiance.size(); ++i)
    if (s.mesh.patches[i].material == material)
      sum += s.mesh.patches[i].area * s.irradiance[i].x, area += s.mesh.patches[i].area;
  return sum / area;
}

/// Closed, all walls alike; only the left one emits.
Scene stiffRoom(float albedo) {
  Room room;
  room.closed = true;
  room.albedo = albedo;
  Scene scene = makeRoom(room);
  scene.materials[1].emission = glm::vec3(1.0f);
  return scene;
}

/// max |B - exact| over the mean of B, as the bound is defined.
double trueError(const RadiositySolution& s, const RadiositySolution& exact) {
  double worst = 0.0, mean = 0.0;
  for (std::size_t i = 0; i < s.exitance.size(); ++i) {
    for (int k = 0; k < 3; ++k) worst = std::max(worst, std::abs(s.exitance[i][k] - exact.exitance[i][k]));
    mean += exact.exitance[i].x / static_cast<double>(s.exitance.size());
  }
  return worst / mean;
}

std::string albedoText(float rho) { return fmt::format("albedo {:g}", static_cast<double>(rho)); }

void addStiff(std::vector<StabilityCase>& cases) {
  for (const float rho : {0.0f, 0.5f, 0.9f, 0.99f, 0.999f, 0.9999f})
    addRadiosityRow(cases, "closed furnace, worst exitance over pi / (1 - albedo)", albedoText(rho),
                    [rho](const StabilityContext& c) {
                      Room room;
                      room.closed = true;
                      room.albedo = rho;
                      room.emission = glm::vec3(1.0f);
                      const RadiositySolution s = solve(c, makeRoom(room), settingsFor(kSide / 3.0));
                      const double exact = kPi / (1.0 - static_cast<double>(rho));
                      double worst = 1.0;
                      for (const glm::dvec3& b : s.exitance)
                        for (int k = 0; k < 3; ++k)
                          if (!(std::abs(b[k] / exact - 1.0) <= std::abs(worst - 1.0))) worst = b[k] / exact;
                      return Measurement{1.0, worst, 2e-6};
                    });
  for (const float rho : {0.9f, 0.99f, 0.999f, 0.9999f}) {
    addRadiosityRow(
        cases, "one lit wall: true error over the guaranteed one", albedoText(rho), [rho](const StabilityContext& c) {
          const Scene scene = stiffRoom(rho);
          const RadiositySolution exact = solve(c, scene, settingsFor(kSide / 3.0, 1e-9)),
                                  s = solve(c, scene, settingsFor(kSide / 3.0, 1e-2));
          return Measurement{1.0, s.reached ? trueError(s, exact) / s.progress.errorBound : NAN, 0.0, Rule::atMost};
        });
    addRadiosityRow(cases, "one lit wall: matrix products to 1e-6", albedoText(rho), [rho](const StabilityContext& c) {
      const RadiositySolution s = solve(c, stiffRoom(rho), settingsFor(kSide / 3.0));
      return Measurement{20.0, s.reached ? s.progress.products : NAN, 0.0, Rule::atMost};
    });
    addRadiosityRow(
        cases, "one lit wall: energy that is not accounted for", albedoText(rho), [rho](const StabilityContext& c) {
          return Measurement{0.0, solve(c, stiffRoom(rho), settingsFor(kSide / 3.0)).progress.energyBalance, 2e-5};
        });
  }
  for (const RadiositySolver solver :
       {RadiositySolver::jacobi, RadiositySolver::gaussSeidel, RadiositySolver::progressive, RadiositySolver::anderson,
        RadiositySolver::conjugateGradients})
    addRadiosityRow(
        cases, "true error over the guaranteed one, albedo 0.99", std::string(nameOf(solver)),
        [solver](const StabilityContext& c) {
          RadiositySolutionSettings settings = settingsFor(kSide / 3.0, 1e-2);
          settings.solver = solver;
          const Scene scene = stiffRoom(0.99f);
          const RadiositySolution s = solve(c, scene, settings);
          return Measurement{
              1.0,
              s.reached ? trueError(s, solve(c, scene, settingsFor(kSide / 3.0, 1e-9))) / s.progress.errorBound : NAN,
              0.0, Rule::atMost};
        });
  addRadiosityRow(cases, "channels of albedo 0, 0.5 and 0.9999, furnace", "blue over green",
                  [](const StabilityContext& c) {
                    Room room;
                    room.closed = true;
                    room.emission = glm::vec3(1.0f);
                    Scene scene = makeRoom(room);
                    for (Material& m : scene.materials) m.diffuse = {0.0f, 0.5f, 0.9999f};
                    const RadiositySolution s = solve(c, scene, settingsFor(kSide / 3.0));
                    return Measurement{0.5 / (1.0 - static_cast<double>(0.9999f)),
                                       s.exitance.front().z / s.exitance.front().y, 1e-2};
                  });
}

/// 1 if `scene` is rejected as bad input, 0 if it is solved.
double refused(const StabilityContext& c, const Scene& scene) {
  try {
    solve(c, scene, settingsFor(kSide / 2.0));
  } catch (const Error& error) { return error.kind() == ErrorKind::badInput ? 1.0 : 0.0; }
  return 0.0;
}

void addRefusals(std::vector<StabilityCase>& cases) {
  const auto refuses = [&](const char* parameter, double expected, bool closed, float albedo, float emission) {
    addRadiosityRow(cases, closed ? "closed room refused (1) or solved (0)" : "open room refused (1) or solved (0)",
                    parameter, [=](const StabilityContext& c) {
                      Room room;
                      room.closed = closed;
                      room.albedo = albedo;
                      room.emission = glm::vec3(emission);
                      Scene scene = makeRoom(room);
                      for (Material& m : scene.materials) m.diffuse = glm::vec3(albedo);
                      return Measurement{expected, refused(c, scene), 0.0};
                    });
  };
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  refuses("albedo 1", 1.0, true, 1.0f, 1.0f);
  refuses("albedo 1", 0.0, false, 1.0f, 1.0f);
  refuses("albedo 1.01", 1.0, false, 1.01f, 1.0f);
  refuses("albedo NaN", 1.0, true, kNan, 1.0f);
  refuses("emission -1", 1.0, true, 0.5f, -1.0f);
  refuses("emission NaN", 1.0, true, 0.5f, kNan);
  refuses("nothing shines", 0.0, true, 0.5f, 0.0f);
}

/// Between two squares of side 1 that face each other at distance d [Howell C-11].
double opposedSquares(double d) {
  const double x = 1.0 / d, s = 1.0 + x * x, r = std::sqrt(s);
  return 2.0 / (kPi * x * x) *
         (std::log(s / std::sqrt(1.0 + 2.0 * x * x)) + 2.0 * x * r * std::atan(x / r) - 2.0 * x * std::atan(x));
}

/// Black plates; the first emits an exitance of 1, so the irradiance of the second is its form factor to the first.
struct Plates {
  SceneParts parts{"plates"};
  int light, black;
  Plates()
      : light(parts.material(glm::vec3(0.0f), glm::vec3(static_cast<float>(1.0 / kPi)))),
        black(parts.material(glm::vec3(0.0f))) {}
};

void addNear(std::vector<StabilityCase>& cases) {
  for (const double d : {10.0, 1.0, 0.1, 1e-2, 1e-3, 1e-4})
    addRadiosityRow(
        cases, "squares of side 1 face to face, form factor", fmt::format("distance {:g}", d),
        [d](const StabilityContext& c) {
          Plates p;
          p.parts.plate({0, 0, 0}, {0, 0, 1}, {1, 0, 0}, p.light);
          p.parts.plate({0, d, 0}, {1, 0, 0}, {0, 0, 1}, p.black);
          const double exact = opposedSquares(d);
          RadiositySolutionSettings settings = settingsFor(0.25);
          settings.hemicubes.resolution = 128;  // a patch at distance 10 covers two pixels
          // 32 patches per square, represented by their centres, which costs up to 2 % at the border of anything nearer
          // than their size.
          return Measurement{exact, irradianceOf(solve(c, p.parts.scene(), settings), p.black), 0.02 * exact};
        });
  addRadiosityRow(
      cases, "squares at a right angle with a common edge", "32 patches each", [](const StabilityContext& c) {
        Plates p;
        p.parts.plate({0, 0, 0}, {0, 0, 1}, {1, 0, 0}, p.light);
        p.parts.plate({0, 0.5, -0.5}, {1, 0, 0}, {0, 1, 0}, p.black);
        return Measurement{0.2000438, irradianceOf(solve(c, p.parts.scene(), settingsFor(0.25)), p.black), 0.002};
      });
  // Nothing passes a wall that almost touches. (At 1e-4, which is 2e-5 of the distance to the light, the float depth of
  // hemicubes lets 0.9 % through.)
  for (const double d : {1e-3, 1e-2})
    addRadiosityRow(
        cases, "light behind a wall close to the patch, irradiance", fmt::format("distance {:g}", d),
        [d](const StabilityContext& c) {
          Plates p;
          p.parts.plate({0, 5, 0}, {4, 0, 0}, {0, 0, 4}, p.light);
          p.parts.plate({0, d, 0}, {1, 0, 0}, {0, 0, 1}, p.parts.material(glm::vec3(0.0f)));
          p.parts.plate({0, 0, 0}, {0, 0, 0.9}, {0.9, 0, 0}, p.black);
          return Measurement{0.0, irradianceOf(solve(c, p.parts.scene(), settingsFor(0.25)), p.black), 1e-6};
        });
}

void addSizes(std::vector<StabilityCase>& cases) {
  // Straight above the middle of a tiny probe: s^2 / pi in the limit.
  for (const double s : {0.1, 1e-2, 1e-3, 1e-4})
    addRadiosityRow(
        cases, "tiny light over a tiny patch at distance 1", fmt::format("side {:g}", s),
        [s](const StabilityContext& c) {
          Plates p;
          p.parts.plate({0, 1, 0}, {s, 0, 0}, {0, 0, s}, p.light);
          p.parts.plate({0, 0, 0}, {0, 0, 1e-3}, {1e-3, 0, 0}, p.black);
          p.parts.plate({0, 1.5, 0}, {20, 0, 0}, {0, 0, 20},
                        p.parts.material(glm::vec3(0.0f)));  // a light must be small compared with a room
          const double x = 0.5 * s / std::sqrt(1.0 + 0.25 * s * s),
                       exact = 4.0 / kPi * x * std::atan(x);  // four corners [Howell B-3]
          return Measurement{1.0, irradianceOf(solve(c, p.parts.scene(), settingsFor(0.0)), p.black) / exact, 0.005};
        });
  // All light from a tiny source to a huge floor arrives: received over emitted flux.
  for (const double side : {1e2, 1e4, 1e5})
    addRadiosityRow(cases, "light of side 1 over a huge patch, flux that arrives", fmt::format("side {:g}", side),
                    [side](const StabilityContext& c) {
                      Plates p;
                      p.parts.plate({0, 1, 0}, {1, 0, 0}, {0, 0, 1}, p.light);
                      p.parts.plate({0, 0, 0}, {0, 0, side}, {side, 0, 0}, p.black);
                      return Measurement{
                          1.0, irradianceOf(solve(c, p.parts.scene(), settingsFor(0.0)), p.black) * side * side, 0.01};
                    });
  // The floor of a white furnace cut into strips of 1 : 1000.
  addRadiosityRow(cases, "needles in a closed furnace of albedo 0.9", "1 : 1000", [](const StabilityContext& c) {
    Room room;
    room.closed = true;
    room.albedo = 0.9f;
    room.emission = glm::vec3(1.0f);
    Scene scene = makeRoom(room);
    SceneParts strip("strip");
    strip.scene() = scene;
    strip.plate({0.0, -4.999, 0.0}, {0, 0, 0.01}, {10, 0, 0}, 0);
    const RadiositySolution s = solve(c, strip.scene(), settingsFor(0.0));
    double worst = 1.0;
    for (const glm::dvec3& b : s.exitance)
      if (!(std::abs(b.x * (1.0 - static_cast<double>(0.9f)) / kPi - 1.0) <= std::abs(worst - 1.0)))
        worst = b.x * (1.0 - static_cast<double>(0.9f)) / kPi;
    return Measurement{1.0, worst, 2e-3};
  });
}

void addPlace(std::vector<StabilityCase>& cases) {
  const auto room = [](double scale, const glm::dvec3& place, float emission = 1.0f) {
    Room r;
    r.closed = true;
    r.scale = scale;
    r.place = place;
    Scene scene = makeRoom(r);
    scene.materials[1].emission = glm::vec3(emission);
    return scene;
  };
  const auto mean = [room](const StabilityContext& c, double scale, const glm::dvec3& place, float emission = 1.0f) {
    return meanExitance(solve(c, room(scale, place, emission), settingsFor(kSide * scale / 3.0)));
  };
  for (const double scale : {std::exp2(-20), 1e-3, 1e3, std::exp2(20)})
    addRadiosityRow(cases, "mean of a scaled room, against 1x", fmt::format("scale {:g}", scale),
                    [=](const StabilityContext& c) {
                      return Measurement{1.0, mean(c, scale, glm::dvec3(0.0)) / mean(c, 1.0, glm::dvec3(0.0)),
                                         std::exp2(std::round(std::log2(scale))) == scale ? 1e-6 : 2e-3};
                    });
  for (const double distance : {1e3, 1e4, 1e5})
    addRadiosityRow(cases, "mean of a room far from the origin", fmt::format("{:g} room sides", 0.1 * distance),
                    [=](const StabilityContext& c) {
                      return Measurement{1.0,
                                         mean(c, 1.0, glm::dvec3(distance, -0.5 * distance, 0.7 * distance)) /
                                             mean(c, 1.0, glm::dvec3(0.0)),
                                         5e-3};
                    });
  for (const float emission : {1e-12f, 1e12f})
    addRadiosityRow(cases, "mean over the light's radiance, against 1x",
                    fmt::format("radiance {:g}", static_cast<double>(emission)), [=](const StabilityContext& c) {
                      return Measurement{1.0,
                                         mean(c, 1.0, glm::dvec3(0.0), emission) / static_cast<double>(emission) /
                                             mean(c, 1.0, glm::dvec3(0.0)),
                                         1e-6};
                    });
  addRadiosityRow(cases, "zero-area, needle and doubled triangles: mean", "3 more", [=](const StabilityContext& c) {
    Room bad;
    bad.closed = bad.badTriangles = true;
    Scene scene = makeRoom(bad);
    scene.materials[1].emission = glm::vec3(1.0f);
    return Measurement{1.0, meanExitance(solve(c, scene, settingsFor(kSide / 3.0))) / mean(c, 1.0, glm::dvec3(0.0)),
                       2e-3};
  });
  addRadiosityRow(
      cases, "a corner at infinity and one that is no number: exitances not finite", "2 more",
      [=](const StabilityContext& c) {
        SceneParts parts("bad");
        parts.scene() = room(1.0, glm::dvec3(0.0));
        const glm::dvec3 a(0.0, 0.0, 0.0), b(1.0, 0.0, 0.0);
        parts.triangles({a, b, {0.0, std::numeric_limits<double>::infinity(), 0.0}}, {0, 0, 1}, 0, {0, 1, 2});
        parts.triangles({a, b, {0.0, std::numeric_limits<double>::quiet_NaN(), 0.0}}, {0, 0, 1}, 0, {0, 1, 2});
        parts.scene().bounds = room(1.0, glm::dvec3(0.0)).bounds;
        return Measurement{0.0, notFinite(solve(c, parts.scene(), settingsFor(kSide / 3.0))), 0.0};
      });
}

}  // namespace

void addRadiosityCases(std::vector<StabilityCase>& cases) {
  addStiff(cases);
  addRefusals(cases);
  addNear(cases);
  addSizes(cases);
  addPlace(cases);
}

}  // namespace lucerna::demo::bench
