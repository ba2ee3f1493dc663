// Lab 2: shadow maps and reflective shadow maps.
#include "labs/lab.hpp"

#include <cmath>
#include <numbers>

namespace lucerna::demo::labs {

namespace {

constexpr double kPi = std::numbers::pi;

glm::vec4 four(double x, double y = 0.0, double z = 0.0, double w = 0.0) { return glm::vec4(glm::dvec4(x, y, z, w)); }
glm::vec4 four(const glm::dvec3& v, double w = 0.0) { return four(v.x, v.y, v.z, w); }

/// Irradiance of the wall from a square of the floor of radiance 1.
double fromFloor(double side, double gap, const glm::dvec3& x) {
  const glm::dvec3 corners[] = {
      {-0.5 * side, 0, gap}, {0.5 * side, 0, gap}, {0.5 * side, 0, gap + side}, {-0.5 * side, 0, gap + side}};
  return polygonIrradiance(corners, x, {0, 0, 1});
}

struct ShadowsChecks {
  Checks& c;
  const double side = c.yours("patch side", 0.8, 1.6), gap = c.yours("patch gap", 0.2, 0.6),
               albedo = c.yours("albedo", 0.4, 0.9), sun = c.yours("sun angle", 20.0, 65.0, 0),
               high = c.yours("point height", 0.4, 1.2);
  const double texel = c.yours("texel", 0.01, 0.1), cosine = std::cos(sun * kPi / 180.0);
  const double light = albedo * cosine / kPi * fromFloor(side, gap, {0.0, high, 0.0});

