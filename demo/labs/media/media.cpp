// Lab 8: participating media.
#include "labs/lab.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lucerna::demo::labs {

namespace {

constexpr double kPi = std::numbers::pi;

glm::vec4 four(double x, double y = 0.0, double z = 0.0, double w = 0.0) { return glm::vec4(glm::dvec4(x, y, z, w)); }

double phase(double cosine, double g) {
  return (1.0 - g * g) / (4.0 * kPi * std::pow(1.0 + g * g - 2.0 * g * cosine, 1.5));
}
/// Probability of cosines below `cosine`.
double phaseBelow(double cosine, double g) {
  if (std::abs(g) < 1e-9) return 0.5 * (1.0 + cosine);
  return (1.0 - g * g) / (2.0 * g) * (1.0 / std::sqrt(1.0 + g * g - 2.0 * g * cosine) - 1.0 / (1.0 + g));
}
/// 32 bins of the cosine with equal probability for the right g, and the bin of a cosine.
constexpr int kBins = 32;
double edgeOf(int k, double g) {  // the inversion in double precision
  const double u = static_cast<double>(k) / kBins, s = (1.0 - g * g) / (1.0 - g + 2.0 * g * u);
  return k <= 0 ? -1.0 : k >= kBins ? 1.0 : std::abs(g) < 1e-9 ? 2.0 * u - 1.0 : (1.0 + g * g - s * s) / (2.0 * g);
}
std::vector<double> phaseShares(double g, double (*below)(double, double)) {
  std::vector<double> shares;
  for (int k = 0; k < kBins; ++k) shares.push_back(below(edgeOf(k + 1, g), g) - below(edgeOf(k, g), g));
  return shares;
}

// [vanDeHulst1980, table 35]: optical depth 2, albedo 0.9, g = 0.75, normal incidence.
constexpr double reflected = 0.0973946, passed = 0.6609577;

struct MediaChecks {
  Checks& c;
  const double g = c.yours("g", 0.3, 0.85), scattering = c.yours("scattering", 0.5, 2.0),
               absorption = c.yours("absorption", 0.1, 0.5), depth = c.yours("depth", 0.5, 2.0);
  const double table = c.yours("table", 0.5, 9.0), millilitres = c.yours("millilitres", 15.0, 600.0, 0);
  const double extinction = scattering + absorption;

