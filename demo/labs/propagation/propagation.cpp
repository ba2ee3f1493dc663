// Lab 4: light propagation volumes.
#include "labs/lab.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>

namespace lucerna::demo::labs {

namespace {

constexpr double kPi = std::numbers::pi;
const double kY0 = 0.5 / std::sqrt(kPi), kY1 = 0.5 * std::sqrt(3.0 / kPi), kLobe0 = 0.5 * std::sqrt(kPi),
             kLobe1 = std::sqrt(kPi / 3.0);
const double kFront = 4.0 * std::atan(std::sqrt(11.0) / 33.0),
             kSide = 2.0 * std::atan(3.0 * std::sqrt(11.0) / 11.0) - kPi / 3.0;

glm::vec4 four(const glm::dvec3& v, double w = 0.0) { return glm::vec4(glm::dvec4(v, w)); }
glm::dvec4 joined(double a, const glm::dvec3& b) { return {a, b.x, b.y, b.z}; }
glm::dvec4 some(Random& r) { return {r.uniform(0.2, 1), r.uniform(-1, 1), r.uniform(-1, 1), r.uniform(-1, 1)}; }

/// A propagation step with every common mistake as an option.
struct Kernel {
  double front = kFront, side = kSide, forward = 2.0, overPi = 1.0 / kPi;
  bool clamped = true, sides = true, towardsFace = false;