  // Task 1: slopeBias: the change of depth over half a texel.
  void slopeBias() {
    const auto of = [](double (*value)(double cosine, double texel)) {
      return [=](Point p) {
        const double x = glm::dot(glm::dvec3(p[0]), glm::dvec3(p[1]));
        return glm::dvec4(x > 0.0 ? value(x, p[0].w) : 0.0);
      };
    };
    c.againstReference(
        "bias at points",
        {.probe = 1,
         .stride = 2,
         .draw =
             [](Random& r, std::span<glm::vec4> p) {
               for (double x = 0.0; std::abs(x) < 0.05 || std::abs(x) > 0.99;
                    x = glm::dot(glm::dvec3(p[0]), glm::dvec3(p[1])))
                 p[0] = four(r.direction(), r.uniform(0.01, 0.2)), p[1] = four(r.direction());
             },
         .reference = of([](double x, double t) { return 0.5 * t * std::sqrt(1.0 - x * x) / x; }),
         .mistakes = {
             {{"sine-for-tangent", "depth changes with the tangent of the angle, not with its sine"},
              of([](double x, double t) { return 0.5 * t * std::sqrt(1.0 - x * x); })},
             {{"cosine-for-tangent", "depth changes with the tangent of the angle to the light"},
              of([](double x, double t) { return 0.5 * t * x; })},
             {{"cotangent",
               "the tangent is upside down: a surface that faces the light needs "
               "no bias"},
              of([](double x, double t) { return 0.5 * t * x / std::sqrt(1.0 - x * x); })},
             {{"whole-texel", "half a texel, not a whole one"},
              of([](double x, double t) { return t * std::sqrt(1.0 - x * x) / x; })},
             {{"constant-bias", "the bias does not follow the slope"}, of([](double, double t) { return 0.5 * t; })},
             {{"back-faces", "a surface that faces away needs none"},
              [](Point p) {
                const double x = glm::dot(glm::dvec3(p[0]), glm::dvec3(p[1]));
                return glm::dvec4(0.5 * p[0].w * std::sqrt(1.0 - x * x) / x);
              }},
             {{"back-faces", "a surface that faces away needs none"}, [](Point p) {
                const double x = glm::dot(glm::dvec3(p[0]), glm::dvec3(p[1]));
                return glm::dvec4(0.5 * p[0].w * std::sqrt(1.0 - x * x) / std::abs(x));
              }}}});
  }
  // Task 2: filteredShadow: compared, then filtered.
  void filteredShadow() {
    const auto mixed = [](const glm::dvec4& v, double u, double w) {
      return (v.x * (1 - u) + v.y * u) * (1 - w) + (v.z * (1 - u) + v.w * u) * w;
    };
    const auto of = [=](double biasSign, bool inverted, bool exchanged) {
      return [=](Point p) {
        glm::dvec4 lit;
        for (int k = 0; k < 4; ++k)
          lit[k] = (double(p[1].x) - biasSign * double(p[1].y) <= double(p[0][k])) != inverted ? 1.0 : 0.0;
        return glm::dvec4(exchanged ? mixed(lit, p[1].w, p[1].z) : mixed(lit, p[1].z, p[1].w));
      };
    };
    c.againstReference(
        "shadow at points",
        {.probe = 2,
         .stride = 2,
         // No comparison is decided by rounding, with or without the bias.
         .draw =
             [](Random& r, std::span<glm::vec4> p) {
               bool near = true;
               while (near) {
                 p[1] = four(r.uniform(0.3, 0.7), r.uniform(0.02, 0.15), r.uniform(), r.uniform());
                 p[0] = four(r.uniform(0.2, 0.8), r.uniform(0.2, 0.8), r.uniform(0.2, 0.8), r.uniform(0.2, 0.8));
                 near = false;
                 for (int k = 0; k < 4; ++k)
                   for (const float b : {-1.0f, 0.0f, 1.0f})
                     near = near || std::abs(p[0][k] - p[1].x + b * p[1].y) < 1e-4f;
               }
             },
         .reference = of(1.0, false, false),
         .mistakes = {
             {{"filter-then-compare", "depths must not be averaged: compare first, then filter [Reeves1987]"},
              [=](Point p) {
                return glm::dvec4(double(p[1].x) - double(p[1].y) <= mixed(glm::dvec4(p[0]), p[1].z, p[1].w) ? 1.0
                                                                                                             : 0.0);
              }},
             {{"bias-sign", "the bias has the wrong sign: it moves the surface towards the light"},
              of(-1.0, false, false)},
             {{"bias-lost", "the bias is missing"}, of(0.0, false, false)},
             {{"inverted", "that is the share in shadow: 1 is lit"}, of(1.0, true, false)},
             {{"axes-exchanged", "x and y of f are swapped"}, of(1.0, false, true)},
             {{"nearest", "the four comparisons are not filtered by f"},
              [=](Point p) { return glm::dvec4(double(p[1].x) - double(p[1].y) <= double(p[0].x) ? 1.0 : 0.0); }},
             {{"average", "the four comparisons are averaged; they must be weighted by f"}, [=](Point p) {
                double s = 0;
                for (int k = 0; k < 4; ++k) s += double(p[1].x) - double(p[1].y) <= double(p[0][k]) ? 0.25 : 0.0;
                return glm::dvec4(s);
              }}}});
  }
  // Task 3: texelFlux: the flux that a texel of the map reflects.
  void texelFlux() {
    const auto of = [](double (*value)(double a, double e, double t, double x)) {
      return [=](Point p) { return glm::dvec4(value(p[0].x, p[0].y, p[0].z, p[0].w)); };
    };
    c.againstReference(
        "flux at points",
        {.probe = 3,
         .draw =
             [](Random& r, std::span<glm::vec4> p) {
               p[0] = four(r.uniform(0.1, 1), r.uniform(0.1, 5), r.uniform(0.001, 0.1), r.uniform(0.1, 1));
             },
         .reference = of([](double a, double e, double t, double) { return a * e * t; }),
         .mistakes = {
             {{"double-cosine",
               "the cosine is in the texel's area already: the surface is larger by 1 / cos and lit less by cos"},
              of([](double a, double e, double t, double x) { return a * e * t * x; })},
             {{"divided-cosine", "the surface is larger by 1 / cos, but lit less by cos: neither is left"},
              of([](double a, double e, double t, double x) { return a * e * t / x; })},
             {{"over-pi", "flux is over all directions: 1 / pi belongs to radiance"},
              of([](double a, double e, double t, double) { return a * e * t / kPi; })},
             {{"area-lost", "the texel's area is missing: brightness would follow the map's resolution"},
              of([](double a, double e, double, double) { return a * e; })},
             {{"lost-albedo", "the albedo is missing"},
              of([](double, double e, double t, double) { return e * t; })}}});
  }
  // Task 4: texelLight: light from a texel to a point.
  void texelLight() {
    const auto of = [](double (*value)(double cosP, double cosX, double d)) {
      return [=](Point p) {
        const glm::dvec3 way = glm::dvec3(p[0]) - glm::dvec3(p[2]), w = glm::normalize(way);
        return glm::dvec4(double(p[0].w) *
                          value(glm::dot(glm::dvec3(p[3]), w), -glm::dot(glm::dvec3(p[1]), w), glm::length(way)));
      };
    };
#define PART [](double cp, double cx, double d)
    c.againstReference(
        "light of one texel",
        {.probe = 4,
         .stride = 4,
         .draw =
             [](Random& r, std::span<glm::vec4> p) {
               p[0] = four(r.direction() * r.uniform(1.0, 3.0), r.uniform(0.1, 2)), p[1] = four(r.direction()),
               p[2] = four(r.direction() * 0.4), p[3] = four(r.direction());
             },
         .reference = of(PART { return std::max(0.0, cp) * std::max(0.0, cx) / (kPi * d * d); }),
         .mistakes = {
             {{"lost-pi", "1 / pi is missing: the intensity is flux / pi * cos"},
              of(PART { return std::max(0.0, cp) * std::max(0.0, cx) / (d * d); })},
             {{"power-of-distance",
               "with vectors that are not of length 1 the distance counts to the fourth power: two of it "
               "for the two cosines"},
              of(PART { return std::max(0.0, cp) * std::max(0.0, cx) / kPi + 0.0 * d; })},
             {{"power-of-distance", "the distance counts twice too often: with unit vectors 1 / d^2, without 1 / d^4"},
              of(PART { return std::max(0.0, cp) * std::max(0.0, cx) / (kPi * d * d * d * d); })},
             {{"lost-cosine", "a cosine is missing: one at the texel, one at x"},
              of(PART { return std::max(0.0, cp) / (kPi * d * d) + 0.0 * cx; })},
             {{"lost-cosine", "a cosine is missing: one at the texel, one at x"},
              of(PART { return std::max(0.0, cx) / (kPi * d * d) + 0.0 * cp; })},
             {{"wrong-side", "the wrong side is lit: x is lit where its normal looks towards the texel"},
              of(PART { return std::max(0.0, cp) * std::max(0.0, -cx) / (kPi * d * d); })},
             {{"wrong-side", "the texel's back emits light"},
              of(PART { return std::max(0.0, -cp) * std::max(0.0, cx) / (kPi * d * d); })},
             {{"no-clamp", "two negative cosines make light: clamp each by itself"},
              of(PART { return cp * cx / (kPi * d * d); })},
             {{"no-clamp", "two negative cosines make light: clamp each by itself"},
              of(PART { return std::max(0.0, cp * cx) / (kPi * d * d); })}}});
#undef PART
  }
  // Task 5: discSample: points of a disc.
  void discSample() {
    const auto of = [](double (*weight)(double xi, double r)) {
      return [=](Point p) {
        const double xi = p[0].x, a = 2.0 * kPi * p[0].y, r = p[0].z;
        return glm::dvec4(r * xi * std::cos(a), r * xi * std::sin(a), weight(xi, r), 0.0);
      };
    };
    const double radius = c.fresh(0.5, 1.5);
    c.againstReference(
        "samples of the disc",
        {.probe = 5,
         .draw = [](Random& r, std::span<glm::vec4> p) { p[0] = four(r.uniform(), r.uniform(), r.uniform(0.1, 2)); },
         .reference = of([](double xi, double r) { return 2.0 * kPi * r * r * xi; }),
         .mistakes = {{{"published-weight",
                        "xi^2 is the published weight, which is too small beside the middle: the density of the "
                        "samples falls with 1 / xi alone"},
                       of([](double xi, double r) { return 2.0 * kPi * r * r * xi * xi; })},
                      {{"published-weight",
                        "xi^2 is the published weight, which is too small beside the middle: the density of the "
                        "samples falls with 1 / xi alone"},
                       of([](double xi, double r) { return 3.0 * kPi * r * r * xi * xi; })},
                      {{"weight-lost", "the samples are denser in the middle: the weight must follow the density"},
                       of([](double, double r) { return kPi * r * r; })},
                      {{"density-for-weight", "the weight is one over the density"},
                       of([](double xi, double r) { return 1.0 / (2.0 * kPi * r * r * xi); })},
                      {{"radius-lost", "the weight is an area: radius squared"},
                       of([](double xi, double) { return 2.0 * kPi * xi; })}}}) &&
        c.mean("an integral over the disc", {.probe = 6,
                                             .inputs = {four(radius)},
                                             .expected = kPi * radius * radius + 0.25 * kPi * std::pow(radius, 4.0)});
    // The same integral, of 1 + x^2 over the disc of radius 1: pi + pi / 4.
    Curve curve{"Error of the integral over the disc against samples", "samples", "standard deviation", {}, {}};
    for (int samples = 1; samples <= 256; samples *= 4) {
      double square = 0.0;
      for (const glm::vec4& v : c.run(9, std::vector<glm::vec4>{four(1.0, samples)}, 0, 512))
        square += std::pow(v.x - 1.25 * kPi, 2.0) / 512.0;
      curve.mine.emplace_back(samples, std::sqrt(square));
      // Variance with the weight (1 + x^2), x = u cos: 4 pi^2 (mean of u^2 (1 + u^2 cos^2)^2) minus the squared mean.
      curve.reference.emplace_back(
          samples,
          std::sqrt((4.0 * kPi * kPi * (1.0 / 3.0 + 1.0 / 5.0 + 3.0 / 56.0) - std::pow(1.25 * kPi, 2.0)) / samples));
    }
    c.curve(curve);
  }
  // Task 6: a wall lit by the floor in front of it, using tasks 3 and 4.
  void together() {
    const std::vector<glm::vec4> scene{four(side, gap, albedo, cosine), four(0.0, high)};
    c.mean("light of a floor on a wall", {.probe = 7, .inputs = scene, .expected = light}) &&
        c.picture("wall", {.probe = 8,
                           .inputs = scene,
                           .reference =
                               [&](glm::ivec2 p) {
                                 return glm::dvec3(
                                     albedo * cosine / kPi *
                                     fromFloor(side, gap, {(p.x + 0.5) / 32.0 - 1.5, 2.0 - (p.y + 0.5) / 32.0, 0.0}));
                               },
                           .caption = "A wall lit by a sunlit patch of the floor before it, 64 texels of the map a "
                                      "pixel; the reference is exact"});
  }