  // Task 1: henyeyGreenstein: density of a cosine.
  void henyeyGreenstein() {
    const auto of = [](double (*value)(double cosine, double g)) {
      return [=](Point p) { return glm::dvec4(value(p[0].x, p[0].y)); };
    };
    c.againstReference(
        "phase function at points",
        {.probe = 1,
         .draw = [](Random& r, std::span<glm::vec4> p) { p[0] = four(r.uniform(-1, 1), r.uniform(-0.9, 0.9)); },
         .reference = of(phase),
         .mistakes = {{{"g-negated", "g has the wrong sign: positive g scatters forward"},
                       of([](double x, double h) { return phase(x, -h); })},
                      {{"two-pi", "2 pi for 4 pi: the phase function integrates to 1 over the whole sphere"},
                       of([](double x, double h) { return 2.0 * phase(x, h); })},
                      {{"lost-four-pi", "1 / (4 pi) is missing"},
                       of([](double x, double h) { return 4.0 * kPi * phase(x, h); })},
                      {{"power", "the denominator has the power 3/2"}, of([](double x, double h) {
                         return (1.0 - h * h) / (4.0 * kPi * (1.0 + h * h - 2.0 * h * x));
                       })},
                      {{"power", "the denominator has the power 3/2"}, of([](double x, double h) {
                         return (1.0 - h * h) / (4.0 * kPi * std::sqrt(1.0 + h * h - 2.0 * h * x));
                       })},
                      {{"isotropic", "g is ignored"}, of([](double, double) { return 0.25 / kPi; })}}}) &&
        c.mean("its integral over the sphere is 1", {.probe = 2, .inputs = {four(g)}, .expected = 1.0});
  }
  // Task 2: sampleHenyeyGreenstein: cosines with that density.
  void sampleHenyeyGreenstein() {
    const double other = c.fresh(-0.8, -0.2);
    const auto bin = [](double h) {
      return [h](const glm::vec4& v) {
        return v.x < -1.0f - 1e-5f || v.x > 1.0f + 1e-5f
                   ? -1
                   : std::clamp(static_cast<int>(kBins * phaseBelow(std::clamp(double(v.x), -1.0, 1.0), h)), 0,
                                kBins - 1);
      };
    };
    const auto wrongs = [&](double h) {
      return std::vector<ChiSquare::Wrong>{{{"g-negated", "g has the wrong sign: positive g scatters forward"},
                                            phaseShares(h, [](double x, double k) { return phaseBelow(x, -k); })},
                                           {{"isotropic", "the directions do not depend on g"},
                                            phaseShares(h, [](double x, double) { return 0.5 * (1.0 + x); })},
                                           {{"half-g", "g has the wrong effect: the mean cosine must be g"},
                                            phaseShares(h, [](double x, double k) { return phaseBelow(x, 0.5 * k); })},
                                           {{"half-g", "g has the wrong effect: the mean cosine must be g"},
                                            phaseShares(h, [](double x, double k) { return phaseBelow(x, k * k); })}};
    };
    const std::vector<double> even(kBins, 1.0 / kBins);
    c.mean("the mean cosine is g",
           {.probe = 4,
            .inputs = {four(g)},
            .expected = static_cast<float>(g),
            .mistakes = {{{"g-negated", "g has the wrong sign: positive g scatters forward"}, -g},
                         {{"isotropic", "the directions do not depend on g"}, 0.0},
                         {{"half-g", "g has the wrong effect: the mean cosine must be g"}, g * g}}}) &&
        c.chiSquare("cosines, 32 bins",
                    {.probe = 3, .inputs = {four(g)}, .bin = bin(g), .shares = even, .mistakes = wrongs(g)}) &&
        c.chiSquare(
            "backward scattering, 32 bins",
            {.probe = 3, .inputs = {four(other)}, .bin = bin(other), .shares = even, .mistakes = wrongs(other)}) &&
        c.chiSquare("isotropic scattering, 32 bins",
                    {.probe = 3, .inputs = {four(0.0)}, .bin = bin(0.0), .shares = even});
  }
  // Task 3: freeFlight: distance to the next collision.
  void freeFlight() {
    const auto of = [](double (*value)(double u, double s, double a)) {
      return [=](Point p) { return glm::dvec4(value(p[0].z, p[0].x, p[0].y)); };
    };
    const auto bin = [&](const glm::vec4& v) {
      return v.x < 0.0f ? -1 : std::min(kBins - 1, static_cast<int>(kBins * -std::expm1(-extinction * v.x)));
    };
    const auto shares =
        [&](double sigma) {  // bins end where the transmittance for the right extinction is 1 - k / kBins
          std::vector<double> s;
          for (int k = 0; k < kBins; ++k)
            s.push_back(std::pow(1.0 - double(k) / kBins, sigma / extinction) -
                        (k + 1 < kBins ? std::pow(1.0 - (k + 1.0) / kBins, sigma / extinction) : 0.0));
          return s;
        };
    c.chiSquare(
        "distances, 32 bins",
        {.probe = 5,
         .inputs = {four(scattering, absorption)},
         .bin = bin,
         .shares = shares(extinction),
         .mistakes = {{{"absorption-alone", "light collides by scattering and by absorption: extinction is both"},
                       shares(absorption)},
                      {{"scattering-alone", "light collides by scattering and by absorption: extinction is both"},
                       shares(scattering)},
                      {{"extinction-inverted", "the mean distance is 1 / extinction"}, shares(1.0 / extinction)},
                      {{"extinction-lost", "the distance does not depend on the medium"}, shares(1.0)}}}) &&
        c.againstReference(
            "distance falls with extinction",
            {.probe = 6,
             .draw =
                 [](Random& r, std::span<glm::vec4> p) {
                   p[0] = four(r.uniform(0.1, 3), r.uniform(0.1, 3), r.uniform(0.05, 0.95));
                 },
             .reference = of([](double u, double s, double a) { return -std::log1p(-u) / (s + a); }),
             .mistakes = {
                 {{"other-inversion", "log(u) has the right distribution but runs out of [0,1) at u = 0: -log(1 - u)"},
                  of([](double u, double s, double a) { return -std::log(u) / (s + a); })}}});
    Curve curve{"Share of light that travels farther", "distance", "transmittance", {}, {}};
    const std::vector<glm::vec4> flights = c.run(5, std::vector<glm::vec4>{four(scattering, absorption)}, 0, 4096);
    for (double d = 0.125 / extinction; d < 5.0 / extinction; d *= 1.25) {
      const auto further = std::count_if(flights.begin(), flights.end(), [&](const glm::vec4& v) { return v.x > d; });
      curve.mine.emplace_back(d, static_cast<double>(further) / 4096.0);
      curve.reference.emplace_back(d, std::exp(-extinction * d));
    }
    c.curve(curve);
  }
  // Task 4: deltaTracking: collisions in a varying density.
  void deltaTracking() {
    const double base = c.fresh(0.3, 0.8), slope = c.fresh(0.5, 1.5), majorant = base + 2.0 * slope + 0.2;
    const auto depthAt = [=](double t) { return base * t + 0.5 * slope * t * t; };
    // Bins of equal distance over the length 2, and one for flights that pass through.
    const auto shares = [&](const std::function<double(double)>& transmittance) {
      std::vector<double> s;
      for (int k = 0; k < 16; ++k) s.push_back(transmittance(k / 8.0) - transmittance((k + 1) / 8.0));
      s.push_back(transmittance(2.0));
      return s;
    };
    c.chiSquare(
        "collisions in a medium that thickens, 17 bins",
        {.probe = 7,
         .inputs = {four(base, slope, majorant, 2.0)},
         .bin =
             [](const glm::vec4& v) {
               return v.x < 0.0f || v.x > 2.0f ? -1 : v.x >= 2.0f ? 16 : static_cast<int>(8.0f * v.x);
             },
         .shares = shares([&](double t) { return std::exp(-depthAt(t)); }),
         .mistakes = {{{"null-collisions-count",
                        "every candidate counts: accept one only with probability extinction / majorant"},
                       shares([&](double t) { return std::exp(-majorant * t); })},
                      {{"slope-lost", "the initial extinction is used all the way"},
                       shares([&](double t) { return std::exp(-base * t); })},
                      {{"restarts", "after a null collision the flight continues from there; it does not restart"},
                       shares([&](double t) { return 1.0 - t / 2.0; })},
                      {{"accepts-complement", "accepted and null collisions are swapped"},
                       shares([&](double t) { return std::exp(-(majorant * t - depthAt(t))); })}}}) &&
        c.picture("wedge", {.probe = 11,
                            .inputs = {four(scattering * 0.3)},
                            .reference =
                                [&](glm::ivec2 p) {
                                  const double length = 2.0 * (p.x + 0.5) / 96.0, thickens = 2.0 * (p.y + 0.5) / 64.0;
                                  return glm::dvec3(std::exp(-(static_cast<float>(scattering * 0.3) * length +
                                                               0.5 * thickens * length * length)));
                                },
                            .caption = "Light that gets through a wedge of fog: to the right it is longer, to the "
                                       "bottom it thickens faster; 64 flights a pixel, the reference is exact"});
  }
  // Task 5: naturalCoefficient: of the undiluted liquid.
  void naturalCoefficient() {
    const auto of = [](double (*value)(double t, double ml)) {
      return [=](Point p) { return glm::dvec4(value(p[0].x, p[0].y)); };
    };
    c.againstReference(
        "coefficient at points",
        {.probe = 8,
         .draw = [](Random& r, std::span<glm::vec4> p) { p[0] = four(r.uniform(0.01, 10), r.uniform(5, 2000)); },
         .reference = of([](double t, double ml) { return t * 230.0 / ml; }),
         .mistakes = {
             {{"unit", "the tables are in 1e-2 / mm"}, of([](double t, double ml) { return t * 23000.0 / ml; })},
             {{"diluted", "that is the diluted liquid: divide by its share of the tank"},
              of([](double t, double) { return t * 0.01; })},
             {{"inverted", "the natural liquid is denser than the diluted one, not thinner"},
              of([](double t, double ml) { return t * 0.01 * ml / 23000.0; })},
             {{"tank", "the share is liquid / tank: the 23 litres include the liquid"},
              of([](double t, double ml) { return t * 0.01 * (23000.0 + ml) / ml; })}}});
  }
  // Task 6: photons through slabs, using tasks 2 and 3.
  void together() {
    const std::vector<glm::vec4> slab{four(2.0, 0.9, 0.1, 0.75), four(0.0)}, through{slab[0], four(1.0)};
    c.mean("slab: reflectance by van de Hulst's table", {.probe = 9, .inputs = slab, .expected = reflected}) &&
        c.mean("slab: transmittance by van de Hulst's table", {.probe = 9, .inputs = through, .expected = passed}) &&
        c.mean("mean way through your slab without absorption",
               {.probe = 10, .inputs = {four(depth, scattering, 0.0, g)}, .expected = 2.0 * static_cast<float>(depth)});
  }

