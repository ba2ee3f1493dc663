// Lab 1: the rendering equation and the furnace.
#include "labs/lab.hpp"

#include <cmath>
#include <numbers>

namespace lucerna::demo::labs {

namespace {

constexpr double kPi = std::numbers::pi;

glm::dvec3 three(const glm::vec4& v) { return glm::dvec3(v); }
glm::vec4 withW(const glm::dvec3& v, double w = 0.0) { return glm::vec4(glm::vec3(v), static_cast<float>(w)); }

struct FurnaceChecks {
  Checks& c;
  const double albedo = c.yours("albedo", 0.3, 0.9), emission = c.yours("emission", 0.5, 2.0);
  const double side = c.yours("lamp side", 0.5, 1.5), height = c.yours("lamp height", 0.8, 1.6),
               away = c.yours("lamp away", 0.2, 1.0);
  const double furnace = emission / (1.0 - albedo), irradiance = squareLampIrradiance(side, height, {away, 0.0, 0.0});
  const int bounces = static_cast<int>(std::ceil(std::log(0.01) / std::log(albedo) - 1.0));

  const Mistake lostPi{"lost-pi",
                       "1 / pi is missing: Lambert's BRDF is albedo / pi, and the cosine's density cos / pi"};
  const Mistake lostCosine{"lost-cosine", "the cosine to the normal is missing"};
  const Mistake noClamp{"no-clamp", "light from behind the surface counts as negative: use max(0, cos)"};
  const Mistake absolute{
      "absolute-cosine",
      "light from behind the surface counts like light from the front: use max(0, cos), not abs(cos)"};