  void run() {
    // The README's questions, with the results of common mistakes.
    c.answer("bias", 0.5 * texel * std::tan(sun * kPi / 180.0), 0.005,
             {{{"whole-texel", "half a texel, not a whole one"}, texel * std::tan(sun * kPi / 180.0)}});
    c.answer("flux", albedo * side * side * cosine, 0.005,
             {{{"double-cosine", "the cosine counts once: the patch catches side^2 cos of the sun's light"},
               albedo * side * side * cosine * cosine},
              {{"lost-cosine", "tilted to the sun the patch catches less"}, albedo * side * side}});
    c.answer("light", light, 0.02, {});
    if (c.task(1)) slopeBias();
    if (c.task(2)) filteredShadow();
    if (c.task(3)) texelFlux();
    if (c.task(4)) texelLight();
    if (c.task(5)) discSample();
    if (c.task(6)) together();
    // Numbers that the README quotes.
    c.figure("bias", 0.5 * texel * std::tan(sun * kPi / 180.0));
    c.figure("flux", albedo * side * side * cosine);
    c.figure("light", light);
  }
};

}  // namespace

extern const Lab kShadowsLab;
const Lab kShadowsLab{2,
                      "shadows",
                      "Shadow maps and reflective shadow maps",
                      {{1, "slopeBias", 10, {}},
                       {2, "filteredShadow", 20, {}},
                       {3, "texelFlux", 15, {}},
                       {4, "texelLight", 15, {}},
                       {5, "discSample", 15, {}},
                       {6, "together: a floor lights a wall", 10, {3, 4}}},
                      15,
                      [](Checks& c) { ShadowsChecks{c}.run(); }};

}  // namespace lucerna::demo::labs
