// Lab 5: cascades and their seams.
#include "labs/lab.hpp"

#include <algorithm>
#include <cmath>

namespace lucerna::demo::labs {

namespace {

glm::vec4 four(double x, double y = 0.0, double z = 0.0, double w = 0.0) { return glm::vec4(glm::dvec4(x, y, z, w)); }
glm::vec4 four(const glm::dvec3& v, double w = 0.0) { return four(v.x, v.y, v.z, w); }
double most(const glm::dvec3& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }
/// Uniform in the cube of half side 1.
glm::dvec3 inCube(Random& r) { return {r.uniform(-1, 1), r.uniform(-1, 1), r.uniform(-1, 1)}; }

double lightOf(int k, const glm::dvec3& p) { return 1.0 + 0.3 * k + 0.1 * std::sin(p.x + k); }
double shown(const glm::dvec3& p, double halfExtent, double band) {
  for (int k = 0; k < 3; ++k) {
    const double m = most(p) / (halfExtent * (1 << k));
    if (m > 1.0) continue;
    const double weight = k == 2 ? 1.0 : std::clamp((1.0 - m) / band, 0.0, 1.0);
    return weight * lightOf(k, p) + (1.0 - weight) * lightOf(std::min(k + 1, 2), p);
  }
  return 0.0;
}

struct CascadesChecks {
  Checks& c;
  const double cell = c.yours("cell", 0.2, 1.5), place = c.yours("place", -20.0, -3.0),
               halfExtent = c.yours("half extent", 1.2, 1.5), band = c.yours("band", 0.15, 0.4);
  const double count = c.yours("slices", 3.0, 6.0, 0), near = c.yours("near", 0.1, 0.5),
               far = c.yours("far", 50.0, 200.0, 0), lambda = c.yours("lambda", 0.3, 0.9);
  const double split =
      lambda * near * std::pow(far / near, 1.0 / count) + (1.0 - lambda) * (near + (far - near) / count);
  // The largest of three distances has the density 3 m^2: 1 up to 1 - band, then (1 - m) / band.
  const double full = 1.0 - band, meanWeight = std::pow(full, 3.0) +
                                               (1.0 - std::pow(full, 3.0) - 0.75 * (1.0 - std::pow(full, 4.0))) / band;
  const double cascades = c.yours("cascades", 3.0, 7.0, 0);

