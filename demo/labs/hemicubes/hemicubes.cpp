// Lab 6: hemicubes: delta form factors, Jacobi sweeps and a reliable stopping criterion.
#include "labs/lab.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace lucerna::demo::labs {

namespace {

constexpr double kPi = std::numbers::pi;

glm::vec4 four(double x, double y = 0.0, double z = 0.0, double w = 0.0) { return glm::vec4(glm::dvec4(x, y, z, w)); }
glm::vec4 four(const glm::dvec3& v) { return four(v.x, v.y, v.z); }

/// Emission, reflectance and rows of form factors that sum to 1: an enclosure. `most`: the largest reflectance.
void enclosure(const std::function<double()>& uniform, double most, std::span<glm::vec4> p) {
  p[0] = four(uniform() * 2.0, uniform(), uniform() * 0.5);
  p[1] = four(most, most * uniform(), most * uniform());
  for (std::size_t i = 2; i < 5; ++i) {
    const glm::dvec3 row = glm::dvec3(uniform(), uniform(), uniform()) + 0.1;
    p[i] = four(row / (row.x + row.y + row.z));
  }
}
using Rows = std::array<glm::dvec3, 3>;
Rows rowsOf(Point p) { return {glm::dvec3(p[2]), glm::dvec3(p[3]), glm::dvec3(p[4])}; }
glm::dvec3 swept(Point p, const glm::dvec3& radiosity) {
  const Rows rows = rowsOf(p);
  return glm::dvec3(p[0]) + glm::dvec3(p[1]) * glm::dvec3(glm::dot(rows[0], radiosity), glm::dot(rows[1], radiosity),
                                                          glm::dot(rows[2], radiosity));
}
glm::dvec3 solved(Point p) {
  glm::dvec3 radiosity(0.0);
  for (int k = 0; k < 5000; ++k) radiosity = swept(p, radiosity);
  return radiosity;
}

/// The form factor of the square overhead with the published map: each direction's true share times the ratio of both
/// maps' weights, which is r^2 of the hemicube's pixel up to a constant.
double publishedFactor(double side, double height, double away) {
  constexpr int kSteps = 512;
  const auto midpoint = [](int k) { return (k + 0.5) / kSteps; };
  double all = 0.0, square = 0.0;
  for (int i = 0; i < kSteps; ++i)
    for (int j = 0; j < kSteps; ++j) {
      // All pixels: a quarter of the top, half of a side.
      const double x = midpoint(i), y = midpoint(j), r2 = x * x + y * y + 1.0;
      all += (4.0 + 8.0 * y) / r2 / (kSteps * kSteps);
      const double dx = away + side * (x - 0.5), dy = side * (y - 0.5), d2 = dx * dx + dy * dy + height * height,
                   axis = std::max({std::abs(dx), std::abs(dy), height});
      square += height * height / (d2 * d2) * d2 / (axis * axis) * side * side / (kSteps * kSteps);
    }
  return square / all;
}

glm::dvec3 directionOf(int face, double x, double y) {
  switch (face) {
    case 0: return glm::normalize(glm::dvec3(x - 1.0, y - 1.0, 1.0));
    case 1: return glm::normalize(glm::dvec3(1.0, x - 1.0, y));
    case 2: return glm::normalize(glm::dvec3(-1.0, x - 1.0, y));
    case 3: return glm::normalize(glm::dvec3(x - 1.0, 1.0, y));
    default: return glm::normalize(glm::dvec3(x - 1.0, -1.0, y));
  }
}

struct HemicubesChecks {
  Checks& c;
  const double side = c.yours("square side", 0.6, 1.6), height = c.yours("square height", 0.7, 1.5),
               away = c.yours("square away", 0.0, 1.0);
  const double x = c.yours("pixel x", 0.1, 0.95), y = c.yours("pixel y", 0.1, 0.95),
               reflectance = c.yours("reflectance", 0.6, 0.95), change = c.yours("change", 0.001, 0.01, 4);
  const double factor = squareLampIrradiance(side, height, {away, 0.0, 0.0}) / kPi;

