// Lab 3: spherical harmonics and the cosine lobe.
#include "labs/lab.hpp"

#include <cmath>
#include <numbers>

namespace lucerna::demo::labs {

namespace {

constexpr double kPi = std::numbers::pi;
const double kY0 = 0.5 / std::sqrt(kPi), kY1 = 0.5 * std::sqrt(3.0 / kPi);
const double kLobe0 = 0.5 * std::sqrt(kPi), kLobe1 = std::sqrt(kPi / 3.0);

glm::dvec4 joined(double a, const glm::dvec3& b) { return {a, b.x, b.y, b.z}; }
glm::vec4 inFloat(const glm::dvec4& v) { return glm::vec4(v); }
glm::dvec4 some(Random& r) { return {r.uniform(-1, 1), r.uniform(-1, 1), r.uniform(-1, 1), r.uniform(-1, 1)}; }

struct HarmonicsChecks {
  Checks& c;
  const double base = c.yours("base", 0.8, 2.0), slope = c.yours("slope", 0.3, 0.7),
               tilt = c.yours("tilt", 20.0, 70.0, 0), angle = c.yours("angle", 15.0, 85.0, 0);
  const double cosine = std::cos(tilt * kPi / 180.0);
  const double exact = kPi * base + 2.0 * kPi / 3.0 * slope * cosine, lobe = 0.25 + 0.5 * std::cos(angle * kPi / 180.0);
  const glm::dvec3 axis = glm::normalize(glm::dvec3(c.parameter("ax", -1, 1), c.parameter("ay", -1, 1), 0.8));
  const glm::dvec3 normal = glm::normalize(glm::dvec3(c.parameter("nx", -1, 1), c.parameter("ny", -1, 1), 0.5));
  const glm::dvec4 reference = joined(std::sqrt(4.0 * kPi) * base, std::sqrt(4.0 * kPi / 3.0) * slope * axis);
  const std::vector<glm::vec4> environment{inFloat({axis.x, axis.y, axis.z, slope}),
                                           glm::vec4(static_cast<float>(base), 0, 0, 0)};
  std::vector<glm::vec4> with(glm::dvec4 v) const {
    auto e = environment;
    e.push_back(inFloat(v));
    return e;
  }
  const glm::dvec4 probe{0.5, -0.4, 0.6, 0.7}, other{0.3, 0.8, -0.2, 0.5};