  double flux(const glm::dvec4& c, const glm::dvec3& w, double solidAngle) const {
    const double value = glm::dot(c, joined(kY0, kY1 * w));
    return (clamped ? std::max(0.0, value) : value) * solidAngle;
  }
  glm::dvec4 light(const glm::dvec3& n, double f) const { return f * overPi * joined(kLobe0, kLobe1 * n); }
  glm::dvec4 step(const glm::dvec4& c, const glm::dvec3& travel, const glm::dvec3& u, const glm::dvec3& v) const {
    glm::dvec4 sum = light(travel, flux(c, travel, front));
    if (!sides) return sum;
    for (const glm::dvec3& s : {u, -u, v, -v}) {
      const glm::dvec3 w = glm::normalize(forward * travel + s);
      sum += light(towardsFace ? w : s, flux(c, w, side));
    }
    return sum;
  }
  double irradiance(const glm::dvec4& c, const glm::dvec3& n, double cell) const {
    const glm::dvec3 u = glm::normalize(glm::cross(n, std::abs(n.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0))),
                     v = glm::cross(n, u);
    double sum = flux(c, -n, front);
    if (sides)
      for (const glm::dvec3& s : {u, -u, v, -v}) sum += flux(c, glm::normalize(-forward * n + s), side);
    return sum / (cell * cell);
  }
};

const std::array<glm::dvec3, 6> kAxes{glm::dvec3{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
/// The share of band 1 that a step preserves if nothing is clamped: the total from six neighbours.
double bandOneKept() {
  const Kernel kernel{.clamped = false};
  glm::dvec4 sum(0.0);
  for (std::size_t k = 0; k < 6; ++k)
    sum += kernel.step(joined(0.0, {0, 0, 1}), kAxes[k], kAxes[(k + 2) % 6], kAxes[(k + 4) % 6]);
  return sum.w;
}

constexpr glm::ivec3 kGrid{12, 8, 8};
std::size_t indexOf(const glm::ivec3& c) { return static_cast<std::size_t>(c.x + kGrid.x * (c.y + kGrid.y * c.z)); }

std::vector<glm::dvec4> stepped(const std::vector<glm::dvec4>& grid) {
  std::vector<glm::dvec4> next(grid.size(), glm::dvec4(0.0));
  for (int z = 0; z < kGrid.z; ++z)
    for (int y = 0; y < kGrid.y; ++y)
      for (int x = 0; x < kGrid.x; ++x)
        for (std::size_t k = 0; k < 6; ++k) {
          const glm::ivec3 from = glm::ivec3(x, y, z) - glm::ivec3(kAxes[k]);
          if (glm::all(glm::greaterThanEqual(from, glm::ivec3(0))) && glm::all(glm::lessThan(from, kGrid)))
            next[indexOf({x, y, z})] +=
                Kernel{}.step(grid[indexOf(from)], kAxes[k], kAxes[(k + 2) % 6], kAxes[(k + 4) % 6]);
        }
  return next;
}

struct PropagationChecks {
  Checks& c;
  const double flux = c.yours("flux", 0.5, 4.0), cell = c.yours("cell", 0.3, 1.2),
               steps = c.yours("steps", 3.0, 9.0, 0);
  const double kept = bandOneKept();

  // Task 1: injectionCell: half a cell off the surface.
  void injectionCell() {
    const auto of = [](double shift, double (*whole)(double)) {
      return [=](Point p) {
        const glm::dvec3 q =
            (glm::dvec3(p[0]) + shift * double(p[2].w) * glm::dvec3(p[1]) - glm::dvec3(p[2])) / double(p[2].w);
        return glm::dvec4(whole(q.x), whole(q.y), whole(q.z), 0.0);
      };
    };
    const auto down = [](double x) { return std::floor(x); };
    c.againstReference(
        "cells of lights",
        {.probe = 1,
         .stride = 3,
         // At least a fiftieth inside the cell, so that rounding decides nothing.
         .draw =
             [](Random& r, std::span<glm::vec4> p) {
               const double s = r.uniform(0.2, 2.0);
               const glm::dvec3 n = r.direction(), least(r.uniform(-5, 5), r.uniform(-5, 5), r.uniform(-5, 5));
               glm::dvec3 q;
               for (int k = 0; k < 3; ++k) q[k] = std::floor(r.uniform(-4, 12)) + r.uniform(0.02, 0.98);
               p[1] = four(n), p[2] = four(least, s), p[0] = four(glm::dvec3(p[2]) + (q - 0.5 * n) * double(p[2].w));
             },
         .reference = of(0.5, down),
         .mistakes = {
             {{"no-half-cell", "the light is not moved half a cell along its normal: it would light its own surface"},
              of(0.0, down)},
             {{"wrong-way", "the light is moved into its surface, not out of it"}, of(-0.5, down)},
             {{"truncation", "int() truncates towards zero: what lies before the grid falls into cell 0; take floor"},
              of(0.5, [](double x) { return std::trunc(x); })},
             {{"whole-cell", "half a cell, not a whole one"}, of(1.0, down)},
             {{"rounded", "a cell begins at its corner: floor, do not round"},
              of(0.5, [](double x) { return std::floor(x + 0.5); })},
             {{"length-for-cell", "half a cell is cell / 2, not 1 / 2"}, [](Point p) {
                const glm::dvec3 q = (glm::dvec3(p[0]) + 0.5 * glm::dvec3(p[1]) - glm::dvec3(p[2])) / double(p[2].w);
                return glm::dvec4(glm::floor(q), 0.0);
              }}}});
  }
  // Task 2: injectedLight: coefficients of the intensity.
  void injectedLight() {
    const auto of = [](double l0, double l1) {
      return [=](Point p) { return double(p[0].w) * joined(l0, l1 * glm::dvec3(p[0])); };
    };
    c.againstReference(
        "injected light",
        {.probe = 2,
         .draw = [](Random& r, std::span<glm::vec4> p) { p[0] = four(r.direction(), r.uniform(0.1, 5)); },
         .reference = of(kLobe0 / kPi, kLobe1 / kPi),
         .mistakes = {
             {{"lost-pi", "1 / pi is missing: the intensity is flux / pi * cos, so that it integrates to the flux"},
              of(kLobe0, kLobe1)},
             {{"four-pi", "flux / (4 pi) is a point in free space; a Lambertian surface has flux / pi * cos"},
              of(0.25 * kLobe0 / kPi, 0.25 * kLobe1 / kPi)},
             {{"delta", "light leaves a surface in a cosine lobe, not in one direction"}, of(kY0, kY1)},
             {{"wrong-side", "the light leaves on the wrong side"}, of(kLobe0 / kPi, -kLobe1 / kPi)},
             {{"isotropic", "the normal is ignored"}, of(kLobe0 / kPi, 0.0)},
             {{"lost-flux", "the flux is missing"},
              [](Point p) { return joined(kLobe0, kLobe1 * glm::dvec3(p[0])) / kPi; }}}});
  }
  // Task 3: fluxInto: through a face.
  void fluxInto() {
    const auto of = [](double sign, bool clamped, bool solid) {
      return [=](Point p) {
        const double value = glm::dot(glm::dvec4(p[0]), joined(kY0, sign * kY1 * glm::dvec3(p[1])));
        return glm::dvec4((clamped ? std::max(0.0, value) : value) * (solid ? double(p[1].w) : 1.0));
      };
    };
    c.againstReference(
        "flux at points",
        {.probe = 3,
         .stride = 2,
         .draw =
             [](Random& r, std::span<glm::vec4> p) {
               p[0] = glm::vec4(some(r)), p[1] = four(r.direction(), r.uniform(0.1, 1.0));
             },
         .reference = of(1.0, true, true),
         .mistakes =
             {{{"no-clamp", "an intensity within two bands may be negative; a flux may not"}, of(1.0, false, true)},
              {{"lost-solid-angle", "the solid angle is missing"}, of(1.0, true, false)},
              {{"wrong-side", "the direction has the wrong sign"}, of(-1.0, true, true)},
              {{"absolute", "a negative intensity counts as zero, not as positive"},
               [](Point p) {
                 return glm::dvec4(std::abs(glm::dot(glm::dvec4(p[0]), joined(kY0, kY1 * glm::dvec3(p[1])))) * p[1].w);
               }},
              {{"lobe-for-direction", "an intensity is evaluated in a direction: shBasis, not cosineLobe"},
               [](Point p) {
                 return glm::dvec4(
                     std::max(0.0, glm::dot(glm::dvec4(p[0]), joined(kLobe0, kLobe1 * glm::dvec3(p[1])))) * p[1].w);
               }}}}) &&
        // 2 pi times the integral of 1/4 + m/2 over the cosines m above -1/2, over pi: 9/8.
        c.mean("the flux that a clamped lobe sends into the whole sphere is 9/8 of the light's",
               {.probe = 8,
                .inputs = {glm::vec4(flux / kPi * joined(kLobe0, kLobe1 * glm::dvec3(0, 1, 0)))},
                .expected = 1.125 * flux,
                .mistakes = {{{"no-clamp", "negative intensities are not clamped"}, flux}}});
  }
  // Task 4: propagated: the light that a cell receives from the neighbour behind it.
  void propagated() {
    const auto of = [](Kernel kernel) {
      return
          [=](Point p) { return kernel.step(glm::dvec4(p[0]), glm::dvec3(p[1]), glm::dvec3(p[2]), glm::dvec3(p[3])); };
    };
    c.againstReference(
        "one neighbour",
        {.probe = 4,
         .stride = 4,
         .draw =
             [](Random& r, std::span<glm::vec4> p) {
               const auto k = static_cast<std::size_t>(r.uniform(0, 6));
               p[0] = glm::vec4(some(r)), p[1] = four(kAxes[k]), p[2] = four(kAxes[(k + 2) % 6]),
               p[3] = four(kAxes[(k + 4) % 6]);
             },
         .reference = of({}),
         .mistakes =
             {{{"side-solid-angle",
                "0.42344 for 0.42343 sr: the wrong constant that several programs copied from each other"},
               of({.side = 0.4234413544})},
              {{"solid-angles-exchanged", "the solid angles of front and sides are swapped"},
               of({.front = kSide, .side = kFront})},
              {{"side-directions",
                "the middle of a side face lies towards 2 travel + side, as seen from the middle of the cell behind"},
               of({.forward = 1.0})},
              {{"side-directions",
                "the middle of a side face lies towards 2 travel + side, as seen from the middle of the cell behind"},
               of({.forward = 0.0})},
              {{"no-clamp", "negative intensities must not send flux"}, of({.clamped = false})},
              {{"front-alone", "the four side faces are missing"}, of({.sides = false})},
              {{"towards-face", "the new light leaves along the face's normal, not along the direction to the face"},
               of({.towardsFace = true})},
              {{"four-pi", "4 pi for pi: three quarters of the light are lost in each step"},
               of({.overPi = 0.25 / kPi})}},
         .tolerance = 5e-6}) &&
        c.againstReference(
            fmt::format("six neighbours: band 0 is kept, band 1 times {:.8g}", kept),
            {.probe = 5,
             .draw =
                 [](Random& r, std::span<glm::vec4> p) {
                   p[0] = glm::vec4(joined(r.uniform(0.8, 1.0), 0.25 * r.direction()));
                 },
             .reference = [this](Point p) { return glm::dvec4(1.0, kept, kept, kept) * glm::dvec4(p[0]); },
             .tolerance = 1e-5});
    // The grid loses direction: band 1 of uniform light, step by step.
    Curve curve{"What is left of band 1 after steps", "steps", "share", {}, {}};
    std::vector<glm::vec4> light{glm::vec4(1.0f, 0.25f, 0.0f, 0.0f)};
    for (int k = 1; k <= 9; ++k) {
      light = c.run(5, light, 1, 1);
      curve.mine.emplace_back(k, std::abs(light[0].y) / 0.25);
      curve.reference.emplace_back(k, std::pow(kept, k));
    }
    c.curve(curve);
  }
  // Task 5: irradianceAt: the light that a surface stops.
  void irradianceAt() {
    const auto of = [](Kernel kernel, double sign, bool area) {
      return [=](Point p) {
        return glm::dvec4(kernel.irradiance(glm::dvec4(p[0]), sign * glm::dvec3(p[1]), area ? double(p[1].w) : 1.0));
      };
    };
    // Nearly uniform light: nothing is clamped, so the frame's rotation about the normal does not matter.
    c.againstReference(
        "irradiance at points",
        {.probe = 6,
         .stride = 2,
         .draw =
             [](Random& r, std::span<glm::vec4> p) {
               p[0] = glm::vec4(joined(r.uniform(0.8, 1.5), 0.3 * r.direction())),
               p[1] = four(r.direction(), r.uniform(0.3, 2.0));
             },
         .reference = of({}, 1.0, true),
         .mistakes = {{{"wrong-side", "light that arrives travels against the normal: -n"}, of({}, -1.0, true)},
                      {{"area-lost", "flux over area: divide by cell * cell"}, of({}, 1.0, false)},
                      {{"front-alone", "the four sides are missing"}, of({.sides = false}, 1.0, true)},
                      {{"cell-once", "a face has the area cell * cell"}, [](Point p) {
                         return glm::dvec4(
                             Kernel{}.irradiance(glm::dvec4(p[0]), glm::dvec3(p[1]), std::sqrt(double(p[1].w))));
                       }}}});
  }
  // Task 6: two lights in a grid, against the reference implementation.
  void together() {
    // Two lights on the floor of a grid, eight steps summed: a slice through them.
    std::vector<glm::dvec4> grid(static_cast<std::size_t>(kGrid.x * kGrid.y * kGrid.z), glm::dvec4(0.0));
    const glm::ivec3 first(static_cast<int>(c.parameter("x1", 1.0, 4.0, 0)), 0, 4),
        second(static_cast<int>(c.parameter("x2", 6.0, 10.0, 0)), 0, 4);
    grid[indexOf(first)] = flux / kPi * joined(kLobe0, kLobe1 * glm::dvec3(0, 1, 0));
    grid[indexOf(second)] = 0.6 * flux / kPi * joined(kLobe0, kLobe1 * glm::normalize(glm::dvec3(-1, 1, 0)));
    std::vector<glm::vec4> mine(grid.begin(), grid.end());
    std::vector<glm::dvec4> sum = grid;
    std::vector<glm::dvec4> mineSum(mine.begin(), mine.end());
    for (int k = 0; k < 8; ++k) {
      grid = stepped(grid);
      mine = c.run(7, mine, 0, static_cast<int>(mine.size()));
      for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += grid[i], mineSum[i] += glm::dvec4(mine[i]);
    }
    const auto value = [&](const std::vector<glm::dvec4>& from, glm::ivec2 p) {
      return from[indexOf({p.x / 8, 7 - p.y / 8, 4})].x;
    };
    std::vector<glm::vec4> pixels;
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 96; ++x)
        pixels.push_back(glm::vec4(glm::vec3(static_cast<float>(value(mineSum, {x, y}))), 0.0f));
    c.picture("slice",
              {.reference = [&](glm::ivec2 p) { return glm::dvec3(value(sum, p)); },
               .caption = "A slice through a grid of 12 by 8 by 8 cells: two lights on the floor after eight steps, "
                          "band 0; the reference is the reference implementation in double precision"},
              pixels);
  }

  void run() {
    // The README's questions, with the results of common mistakes.
    c.answer(
        "injected", flux / (2.0 * std::sqrt(kPi)), 0.005,
        {{{"lost-pi", "1 / pi is missing: a Lambertian surface has the intensity flux / pi * cos"}, flux * kLobe0}});
    c.answer("band 1", std::pow(kept, steps), 0.02, {{{"one-step", "that is one step"}, kept}});
    c.answer("reach", steps * cell, 0.005, {});
    if (c.task(1)) injectionCell();
    if (c.task(2)) injectedLight();
    if (c.task(3)) fluxInto();
    if (c.task(4)) propagated();
    if (c.task(5)) irradianceAt();
    if (c.task(6)) together();
    // Numbers that the README quotes.
    c.figure("injected", flux / (2.0 * std::sqrt(kPi)));
    c.figure("band 1", std::pow(kept, steps));
    c.figure("reach", steps * cell);
    // A newly injected light, flux / pi (1/4 + cos/2), over the directions in which it is not negative (cos > -1/2).
    const double clamped = 2.0 * (0.25 * 1.5 + 0.25 * (1.0 - 0.25));
    c.figure("flux of the clamped lobe", clamped * flux);
    c.figure("the same over the light's own flux", clamped);
    c.figure("solid angle of the front face, sr", kFront, 5);
    c.figure("solid angle of a side face, sr", kSide, 5);
    c.figure("share of band 1 that a step keeps", kept, 8);
  }
};

}  // namespace

extern const Lab kPropagationLab;
const Lab kPropagationLab{4,
                          "propagation",
                          "Light propagation volumes: injection, propagation, energy",
                          {{1, "injectionCell", 15, {}},
                           {2, "injectedLight", 15, {}},
                           {3, "fluxInto", 10, {}},
                           {4, "propagated", 20, {2, 3}},
                           {5, "irradianceAt", 15, {3}},
                           {6, "together: two lights in a grid", 10, {4}}},
                          15,
                          [](Checks& c) { PropagationChecks{c}.run(); }};

}  // namespace lucerna::demo::labs