  // Task 1: snapped: a cascade moves by whole cells.
  void snapped() {
    const auto of = [](double (*value)(double x, double s)) {
      return
          [=](Point p) { return glm::dvec4(value(p[0].x, p[0].w), value(p[0].y, p[0].w), value(p[0].z, p[0].w), 0.0); };
    };
    c.againstReference(
        "snapped centres",
        {.probe = 1,
         // At least a fiftieth away from a boundary between cells, so that rounding decides nothing.
         .draw =
             [](Random& r, std::span<glm::vec4> p) {
               const double s = r.uniform(0.1, 2.0);
               glm::dvec3 q;
               for (int k = 0; k < 3; ++k) q[k] = (std::floor(r.uniform(-30, 30)) + r.uniform(0.02, 0.98) - 0.5) * s;
               p[0] = four(q, s);
             },
         .reference = of([](double x, double s) { return std::floor(x / s + 0.5) * s; }),
         .mistakes = {{{"truncation",
                        "int() truncates towards zero: left of the origin the grid is a cell off, and jumps as the "
                        "camera crosses it"},
                       of([](double x, double s) { return std::trunc(x / s + 0.5) * s; })},
                      {{"whole-units", "the grid moves in whole cells, not in whole units of the scene"},
                       of([](double x, double) { return std::floor(x + 0.5); })},
                      {{"not-rounded", "the nearest whole number of cells: add half before floor"},
                       of([](double x, double s) { return std::floor(x / s) * s; })},
                      {{"not-snapped", "nothing is snapped"}, of([](double x, double) { return x; })},
                      {{"in-cells", "the result is a position, not a number of cells: multiply by the cell size"},
                       of([](double x, double s) { return std::floor(x / s + 0.5); })}}}) &&
        // A uniform error between -1/2 and 1/2 of a cell has the mean square 1/12.
        c.mean("the mean square of what snapping moves is cell^2 / 12",
               {.probe = 8, .inputs = {four(cell)}, .expected = std::pow(static_cast<float>(cell), 2.0) / 12.0});
  }
  // Task 2: cascadeOf: the finest cascade that holds a point.
  void cascadeOf() {
    const auto of = [](double (*norm)(const glm::dvec3&), double ratio, int outside) {
      return [=](Point p) {
        const double m = norm(glm::dvec3(p[0]) - glm::dvec3(p[1]));
        for (int k = 0; k < static_cast<int>(p[1].w); ++k)
          if (m <= p[0].w * std::pow(ratio, k)) return glm::dvec4(k);
        return glm::dvec4(outside < 0 ? -1.0 : p[1].w - 1.0);
      };
    };
    const auto ofMost = of([](const glm::dvec3& v) { return most(v); }, 2.0, -1);
    c.againstReference(
        "cascades of points",
        {.probe = 2,
         .stride = 2,
         .draw =
             [](Random& r, std::span<glm::vec4> p) {
               const double e = r.uniform(0.5, 2.0), n = std::floor(r.uniform(1, 6));
               p[1] = four(r.direction() * 3.0, n);
               double m = 0.0;
               do {
                 p[0] = four(glm::dvec3(p[1]) + inCube(r) * e * std::exp2(r.uniform(-1.0, n)), e);
                 m = std::log2(most(glm::dvec3(p[0]) - glm::dvec3(p[1])) / e);
               } while (std::abs(m - std::round(m)) < 1e-4);
             },
         .reference = ofMost,
         .mistakes = {
             {{"round-cascades", "the cascades are cubes: the largest of the three distances counts"},
              of([](const glm::dvec3& v) { return glm::length(v); }, 2.0, -1)},
             {{"first-border", "outside of all there is none: -1"},
              of([](const glm::dvec3& v) { return most(v); }, 2.0, 1)},
             {{"not-centred", "distances are from the centre"},
              [](Point p) {
                const double m = most(glm::dvec3(p[0]));
                for (int k = 0; k < static_cast<int>(p[1].w); ++k)
                  if (m <= p[0].w * std::exp2(k)) return glm::dvec4(k);
                return glm::dvec4(-1.0);
              }},
             {{"coarsest", "the finest one that holds the point, not the coarsest"},
              [ofMost](Point p) { return ofMost(p).x < 0.0 ? glm::dvec4(-1.0) : glm::dvec4(p[1].w - 1.0); }},
             {{"one-off", "the first cascade has number 0"},
              [ofMost](Point p) { return ofMost(p).x < 0.0 ? glm::dvec4(-1.0) : ofMost(p) + 1.0; }},
             {{"one-axis", "all three axes count"}, of([](const glm::dvec3& v) { return std::abs(v.x); }, 2.0, -1)}}});
  }
  // Task 3: blendWeight: linear over the outer band.
  void blendWeight() {
    const auto of = [](double (*value)(const glm::dvec3& off, double b)) {
      return [=](Point p) { return glm::dvec4(value((glm::dvec3(p[0]) - glm::dvec3(p[1])) / double(p[0].w), p[1].w)); };
    };
    c.againstReference(
        "weights at points",
        {.probe = 3,
         .stride = 2,
         .draw =
             [](Random& r, std::span<glm::vec4> p) {
               const double e = r.uniform(0.5, 2);
               p[1] = four(r.direction() * 2.0, r.uniform(0.1, 0.6)),
               p[0] = four(glm::dvec3(p[1]) + inCube(r) * 1.2 * e, e);
             },
         .reference = of([](const glm::dvec3& o, double b) { return std::clamp((1.0 - most(o)) / b, 0.0, 1.0); }),
         .mistakes =
             {{{"round-cascades", "a cascade is a cube: the largest of the three distances counts"},
               of([](const glm::dvec3& o, double b) { return std::clamp((1.0 - glm::length(o)) / b, 0.0, 1.0); })},
              {{"hard-edge", "no band: the cascade ends at once, and the seam shows"},
               of([](const glm::dvec3& o, double) { return most(o) <= 1.0 ? 1.0 : 0.0; })},
              {{"inverted", "1 is inside, 0 at the border"},
               of([](const glm::dvec3& o, double b) { return 1.0 - std::clamp((1.0 - most(o)) / b, 0.0, 1.0); })},
              {{"no-clamp", "a weight lies between 0 and 1"},
               of([](const glm::dvec3& o, double b) { return (1.0 - most(o)) / b; })},
              {{"band-outside", "the band lies within the cascade: beyond its border there is no data"},
               of([](const glm::dvec3& o, double b) { return std::clamp(1.0 - (most(o) - 1.0) / b, 0.0, 1.0); })},
              {{"sum-of-axes", "the axes are not multiplied: their largest distance counts"},
               of([](const glm::dvec3& o, double b) {
                 double w = 1.0;
                 for (int k = 0; k < 3; ++k) w *= std::clamp((1.0 - std::abs(o[k])) / b, 0.0, 1.0);
                 return w;
               })}},
         // The position's float rounding, relative to the band.
         .tolerance = 1e-3}) &&
        c.mean("mean weight over the cascade",
               {.probe = 9, .inputs = {four(halfExtent, band)}, .expected = meanWeight});
  }
  // Task 4: blended: flux of cells of two sizes.
  void blended() {
    const auto of = [](double (*value)(double f, double fc, double g, double gc, double w)) {
      return [=](Point p) { return glm::dvec4(value(p[0].x, p[0].y, p[0].z, p[0].w, p[1].x)); };
    };
#define BLEND [](double f, double fc, double g, double gc, double w)
    c.againstReference(
        "blends", {.probe = 4,
                   .stride = 2,
                   .draw =
                       [](Random& r, std::span<glm::vec4> p) {
                         const double s = r.uniform(0.2, 1.5);
                         p[0] = four(r.uniform(0.1, 3), s, r.uniform(0.1, 3), s * r.uniform(1.5, 3.0)),
                         p[1] = four(r.uniform());
                       },
                   .reference = of(BLEND { return w * f / (fc * fc) + (1 - w) * g / (gc * gc); }),
                   .mistakes = {{{"sum-of-cascades", "both cascades hold the same light: their sum counts it twice"},
                                 of(BLEND { return f / (fc * fc) + g / (gc * gc) + 0.0 * w; })},
                                {{"weights-exchanged", "the weight is that of the fine cascade"},
                                 of(BLEND { return (1 - w) * f / (fc * fc) + w * g / (gc * gc); })},
                                {{"cells-ignored", "flux per cell is no irradiance: each over its own cell's face"},
                                 of(BLEND { return w * f + (1 - w) * g + 0.0 * (fc + gc); })},
                                {{"one-cell-for-both", "each cascade has cells of its own"},
                                 of(BLEND { return (w * f + (1 - w) * g) / (fc * fc) + 0.0 * gc; })},
                                {{"cell-once", "a face has the area cell * cell"},
                                 of(BLEND { return w * f / fc + (1 - w) * g / gc; })},
                                {{"volume-for-area", "a face has the area cell * cell, not a cell's volume"},
                                 of(BLEND { return w * f / (fc * fc * fc) + (1 - w) * g / (gc * gc * gc); })},
                                {{"weight-once", "the weights of both must sum to 1"},
                                 of(BLEND { return w * f / (fc * fc) + g / (gc * gc); })}}});
#undef BLEND
  }
  // Task 5: splitDistance: between logarithmic and even splits.
  void splitDistance() {
    const auto of = [](double (*value)(double t, double n, double f, double l)) {
      return [=](Point p) { return glm::dvec4(value((p[0].x + 1.0) / p[0].y, p[0].z, p[0].w, p[1].x)); };
    };
    c.againstReference(
        "split distances",
        {.probe = 5,
         .stride = 2,
         .draw =
             [](Random& r, std::span<glm::vec4> p) {
               const double n = std::floor(r.uniform(1, 8));
               p[0] = four(std::floor(r.uniform(0, n)), n, r.uniform(0.05, 1), r.uniform(10, 500)),
               p[1] = four(r.uniform());
             },
         .reference = of([](double t, double n, double f, double l) {
           return l * n * std::pow(f / n, t) + (1 - l) * (n + (f - n) * t);
         }),
         .mistakes = {{{"schemes-exchanged", "lambda belongs to the logarithmic scheme"},
                       of([](double t, double n, double f, double l) {
                         return (1 - l) * n * std::pow(f / n, t) + l * (n + (f - n) * t);
                       })},
                      {{"near-ends", "that is the near end of the slice: the far end of slice i is i + 1 slices away"},
                       [](Point p) {
                         const double t = p[0].x / p[0].y, n = p[0].z, f = p[0].w, l = p[1].x;
                         return glm::dvec4(l * n * std::pow(f / n, t) + (1 - l) * (n + (f - n) * t));
                       }},
                      {{"uniform-alone", "lambda is ignored: that is the uniform scheme"},
                       of([](double t, double n, double f, double) { return n + (f - n) * t; })},
                      {{"logarithmic-alone", "lambda is ignored: that is the logarithmic scheme"},
                       of([](double t, double n, double f, double) { return n * std::pow(f / n, t); })},
                      {{"near-forgotten", "the view begins at near, not at 0"},
                       of([](double t, double n, double f, double l) {
                         return l * n * std::pow(f / n, t) + (1 - l) * f * t;
                       })}},
         .tolerance = 3e-4});
    Curve curve{"Far ends of your slices", "slice", "distance", {}, {}};
    std::vector<glm::vec4> slices;
    for (int k = 0; k < static_cast<int>(count); ++k)
      slices.push_back(four(k, count, near, far)), slices.push_back(four(lambda));
    const std::vector<glm::vec4> ends = c.run(5, slices, 2, static_cast<int>(count));
    for (int k = 0; k < static_cast<int>(count); ++k) {
      curve.mine.emplace_back(k + 1, ends[static_cast<std::size_t>(k)].x);
      const double share = (k + 1) / count;
      curve.reference.emplace_back(
          k + 1, lambda * near * std::pow(far / near, share) + (1.0 - lambda) * (near + (far - near) * share));
    }
    c.curve(curve);
  }
  // Task 6: three cascades around a point, by tasks 2 to 4.
  void together() {
    c.againstReference("both sides of a border agree",
                       {.probe = 6,
                        .stride = 2,
                        .draw =
                            [](Random& r, std::span<glm::vec4> p) {
                              // A point on the border of cascade 0 or 1.
                              const double e = r.uniform(1.0, 2.0);
                              glm::dvec3 q = inCube(r);
                              q[static_cast<int>(r.uniform(0, 3))] = r.uniform() < 0.5 ? -1.0 : 1.0;
                              p[0] = four(q * e * (r.uniform() < 0.5 ? 1.0 : 2.0), e),
                              p[1] = four(r.uniform(0.1, 0.5), r.uniform(0.1, 1.0));
                            },
                        .reference =
                            [](Point p) {
                              const glm::dvec3 q(p[0]);
                              return glm::dvec4(shown(q * 0.9999, p[0].w, p[1].x), shown(q * 1.0001, p[0].w, p[1].x),
                                                0.0, 0.0);
                            }}) &&
        c.picture(
            "seams",
            {.probe = 7,
             .inputs = {four(halfExtent, band, cell)},
             .reference =
                 [&](glm::ivec2 p) {
                   return glm::dvec3(shown({(p.x + 0.5 - 48.0) / 10.0, (p.y + 0.5 - 32.0) / 10.0, 0.3},
                                           static_cast<float>(halfExtent), static_cast<float>(band)));
                 },
             .caption =
                 "Three cascades, each a little brighter than the one within, blended by your "
                 "functions: no line may show; the reference is the reference implementation in double precision"});
  }