  // Task 1: deltaTop: form factor of a small area of the top.
  void deltaTop() {
    const auto of = [](double (*value)(double square)) {
      return
          [=](Point p) { return glm::dvec4(p[0].z * value(double(p[0].x) * p[0].x + double(p[0].y) * p[0].y + 1.0)); };
    };
    c.againstReference(
        "top at points",
        {.probe = 1,
         .draw = [](Random& r,
                    std::span<glm::vec4> p) { p[0] = four(r.uniform(-1, 1), r.uniform(-1, 1), r.uniform(0.01, 4.0)); },
         .reference = of([](double q) { return 1.0 / (kPi * q * q); }),
         .mistakes = {{{"published-map", "that is the published map, 1 / r^2: two cosines over r^2 make 1 / r^4"},
                       of([](double q) { return 1.0 / q; })},
                      {{"published-map", "that is the published map, 1 / r^2: two cosines over r^2 make 1 / r^4"},
                       of([](double q) { return 1.0 / (kPi * q); })},
                      {{"lost-pi", "1 / pi is missing: the factors of all pixels sum to 1"},
                       of([](double q) { return 1.0 / (q * q); })},
                      {{"one-cosine", "that is the solid angle over pi: the cosine at the patch is missing"},
                       of([](double q) { return 1.0 / (kPi * q * std::sqrt(q)); })},
                      {{"area-lost", "the area is missing"}, [](Point p) {
                         const double q = double(p[0].x) * p[0].x + double(p[0].y) * p[0].y + 1.0;
                         return glm::dvec4(1.0 / (kPi * q * q));
                       }}}});
  }
  // Task 2: deltaSide: of a small area of a side.
  void deltaSide() {
    const auto of = [](double (*value)(double z, double square)) {
      return [=](Point p) {
        return glm::dvec4(p[0].z * value(p[0].y, double(p[0].x) * p[0].x + double(p[0].y) * p[0].y + 1.0));
      };
    };
    c.againstReference(
        "side at points",
        {.probe = 2,
         .draw = [](Random& r,
                    std::span<glm::vec4> p) { p[0] = four(r.uniform(-1, 1), r.uniform(0, 1), r.uniform(0.01, 4.0)); },
         .reference = of([](double z, double q) { return z / (kPi * q * q); }),
         .mistakes = {{{"published-map",
                        "that is the published map, z / r^2: the cosine at the side's pixel is missing, and one r^2"},
                       of([](double z, double q) { return z / q; })},
                      {{"published-map",
                        "that is the published map, z / r^2: the cosine at the side's pixel is missing, and one r^2"},
                       of([](double z, double q) { return z / (kPi * q); })},
                      {{"lost-cosine", "the cosine at the patch, z / r, is missing"},
                       of([](double, double q) { return 1.0 / (kPi * q * q); })},
                      {{"lost-pi", "1 / pi is missing: the factors of all pixels sum to 1"},
                       of([](double z, double q) { return z / (q * q); })},
                      {{"wrong-height", "z is the height above the patch, y runs along the side"}, [](Point p) {
                         const double q = double(p[0].x) * p[0].x + double(p[0].y) * p[0].y + 1.0;
                         return glm::dvec4(p[0].z * p[0].x / (kPi * q * q));
                       }}}});
  }
  // Task 3: pixelDirection: every face, every pixel.
  void pixelDirection() {
    const auto of = [](double shift, bool halfHeight, bool unit) {
      return [=](Point p) {
        const double n = p[0].w, u = 2.0 * (p[0].y + shift) / n,
                     v = (p[0].x > 0.5f && halfHeight ? 1.0 : 2.0) * (p[0].z + shift) / n;
        const glm::dvec3 d = directionOf(static_cast<int>(p[0].x), u, v);
        return glm::dvec4(unit ? d : d / std::max({std::abs(d.x), std::abs(d.y), p[0].x > 0.5f ? 0.0 : std::abs(d.z)}),
                          0.0);
      };
    };
    c.againstReference(
        "directions of pixels",
        {.probe = 4,
         .draw =
             [](Random& r, std::span<glm::vec4> p) {
               const double n = 4.0 * std::floor(r.uniform(2, 40)), face = std::floor(r.uniform(0, 5));
               p[0] = four(face, std::floor(r.uniform(0, n)), std::floor(r.uniform(0, face > 0.5 ? n / 2.0 : n)), n);
             },
         .reference = of(0.5, false, true),
         .mistakes = {
             {{"pixel-centre-missed", "that is a pixel's corner: its centre is half a pixel further"},
              of(0.0, false, true)},
             {{"not-unit", "the direction is not of length 1"}, of(0.5, false, false)},
             {{"side-height", "a side has n by n / 2 pixels of the same size as the top's"}, of(0.5, true, true)},
             {{"faces-exchanged", "faces are swapped: 1 is +x, 2 is -x, 3 is +y, 4 is -y"}, [](Point p) {
                const double n = p[0].w;
                const int f = static_cast<int>(p[0].x);
                return glm::dvec4(directionOf(f == 1   ? 2
                                              : f == 2 ? 1
                                                       : f,
                                              2.0 * (p[0].y + 0.5) / n, 2.0 * (p[0].z + 0.5) / n),
                                  0.0);
              }}}});
  }
  // Task 6, before tasks 4 and 5: form factors on the whole hemicube, by tasks 1 and 2.
  void together() {
    c.mean("all pixels sum to 1", {.probe = 3, .expected = 1.0}) &&
        c.mean("form factor of a square", {.probe = 5, .inputs = {four(side, height, away)}, .expected = factor}) &&
        c.picture("square", {.probe = 10,
                             .inputs = {four(side, height)},
                             .reference =
                                 [&](glm::ivec2 p) {
                                   return glm::dvec3(
                                       squareLampIrradiance(side, height,
                                                            {(p.x + 0.5) / 16.0 - 3.0, 0.0, (p.y + 0.5) / 16.0 - 2.0}) /
                                       kPi);
                                 },
                             .caption = "Form factor from each point of the floor to a square above it: 256 random "
                                        "points of the hemicube a pixel; the reference is exact"});
  }
  // Task 4: sweep: one Jacobi sweep.
  void sweep() {
    const auto of = [](const std::function<glm::dvec3(Point, glm::dvec3)>& value) {
      return [=](Point p) { return glm::dvec4(value(p, glm::dvec3(p[5])), 0.0); };
    };
    const auto draw = [](Random& r, std::span<glm::vec4> p) {
      enclosure([&] { return r.uniform(); }, r.uniform(0.3, 0.9), p);
      p[5] = four(r.uniform(0, 3), r.uniform(0, 3), r.uniform(0, 3));
    };
    c.againstReference(
        "one sweep",
        {.probe = 6,
         .stride = 6,
         .draw = draw,
         .reference = of(swept),
         .mistakes =
             {{{"transposed", "rows and columns are swapped: gathering takes F from i to j, F[3 i + j]"},
               of([](Point p, glm::dvec3 b) {
                 const Rows f = rowsOf(p);
                 return glm::dvec3(p[0]) + glm::dvec3(p[1]) * (f[0] * b.x + f[1] * b.y + f[2] * b.z);
               })},
              {{"lost-emission", "the emission is missing"},
               of([](Point p, glm::dvec3 b) { return swept(p, b) - glm::dvec3(p[0]); })},
              {{"lost-reflectance", "the reflectance is missing: all light would be reflected"},
               of([](Point p, glm::dvec3 b) {
                 return glm::dvec3(p[0]) + (swept(p, b) - glm::dvec3(p[0])) / glm::dvec3(p[1]);
               })},
              {{"wrong-reflectance",
                "the reflectance is that of the patch that gathers, i, not of the one that is seen"},
               of([](Point p, glm::dvec3 b) {
                 const Rows f = rowsOf(p);
                 const glm::dvec3 rb = glm::dvec3(p[1]) * b;
                 return glm::dvec3(p[0]) + glm::dvec3(glm::dot(f[0], rb), glm::dot(f[1], rb), glm::dot(f[2], rb));
               })},
              {{"gauss-seidel",
                "that is a Gauss-Seidel sweep, which uses new values at once; a Jacobi sweep uses only the old ones"},
               of([](Point p, glm::dvec3 b) {
                 for (int i = 0; i < 3; ++i) b[i] = swept(p, b)[i];
                 return b;
               })},
              {{"radiosity-lost", "the given radiosity is not used"},
               of([](Point p, glm::dvec3) { return swept(p, glm::dvec3(p[0])); })},
              {{"radiosity-lost", "the given radiosity is not used"}, of([](Point p, glm::dvec3) {
                 glm::dvec3 b(p[0]);
                 for (int i = 0; i < 3; ++i) b[i] = swept(p, b)[i];
                 return b;
               })},
              {{"adds-up", "the new radiosity replaces the old, it is not added"},
               of([](Point p, glm::dvec3 b) { return b + swept(p, b) - glm::dvec3(p[0]); })}}}) &&
        c.againstReference("two hundred sweeps: the solution",
                           {.probe = 7,
                            .stride = 6,
                            .draw = draw,
                            .reference = [](Point p) { return glm::dvec4(solved(p), 0.0); },
                            .points = 256});
    // One enclosure derived from the seed: error against sweeps.
    std::vector<glm::vec4> box(7);
    int drawn = 0;
    enclosure([&] { return c.parameter("enclosure " + std::to_string(++drawn), 0.0, 1.0); }, reflectance,
              std::span(box).first(5));
    const glm::dvec3 reference = solved(box);
    Curve curve{
        "Error against sweeps; dashed: the largest radiosity times reflectance to the power of the sweep; at "
        "1e-7 single precision ends",
        "sweep",
        "largest error of a patch",
        {},
        {}};
    for (int sweeps = 1; sweeps <= 64; sweeps *= 2) {
      box[6] = four(sweeps);
      const glm::dvec3 off = glm::abs(glm::dvec3(c.run(11, box, 0, 1)[0]) - reference);
      curve.mine.emplace_back(sweeps, std::max({off.x, off.y, off.z}));
      curve.reference.emplace_back(sweeps,
                                   std::max({reference.x, reference.y, reference.z}) * std::pow(reflectance, sweeps));
    }
    c.curve(curve);
  }
  // Task 5: errorBound: distance from the solution.
  void errorBound() {
    const auto of = [](double (*value)(double change, double r)) {
      return [=](Point p) { return glm::dvec4(value(p[0].x, p[0].y)); };
    };
    c.againstReference(
        "bound at points",
        {.probe = 8,
         .draw = [](Random& r, std::span<glm::vec4> p) { p[0] = four(r.uniform(0.0, 0.1), r.uniform(0.1, 0.97)); },
         .reference = of([](double d, double r) { return d * r / (1.0 - r); }),
         .mistakes = {{{"change-is-no-error", "the last change is not the error: the changes to come add up"},
                       of([](double d, double) { return d; })},
                      {{"one-sweep-late",
                        "that bounds the error before the sweep; the sweep itself is done: times the reflectance"},
                       of([](double d, double r) { return d / (1.0 - r); })},
                      {{"next-change-alone", "that is the next change alone: all that follow count"},
                       of([](double d, double r) { return d * r; })},
                      {{"inverted", "the bound grows with the reflectance"},
                       of([](double d, double r) { return d * (1.0 - r) / r; })}}}) &&
        c.againstReference("the reference lies within your bound", {.probe = 9,
                                                                    .stride = 6,
                                                                    .draw =
                                                                        [](Random& r, std::span<glm::vec4> p) {
                                                                          enclosure([&] { return r.uniform(); },
                                                                                    r.uniform(0.3, 0.95), p);
                                                                          p[5] = four(solved(p));
                                                                        },
                                                                    .reference = [](Point) { return glm::dvec4(1.0); },
                                                                    .points = 256});
  }