  // Task 1: shBasis: bands 0 and 1.
  void shBasis() {
    const auto of = [](double y0, double y1) { return [=](Point p) { return joined(y0, y1 * glm::dvec3(p[0])); }; };
    c.againstReference(
        "basis at points",
        {.probe = 1,
         .draw = [](Random& r, std::span<glm::vec4> p) { p[0] = inFloat(glm::dvec4(r.direction(), 0.0)); },
         .reference = of(kY0, kY1),
         .mistakes = {{{"lost-normalisation",
                        "the functions are not normalised: the square of each must integrate to 1 over the sphere"},
                       of(1.0, 1.0)},
                      {{"lost-root-three", "band 1 lacks its factor sqrt(3)"}, of(kY0, kY0)},
                      {{"factor-of-band-0", "band 0 is 1 / (2 sqrt(pi)), no other power of pi"}, of(0.25 / kPi, kY1)},
                      {{"signs", "band 1 has the sign of the direction here, no Condon-Shortley phase"}, of(kY0, -kY1)},
                      {{"order", "the order is (Y00, x, y, z), not y, z, x"},
                       [](Point p) { return joined(kY0, kY1 * glm::dvec3(p[0].y, p[0].z, p[0].x)); }},
                      {{"signs", "band 1 has the sign of the direction here, no Condon-Shortley phase"},
                       [](Point p) { return joined(kY0, kY1 * glm::dvec3(-p[0].y, p[0].z, -p[0].x)); }}}}) &&
        c.mean("orthonormal: an integral over the sphere",
               {.probe = 2, .inputs = {inFloat(probe), inFloat(other)}, .expected = glm::dot(probe, other)});
  }
  // Task 2: cosineLobe: the clamped cosine about a normal.
  void cosineLobe() {
    const auto of = [](double l0, double l1) { return [=](Point p) { return joined(l0, l1 * glm::dvec3(p[0])); }; };
    c.againstReference(
        "lobe at points",
        {.probe = 3,
         .draw = [](Random& r, std::span<glm::vec4> p) { p[0] = inFloat(glm::dvec4(r.direction(), 0.0)); },
         .reference = of(kLobe0, kLobe1),
         .mistakes = {{{"delta", "that is a direction, not a lobe: multiply band 0 by pi and band 1 by 2 pi / 3"},
                       of(kY0, kY1)},
                      {{"over-pi", "that is the lobe over pi: it integrates to 1, the cosine to pi"},
                       of(kLobe0 / kPi, kLobe1 / kPi)},
                      {{"band-1-factor", "band 1 is damped by 2 pi / 3, band 0 by pi"}, of(kPi * kY0, kPi * kY1)},
                      {{"unclamped", "that is the cosine without its clamp: below the surface it must be zero"},
                       of(0.0, 2.0 * kLobe1)},
                      {{"signs", "the lobe points away from the normal"}, of(kLobe0, -kLobe1)},
                      {{"band-1-factor", "band 1 is damped by 2 pi / 3, band 0 by pi"}, of(kLobe0, 0.5 * kLobe1)}}}) &&
        c.mean("lobe against the integral over the sphere",
               {.probe = 4, .inputs = {inFloat(glm::dvec4(normal, 0.0)), inFloat(probe)}, .expected = 0.0});
  }
  // Task 3: projectSample: one sample's estimate.
  void projectSample() {
    const auto of = [](double (*weight)(double l, double pdf)) {
      return [=](Point p) { return weight(p[1].x, p[1].y) * joined(kY0, kY1 * glm::dvec3(p[0])); };
    };
    c.againstReference(
        "one sample",
        {.probe = 5,
         .stride = 2,
         .draw =
             [](Random& r, std::span<glm::vec4> p) {
               p[0] = inFloat(glm::dvec4(r.direction(), 0.0)),
               p[1] = glm::vec4(r.uniform(0, 4), r.uniform(0.05, 2), 0, 0);
             },
         .reference = of([](double l, double pdf) { return l / pdf; }),
         .mistakes = {{{"lost-density", "the density is missing: an estimate is value / density"},
                       of([](double l, double) { return l; })},
                      {{"times-density", "divide by the density, do not multiply"},
                       of([](double l, double pdf) { return l * pdf; })},
                      {{"lost-radiance", "the radiance is missing"}, of([](double, double pdf) { return 1.0 / pdf; })},
                      {{"four-pi", "4 pi holds only for the uniform density; pdf may be any density"},
                       of([](double l, double) { return l * 4.0 * kPi; })}}}) &&
        c.mean("an environment's coefficients",
               {.probe = 6, .inputs = with(probe), .expected = glm::dot(reference, probe)});
    Curve curve{"Error of a coefficient against samples", "samples", "standard deviation", {}, {}};
    for (int samples = 1; samples <= 256; samples *= 4) {
      auto inputs = with(probe);
      inputs.push_back(glm::vec4(static_cast<float>(samples)));
      double square = 0.0;
      for (const glm::vec4& v : c.run(11, inputs, 0, 512))
        square += std::pow(v.x - glm::dot(reference, probe), 2.0) / 512.0;
      curve.mine.emplace_back(samples, std::sqrt(square));
      curve.reference.emplace_back(samples, curve.mine.front().y / std::sqrt(samples));
    }
    c.curve(curve);
  }
  // Task 4: irradiance: from the coefficients of radiance.
  void irradiance() {
    const auto of = [](double l0, double l1) {
      return [=](Point p) { return glm::dvec4(glm::dot(glm::dvec4(p[0]), joined(l0, l1 * glm::dvec3(p[1])))); };
    };
    c.againstReference(
        "irradiance at points",
        {.probe = 7,
         .stride = 2,
         .draw =
             [](Random& r, std::span<glm::vec4> p) {
               p[0] = inFloat(some(r)), p[1] = inFloat(glm::dvec4(r.direction(), 0.0));
             },
         .reference = of(kLobe0, kLobe1),
         .mistakes = {{{"lobe-lost",
                        "that is the radiance from n: irradiance is the product's integral, the dot product with "
                        "the cosine's coefficients"},
                       of(kY0, kY1)},
                      {{"over-pi", "irradiance is not divided by pi; that comes with the BRDF"},
                       of(kLobe0 / kPi, kLobe1 / kPi)},
                      {{"band-1-factor", "band 1 is damped by 2 pi / 3, not pi"}, of(kPi * kY0, kPi * kY1)},
                      {{"wrong-side", "the normal points the wrong way"}, of(kLobe0, -kLobe1)},
                      {{"clamped", "keep negative results: a clamp here hides errors and is not linear"},
                       [](Point p) {
                         return glm::dvec4(
                             std::max(0.0, glm::dot(glm::dvec4(p[0]), joined(kLobe0, kLobe1 * glm::dvec3(p[1])))));
                       }}}}) &&
        c.mean("irradiance in an environment, by your projection",
               {.probe = 8,
                .inputs = with(glm::dvec4(normal, 0.0)),
                .expected = kPi * base + 2.0 * kPi / 3.0 * slope * glm::dot(normal, axis)});
  }
  // Task 5: rotateAboutZ: band 1 rotates like a vector.
  void rotateAboutZ() {
    const auto of = [](double sense, int axisOf) {
      return [=](Point p) {
        const double s = sense * std::sin(double(p[1].x)), k = std::cos(double(p[1].x));
        const glm::dvec4 v(p[0]);
        return axisOf == 2   ? glm::dvec4(v.x, k * v.y - s * v.z, s * v.y + k * v.z, v.w)
               : axisOf == 0 ? glm::dvec4(v.x, v.y, k * v.z - s * v.w, s * v.z + k * v.w)
                             : glm::dvec4(k * v.x - s * v.y, s * v.x + k * v.y, v.z, v.w);
      };
    };
    c.againstReference(
        "rotation at points",
        {.probe = 9,
         .stride = 2,
         .draw =
             [](Random& r, std::span<glm::vec4> p) {
               p[0] = inFloat(some(r)), p[1] = glm::vec4(static_cast<float>(r.uniform(-3, 3)), 0, 0, 0);
             },
         .reference = of(1.0, 2),
         .mistakes = {
             {{"wrong-sense", "the rotation has the wrong sense: it should go from x towards y"}, of(-1.0, 2)},
             {{"wrong-axis", "band 1 is a vector (x, y, z) behind band 0: z is the last component"}, of(1.0, 0)},
             {{"band-0-turns", "band 0 is the same in all directions: it does not rotate"}, of(1.0, 1)},
             {{"not-turned", "nothing turns"}, [](Point p) { return glm::dvec4(p[0]); }}}});
  }
  // Task 6: a ball in an environment, using tasks 1 to 4.
  void together() {
    c.picture(
        "ball",
        {.probe = 10,
         .inputs = environment,
         .reference =
             [&](glm::ivec2 p) {
               const double x = (p.x + 0.5 - 48.0) / 30.0, y = -(p.y + 0.5 - 32.0) / 30.0, square = x * x + y * y;
               return square >= 1.0 ? glm::dvec3(0.0)
                                    : glm::dvec3(base + 2.0 / 3.0 * slope *
                                                            glm::dot(axis, glm::dvec3(x, y, std::sqrt(1.0 - square))));
             },
         .caption = "A white ball in an environment of bands 0 and 1, 64 samples a pixel; the reference is exact"});
  }