  // Task 1: reflected: the integrand for a Lambertian surface.
  void reflected() {
    const auto formula = [&](double constant, double (*cosine)(double)) {
      return [=](Point p) {
        return glm::dvec4(constant * three(p[0]) * three(p[3]) * cosine(glm::dot(three(p[1]), three(p[2]))), 0.0);
      };
    };
    const auto clamped = [](double x) { return std::max(0.0, x); };
    const glm::dvec3 n = glm::normalize(glm::dvec3(c.parameter("nx", -1.0, 1.0), 0.7, c.parameter("nz", -1.0, 1.0)));
    c.againstReference(
        "reflected light at points",
        {.probe = 1,
         .stride = 4,
         .draw =
             [](Random& r, std::span<glm::vec4> p) {
               p[0] = withW({r.uniform(), r.uniform(), r.uniform()}), p[1] = withW(r.direction()),
               p[2] = withW(r.direction()), p[3] = withW({r.uniform(0, 5), r.uniform(0, 5), r.uniform(0, 5)});
             },
         .reference = formula(1.0 / kPi, clamped),
         .mistakes = {{lostPi, formula(1.0, clamped)},
                      {lostCosine, formula(1.0 / kPi, [](double) { return 1.0; })},
                      {noClamp, formula(1.0 / kPi, [](double x) { return x; })},
                      {absolute, formula(1.0 / kPi, [](double x) { return std::abs(x); })},
                      {{"pi-squared",
                        "1 / pi is applied twice, or 1 / (2 pi) is "
                        "used for 1 / pi"},
                       formula(0.5 / kPi, clamped)},
                      {{"lost-albedo", "the albedo is missing"},
                       [=](Point p) {
                         return glm::dvec4(three(p[3]) / kPi * std::max(0.0, glm::dot(three(p[1]), three(p[2]))), 0.0);
                       }},
                      {{"cosine-squared", "the cosine counts twice"},
                       formula(1.0 / kPi, [](double x) { return x > 0.0 ? x * x : 0.0; })}}}) &&
        c.mean("furnace: radiance 1 all around gives the albedo",
               {.probe = 2, .inputs = {withW(n, albedo)}, .expected = albedo});
    Curve curve{"Error of the furnace estimate against samples",
                "samples a pixel",
                "standard deviation of the estimate",
                {},
                {}};
    for (int samples = 1; samples <= 256; samples *= 4) {
      const std::vector<glm::vec4> inputs{withW(n, albedo), glm::vec4(static_cast<float>(samples))};
      double square = 0.0;
      for (const glm::vec4& v : c.run(11, inputs, 0, 512)) square += (v.x - albedo) * (v.x - albedo) / 512.0;
      curve.mine.emplace_back(samples, std::sqrt(square));
      // Variance of 4 albedo max(0, cos) over the sphere: 16 a^2 / 6 - a^2.
      curve.reference.emplace_back(samples, albedo * std::sqrt((16.0 / 6.0 - 1.0) / samples));
    }
    c.curve(curve);
  }
  // Task 2: sampleCosine: directions distributed as the cosine.
  void sampleCosine() {
    constexpr int kRings = 8, kSectors = 16;
    const glm::dvec3 n = glm::normalize(glm::dvec3(c.parameter("sx", -1.0, 1.0), c.parameter("sy", -1.0, 1.0), -0.6));
    // Rings of equal probability: cos^2 is uniform.
    const auto shares = [](double (*belowCosine)(double)) {
      std::vector<double> s;
      for (int ring = 0; ring < kRings; ++ring)
        for (int sector = 0; sector < kSectors; ++sector)
          s.push_back((belowCosine(std::sqrt((ring + 1.0) / kRings)) - belowCosine(std::sqrt(double(ring) / kRings))) /
                      kSectors);
      return s;
    };
    std::vector<double> nowhere(kRings * kSectors, 0.0);
    nowhere.push_back(1.0);
    std::vector<double> half = shares([](double m) { return 0.5 * m; });
    half.push_back(0.5);
    c.chiSquare("directions, 128 bins",
                {.probe = 3,
                 .inputs = {withW(n)},
                 .bin =
                     [](const glm::vec4& v) {
                       if (v.x < -1e-5f || std::abs(v.w - 1.0f) > 1e-4f) return -1;
                       const int ring = std::min(kRings - 1, static_cast<int>(std::max(0.0f, v.x) * v.x * kRings));
                       const double turn = std::atan2(v.z, v.y) / (2.0 * kPi) + 0.5;
                       return ring * kSectors + std::min(kSectors - 1, static_cast<int>(turn * kSectors));
                     },
                 .shares = shares([](double m) { return m * m; }),
                 .mistakes = {
                     {{"uniform-hemisphere",
                       "the directions are uniform over the hemisphere: the height must be the square root of a "
                       "uniform number"},
                      shares([](double m) { return m; })},
                     {{"uniform-angle",
                       "the angle to the normal is uniform: solid angle has a sine, and the distribution a cosine"},
                      shares([](double m) { return 1.0 - std::acos(m) / (0.5 * kPi); })},
                     {{"uniform-sphere", "the directions cover the whole sphere"}, half},
                     {{"outside", "directions lie below the surface or are not of length 1"}, nowhere},
                     {{"cosine-cubed",
                       "the directions crowd about the normal: the height is the square root of 1 - u, no other power"},
                      shares([](double m) { return m * m * m * m; })}}});
  }
  // Task 3: pdfCosine: their density.
  void pdfCosine() {
    const glm::dvec3 n = glm::normalize(glm::dvec3(0.3, c.parameter("py", -1.0, 1.0), c.parameter("pz", -1.0, 1.0)));
    const auto of = [](double (*value)(double)) {
      return [=](Point p) { return glm::dvec4(value(glm::dot(three(p[0]), three(p[1])))); };
    };
    c.againstReference(
        "density at points",
        {.probe = 4,
         .stride = 2,
         .draw = [](Random& r, std::span<glm::vec4> p) { p[0] = withW(r.direction()), p[1] = withW(r.direction()); },
         .reference = of([](double x) { return std::max(0.0, x) / kPi; }),
         .mistakes = {{lostPi, of([](double x) { return std::max(0.0, x); })},
                      {noClamp, of([](double x) { return x / kPi; })},
                      {absolute, of([](double x) { return std::abs(x) / kPi; })},
                      {{"uniform-density", "that is the density of uniform directions, 1 / (2 pi)"},
                       of([](double x) { return x > 0.0 ? 0.5 / kPi : 0.0; })},
                      {{"uniform-density", "that is the density of uniform directions, 1 / (2 pi)"},
                       of([](double) { return 0.5 / kPi; })}}}) &&
        c.mean("the density's integral over the sphere is 1", {.probe = 5, .inputs = {withW(n)}, .expected = 1.0}) &&
        c.mean("furnace by your directions: no noise", {.probe = 6, .inputs = {withW(n, albedo)}, .expected = albedo});
  }
  // Task 4: solidAngleOfArea: from area to solid angle.
  void solidAngleOfArea() {
    const auto of = [](double (*value)(double cosine, double distance)) {
      return [=](Point p) {
        const glm::dvec3 way = three(p[0]) - three(p[1]);
        return glm::dvec4(value(glm::dot(three(p[2]), glm::normalize(way)), glm::length(way)));
      };
    };
    c.againstReference(
        "solid angle of a unit of area, at points",
        {.probe = 7,
         .stride = 3,
         .draw =
             [](Random& r, std::span<glm::vec4> p) {
               p[0] = withW(r.direction() * r.uniform(1.0, 4.0)), p[1] = withW(r.direction() * r.uniform(0.0, 0.8)),
               p[2] = withW(r.direction());
             },
         .reference = of([](double x, double d) { return std::max(0.0, x) / (d * d); }),
         .mistakes = {
             {lostCosine, of([](double, double d) { return 1.0 / (d * d); })},
             {{"distance-not-squared", "the distance counts once: 1 / d^2, and the cosine needs vectors of length 1"},
              of([](double x, double d) { return std::max(0.0, x) / d; })},
             {{"wrong-side", "the lamp's back emits light: the cosine is taken along the way from x to y"},
              of([](double x, double d) { return std::max(0.0, -x) / (d * d); })},
             {noClamp, of([](double x, double d) { return x / (d * d); })},
             {absolute, of([](double x, double d) { return std::abs(x) / (d * d); })},
             {{"vector-not-unit", "the cosine needs a vector of length 1"},
              of([](double x, double d) { return std::max(0.0, x) * d / (d * d * d * d); })},
             {{"not-over-area", "the distance is missing"}, of([](double x, double) { return std::max(0.0, x); })}}});
  }
  // Task 5: furnace: radiance after a number of bounces.
  void furnaceRadiance() {
    const auto of = [](double (*value)(double e, double a, int n)) {
      return [=](Point p) { return glm::dvec4(value(p[0].x, p[0].y, static_cast<int>(p[0].z))); };
    };
    c.againstReference(
        "radiance after n bounces",
        {.probe = 9,
         .draw =
             [](Random& r, std::span<glm::vec4> p) {
               p[0] = withW({r.uniform(0.1, 3.0), r.uniform(0.0, 0.99), std::floor(r.uniform(0.0, 30.0))});
             },
         .reference = of([](double e, double a, int n) { return e * (1.0 - std::pow(a, n + 1)) / (1.0 - a); }),
         .mistakes = {{{"infinite-sum", "that is the sum over all bounces"},
                       of([](double e, double a, int) { return e / (1.0 - a); })},
                      {{"one-too-few", "one bounce is missing: light that was never reflected counts as bounce 0"},
                       of([](double e, double a, int n) { return e * (1.0 - std::pow(a, n)) / (1.0 - a); })},
                      {{"one-too-many", "one bounce too many"},
                       of([](double e, double a, int n) { return e * (1.0 - std::pow(a, n + 2)) / (1.0 - a); })},
                      {{"lost-emission", "the walls' own emission is missing: they are seen directly too"},
                       of([](double e, double a, int n) { return e * (1.0 - std::pow(a, n + 1)) / (1.0 - a) - e; })},
                      {{"last-bounce-alone", "that is the light of the last bounce alone: sum over all of them"},
                       of([](double e, double a, int n) { return e * std::pow(a, n); })}}});
  }
  // Task 6: a floor under a square lamp, using tasks 1 and 4.
  void together() {
    const std::vector<glm::vec4> lamp{withW({side, height, albedo}), withW({away, 0.0, 0.0})};
    c.mean("light of a square lamp at a point", {.probe = 8, .inputs = lamp, .expected = albedo / kPi * irradiance}) &&
        c.picture("lamp", {.probe = 10,
                           .inputs = lamp,
                           .reference =
                               [&](glm::ivec2 p) {
                                 return glm::dvec3(
                                     albedo / kPi *
                                     squareLampIrradiance(side, height,
                                                          {(p.x + 0.5) / 16.0 - 3.0, 0.0, (p.y + 0.5) / 16.0 - 2.0}));
                               },
                           .caption = "The floor under a square lamp, from above: your two functions, 64 points of the "
                                      "lamp a pixel; the reference is Lambert's formula for polygons"});
  }