  void run() {
    // The README's questions, with the results of common mistakes.
    c.answer("form factor", factor, 0.02, {});
    c.answer("published", 1.0 + x * x + y * y, 0.005,
             {{{"upside-down", "the published map weighs this pixel too much, not too little"},
               1.0 / (1.0 + x * x + y * y)}});
    c.answer("bound", change * reflectance / (1.0 - reflectance), 0.005,
             {{{"change-is-no-error", "the last change is not the error: the changes to come add up"}, change}});
    if (c.task(1)) deltaTop();
    if (c.task(2)) deltaSide();
    if (c.task(3)) pixelDirection();
    if (c.task(6)) together();
    if (c.task(4)) sweep();
    if (c.task(5)) errorBound();
    // Numbers that the README quotes.
    c.figure("form factor", factor);
    c.figure("the same by the published map", publishedFactor(side, height, away), 4);
    c.figure("published", 1.0 + x * x + y * y);
    c.figure("bound", change * reflectance / (1.0 - reflectance));
  }
};

}  // namespace

extern const Lab kHemicubesLab;
const Lab kHemicubesLab{6,
                        "hemicubes",
                        "Hemicubes: delta form factors, sweeps and an honest stop",
                        {{1, "deltaTop", 15, {}},
                         {2, "deltaSide", 15, {}},
                         {3, "pixelDirection", 15, {}},
                         {4, "sweep", 15, {}},
                         {5, "errorBound", 15, {4}},
                         {6, "together: form factors of a square", 10, {1, 2}}},
                        15,
                        [](Checks& c) { HemicubesChecks{c}.run(); }};

}  // namespace lucerna::demo::labs