  void run() {
    // The README's questions, with the results of common mistakes.
    c.answer("snapped", std::floor(place / cell + 0.5) * cell, 0.0005,
             {{{"truncation", "int() truncates towards zero; below zero that is the wrong cell"},
               std::trunc(place / cell + 0.5) * cell}});
    c.answer("split", split, 0.005,
             {{{"schemes-exchanged", "lambda belongs to the logarithmic scheme"},
               (1.0 - lambda) * near * std::pow(far / near, 1.0 / count) + lambda * (near + (far - near) / count)}});
    c.answer("saving", std::pow(8.0, cascades - 1.0) / cascades, 0.005, {});
    if (c.task(1)) snapped();
    if (c.task(2)) cascadeOf();
    if (c.task(3)) blendWeight();
    if (c.task(4)) blended();
    if (c.task(5)) splitDistance();
    if (c.task(6)) together();
    // Numbers that the README quotes.
    c.figure("snapped", std::floor(place / cell + 0.5) * cell);
    c.figure("split", split);
    c.figure("mean weight", meanWeight);
    c.figure("saving", std::pow(8.0, cascades - 1.0) / cascades);
  }
};

}  // namespace

extern const Lab kCascadesLab;
const Lab kCascadesLab{5,
                       "cascades",
                       "Cascades and their seams",
                       {{1, "snapped", 15, {}},
                        {2, "cascadeOf", 15, {}},
                        {3, "blendWeight", 15, {}},
                        {4, "blended", 20, {}},
                        {5, "splitDistance", 10, {}},
                        {6, "together: three cascades without a seam", 10, {2, 3, 4}}},
                       15,
                       [](Checks& c) { CascadesChecks{c}.run(); }};

}  // namespace lucerna::demo::labs