  void run() {
    // The README's questions, with the results of common mistakes.
    c.answer("furnace", furnace, 0.005,
             {{{"lost-emission", "that is only the reflected part: the walls' own emission is seen too"},
               furnace - emission},
              {{"albedo-sum", "the parts form a geometric series: 1 / (1 - albedo)"}, emission * (1.0 + albedo)}});
    c.answer("irradiance", irradiance, 0.02,
             {{{"lost-cosine", "a cosine is missing: there are two, one at the floor and one at the lamp"},
               side * side * height / std::pow(away * away + height * height, 1.5)}});
    c.answer("bounces", bounces, 0.0, {});
    if (c.task(1)) reflected();
    if (c.task(2)) sampleCosine();
    if (c.task(3)) pdfCosine();
    if (c.task(4)) solidAngleOfArea();
    if (c.task(5)) furnaceRadiance();
    if (c.task(6)) together();
    // Numbers that the README quotes.
    c.figure("furnace", furnace);
    c.figure("irradiance", irradiance);
    c.figure("bounces", bounces);
    // For 4 albedo max(0, cos) over the sphere, see the curve of task 1; 64 samples in each of 4096 invocations.
    c.figure("deviation of one sample, over the albedo", std::sqrt(16.0 / 6.0 - 1.0));
    c.figure("standard error of the check, % of the albedo", 100.0 * std::sqrt((16.0 / 6.0 - 1.0) / (64.0 * 4096.0)));
  }
};

}  // namespace

extern const Lab kFurnaceLab;
const Lab kFurnaceLab{1,
                      "furnace",
                      "The rendering equation and the furnace",
                      {{1, "reflected", 15, {}},
                       {2, "sampleCosine", 20, {}},
                       {3, "pdfCosine", 15, {1, 2}},
                       {4, "solidAngleOfArea", 15, {}},
                       {5, "furnace", 10, {}},
                       {6, "together: the floor under a lamp", 10, {1, 4}}},
                      15,
                      [](Checks& c) { FurnaceChecks{c}.run(); }};

}  // namespace lucerna::demo::labs