  void run() {
    // The README's questions, with the results of common mistakes.
    c.answer("irradiance", exact, 0.005,
             {{{"lobe-lost", "that is radiance times pi: band 1 is damped by the cosine, 2 pi / 3 for pi"},
               kPi * (base + slope * cosine)}});
    c.answer("reconstructed", lobe, 0.005,
             {{{"other", "that is the cosine itself: bands 0 and 1 hold an approximation of it"},
               std::cos(angle * kPi / 180.0)}});
    // Relative to the integral of max(0, cos)^2, 2 pi / 3: the sum of the squared coefficients.
    const double share = (kLobe0 * kLobe0 + kLobe1 * kLobe1) / (2.0 * kPi / 3.0);
    c.answer("share", share, 0.005);
    if (c.task(1)) shBasis();
    if (c.task(2)) cosineLobe();
    if (c.task(3)) projectSample();
    if (c.task(4)) irradiance();
    if (c.task(5)) rotateAboutZ();
    if (c.task(6)) together();
    // Numbers that the README quotes.
    c.figure("irradiance", exact);
    c.figure("reconstructed", lobe);
    c.figure("share", share);
    // White reflects irradiance / pi: band 1 of the environment, slope, times 2/3.
    c.figure("brightest less darkest normal", 2.0 * (2.0 / 3.0) * slope);
  }
};

}  // namespace

extern const Lab kHarmonicsLab;
const Lab kHarmonicsLab{3,
                        "harmonics",
                        "Spherical harmonics and the cosine lobe",
                        {{1, "shBasis", 15, {}},
                         {2, "cosineLobe", 20, {}},
                         {3, "projectSample", 15, {1}},
                         {4, "irradiance", 15, {2, 3}},
                         {5, "rotateAboutZ", 10, {}},
                         {6, "together: a ball in an environment", 10, {4}}},
                        15,
                        [](Checks& c) { HarmonicsChecks{c}.run(); }};

}  // namespace lucerna::demo::labs