  void run() {
    // The README's questions, with the results of common mistakes.
    c.answer(
        "transmittance", std::exp(-extinction * depth), 0.005,
        {{{"absorption-alone", "scattering takes light away too: extinction is both"}, std::exp(-absorption * depth)},
         {{"scattering-alone", "absorption takes light away too: extinction is both"}, std::exp(-scattering * depth)}});
    c.answer("free path", 1.0 / extinction, 0.005, {});
    c.answer("coefficient", table * 0.01 * 23000.0 / millilitres, 0.005,
             {{{"diluted", "that is the diluted liquid in the tank"}, table * 0.01}});
    c.answer("way", 2.0 * depth, 0.005,
             {{{"straight", "that is the path straight through; light enters at all angles"}, depth}});
    if (c.task(1)) henyeyGreenstein();
    if (c.task(2)) sampleHenyeyGreenstein();
    if (c.task(3)) freeFlight();
    if (c.task(4)) deltaTracking();
    if (c.task(5)) naturalCoefficient();
    if (c.task(6)) together();
    // Numbers that the README quotes.
    c.figure("transmittance", std::exp(-extinction * depth));
    c.figure("free path", 1.0 / extinction);
    c.figure("coefficient", table * 0.01 * 23000.0 / millilitres);
    c.figure("way", 2.0 * depth);
    c.figure("slab of the table: reflected", reflected, 5);
    c.figure("slab of the table: transmitted", passed, 5);
  }
};

}  // namespace

extern const Lab kMediaLab;
const Lab kMediaLab{8,
                    "media",
                    "Participating media: phase functions, free flights, real liquids",
                    {{1, "henyeyGreenstein", 15, {}},
                     {2, "sampleHenyeyGreenstein", 20, {}},
                     {3, "freeFlight", 15, {}},
                     {4, "deltaTracking", 15, {}},
                     {5, "naturalCoefficient", 5, {}},
                     {6, "together: photons in a slab", 15, {2, 3}}},
                    15,
                    [](Checks& c) { MediaChecks{c}.run(); }};

}  // namespace lucerna::demo::labs
