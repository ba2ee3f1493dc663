// Lab 7: path tracing: estimators, multiple importance sampling, roulette, error.
#include "base/clock.hpp"
#include "labs/lab.hpp"

#include <cmath>
#include <numbers>

namespace lucerna::demo::labs {

namespace {

constexpr double kPi = std::numbers::pi;

glm::vec4 four(double x, double y = 0.0, double z = 0.0, double w = 0.0) { return glm::vec4(glm::dvec4(x, y, z, w)); }
glm::vec4 four(const glm::dvec3& v, double w = 0.0) { return four(v.x, v.y, v.z, w); }

struct PathsChecks {
  Checks& c;
  const double albedo = c.yours("albedo", 0.4, 0.8), emission = c.yours("emission", 0.5, 2.0),
               survival = c.yours("survival", 0.82, 0.9);
  const double side = c.yours("lamp side", 0.8, 1.4), height = c.yours("lamp height", 0.3, 0.6),
               away = c.yours("lamp away", 0.2, 0.9);
  const double error = c.yours("error at 64", 0.01, 0.05), wanted = c.yours("error wanted", 0.001, 0.004, 4);
  const double light = albedo / kPi * squareLampIrradiance(side, height, {away, 0.0, 0.0});

  // Task 1: misWeight: the balance heuristic.
  void misWeight() {
    const auto of = [](double (*value)(double a, double b)) {
      return [=](Point p) { return glm::dvec4(value(p[0].x, p[0].y)); };
    };
    const Mistake swapped{"swapped", "the weights are swapped: a strategy counts where its own density is greater"};
    c.againstReference(
        "weight at points",
        {.probe = 1,
         .draw =
             [](Random& r, std::span<glm::vec4> p) {
               p[0] = four(r.uniform(0.0, 3.0), r.uniform(0.0, 3.0));
               if (r.uniform() < 0.05) p[0] = four(0.0, 0.0);
             },
         .reference = of([](double a, double b) { return a > 0.0 ? a / (a + b) : 0.0; }),
         .mistakes = {{{"double-counting", "both strategies have full weight: light is counted twice"},
                       of([](double, double) { return 1.0; })},
                      {{"double-counting", "both strategies have full weight: light is counted twice"},
                       of([](double a, double) { return a > 0.0 ? 1.0 : 0.0; })},
                      {swapped, of([](double a, double b) { return b > 0.0 ? b / (a + b) : 0.0; })},
                      {{"half",
                        "half each is unbiased, but keeps the noise of the worse strategy: weight by the densities"},
                       of([](double, double) { return 0.5; })},
                      {{"power-heuristic", "that is the power heuristic; the task asks for the balance heuristic"},
                       of([](double a, double b) { return a > 0.0 ? a * a / (a * a + b * b) : 0.0; })},
                      {{"maximum", "that is the maximum heuristic; the task asks for the balance heuristic"},
                       of([](double a, double b) { return a > b ? 1.0 : 0.0; })}}}) &&
        c.mean("the two weights make one", {.probe = 2, .expected = 1.0});
  }
  // Task 2: lampSample: next-event estimation.
  void lampSample() {
    const auto of = [](double (*value)(double l, double a, double cosX, double cosY, double d, double pdf)) {
      return [=](Point p) {
        const glm::dvec3 way = glm::dvec3(p[1]) - glm::dvec3(p[0]), w = glm::normalize(way);
        return glm::dvec4(
            value(p[3].x, p[3].y, std::max(0.0, w.z), -glm::dot(glm::dvec3(p[2]), w), glm::length(way), p[3].z));
      };
    };
#define LIGHT [](double l, double a, double cx, double cy, double d, double pdf)
    c.againstReference("lamp's part at points",
                       {.probe = 3,
                        .stride = 4,
                        .draw =
                            [](Random& r, std::span<glm::vec4> p) {
                              p[0] = four(r.direction() * 0.5), p[1] = four(r.direction() * r.uniform(1.0, 4.0)),
                              p[2] = four(r.direction()),
                              p[3] = four(r.uniform(0.1, 5.0), r.uniform(0.05, 1.0), r.uniform(0.1, 3.0));
                            },
                        .reference = of(LIGHT { return l * a / kPi * cx * std::max(0.0, cy) / (d * d) / pdf; }),
                        .mistakes = {{{"lost-pi", "1 / pi of Lambert's BRDF is missing"},
                                      of(LIGHT { return l * a * cx * std::max(0.0, cy) / (d * d) / pdf; })},
                                     {{"no-area-to-solid-angle",
                                       "the lamp's cosine and 1 / d^2 are lost: an area is not a solid angle"},
                                      of(LIGHT { return l * a / kPi * cx / pdf + 0.0 * (cy + d); })},
                                     {{"lost-lamp-cosine", "the cosine at the lamp is missing"},
                                      of(LIGHT { return l * a / kPi * cx / (d * d) / pdf + 0.0 * cy; })},
                                     {{"lost-cosine", "the cosine at x is missing"},
                                      of(LIGHT { return l * a / kPi * std::max(0.0, cy) / (d * d) / pdf + 0.0 * cx; })},
                                     {{"distance-not-squared", "the distance must be squared"},
                                      of(LIGHT { return l * a / kPi * cx * std::max(0.0, cy) / d / pdf; })},
                                     {{"lost-density", "the density is missing: value / density"},
                                      of(LIGHT { return l * a / kPi * cx * std::max(0.0, cy) / (d * d) + 0.0 * pdf; })},
                                     {{"wrong-side", "the lamp's back emits light: its cosine has the wrong sign"},
                                      of(LIGHT { return l * a / kPi * cx * std::max(0.0, -cy) / (d * d) / pdf; })},
                                     {{"no-clamp", "the lamp's back gives negative light"},
                                      of(LIGHT { return l * a / kPi * cx * cy / (d * d) / pdf; })}}}) &&
        c.mean("light of a square lamp",
               {.probe = 4, .inputs = {four(side, height, albedo), four(away)}, .expected = light});
#undef LIGHT
  }
  // Task 3: roulette: survivors represent the terminated paths.
  void roulette() {
    const auto of = [](bool exchanged, double (*after)(double t, double s)) {
      return [=](Point p) {
        return (p[0].z < p[0].y) != exchanged ? glm::dvec4(1.0, after(p[0].x, p[0].y), 0.0, 0.0) : glm::dvec4(0.0);
      };
    };
    c.againstReference(
        "roulette at points",
        {.probe = 6,
         .draw =
             [](Random& r, std::span<glm::vec4> p) {
               do p[0] = four(r.uniform(0.1, 2.0), r.uniform(0.05, 0.95), r.uniform());
               while (std::abs(p[0].y - p[0].z) < 1e-3f);
             },
         .reference = of(false, [](double t, double s) { return t / s; }),
         .mistakes =
             {{{"roulette-undivided", "survivors are not divided by the probability of survival: the picture darkens"},
               of(false, [](double t, double) { return t; })},
              {{"roulette-multiplied", "survivors are multiplied by the probability; they must be divided by it"},
               of(false, [](double t, double s) { return t * s; })},
              {{"roulette-exchanged", "the path ends with probability `survival`: u < survival continues"},
               of(true, [](double t, double s) { return t / s; })},
              {{"roulette-exchanged", "the path ends with probability `survival`: u < survival continues"},
               of(true, [](double t, double s) { return t / (1.0 - s); })},
              {{"roulette-wrong-probability", "divide by the probability of continuing, not of ending"},
               of(false, [](double t, double s) { return t / (1.0 - s); })},
              {{"never-ends", "the path always continues"},
               [](Point p) { return glm::dvec4(1.0, p[0].x / p[0].y, 0.0, 0.0); }}}}) &&
        c.mean("throughput is kept on average", {.probe = 7, .inputs = {four(1.5, survival)}, .expected = 1.5});
  }
  // Task 4: furnacePath: one path in a closed box.
  void furnacePath() {
    const double otherAlbedo = c.fresh(0.3, 0.8), otherEmission = c.fresh(0.5, 2.0);
    const std::vector<glm::vec4> box{four(emission, albedo, survival)};
    const double reference = emission / (1.0 - albedo);
    std::vector<double> shares, endingExchanged;
    for (int k = 0; k < 16; ++k)
      shares.push_back(std::pow(survival, k) * (k < 15 ? 1.0 - survival : 1.0)),
          endingExchanged.push_back(std::pow(1.0 - survival, k) * (k < 15 ? survival : 1.0));
    std::vector<double> oneMore(16, 0.0);
    for (int k = 1; k < 16; ++k)
      oneMore[static_cast<std::size_t>(k)] = std::pow(survival, k - 1) * (k < 15 ? 1.0 - survival : 1.0);
    c.mean(
        "radiance in a closed box",
        {.probe = 9,
         .inputs = box,
         .expected = reference,
         .mistakes = {{{"lost-emission", "the walls' own emission, seen without a reflection, is missing"},
                       reference - emission},
                      {{"roulette-undivided",
                        "the throughput that roulette returns is not used: survivors count too little"},
                       emission / (1.0 - albedo * survival)},
                      {{"one-bounce", "there is more than one reflection: the path continues until roulette ends it"},
                       emission * (1.0 + albedo)},
                      {{"emission-once", "every wall that the path meets emits: add it at each"}, emission}}}) &&
        c.mean("radiance in another closed box",
               {.probe = 9,
                .inputs = {four(otherEmission, otherAlbedo, 0.85)},
                .expected = otherEmission / (1.0 - static_cast<float>(otherAlbedo))}) &&
        c.chiSquare(
            "how often paths are reflected",
            {.probe = 8,
             .inputs = box,
             .bin =
                 [](const glm::vec4& v) { return v.y < -0.5f ? -1 : std::min(15, static_cast<int>(std::lround(v.y))); },
             .shares = shares,
             .mistakes = {{{"bounces-exchanged", "paths end with the probability of survival"}, endingExchanged},
                          {{"bounces-one-more",
                            "a path that roulette ends at once was not reflected: count after roulette"},
                           oneMore},
                          {{"no-path", "no path is followed: the result is a formula, not an estimate"},
                           [] {
                             std::vector<double> s(16, 0.0);
                             s[0] = 1.0;
                             return s;
                           }()}}}) &&
        c.mean("each path's radiance by its reflections", {.probe = 10, .inputs = box, .expected = 1.0});
  }
  // Task 5: standardError of a mean.
  void standardError() {
    const auto of = [](double (*value)(double mean, double meanSquare, double n)) {
      return [=](Point p) { return glm::dvec4(value(double(p[0].x) / p[0].z, double(p[0].y) / p[0].z, p[0].z)); };
    };
    c.againstReference(
        "standard error at points",
        {.probe = 11,
         .draw =
             [](Random& r, std::span<glm::vec4> p) {
               const double n = std::floor(r.uniform(2.0, 100.0)), mean = r.uniform(0.1, 2.0),
                            deviation = r.uniform(0.5, 2.0) * mean;
               p[0] = four(n * mean, n * (mean * mean + deviation * deviation), n);
             },
         .reference = of([](double m, double q, double n) { return std::sqrt((q - m * m) / (n - 1.0)); }),
         .mistakes = {
             {{"deviation-of-a-sample", "that is the deviation of one sample; the mean of n has 1 / sqrt(n) of it"},
              of([](double m, double q, double n) { return std::sqrt((q - m * m) * n / (n - 1.0)); })},
             {{"deviation-of-a-sample", "that is the deviation of one sample; the mean of n has 1 / sqrt(n) of it"},
              of([](double m, double q, double) { return std::sqrt(q - m * m); })},
             {{"variance", "that is the variance of the mean: take its root"},
              of([](double m, double q, double n) { return (q - m * m) / (n - 1.0); })},
             {{"n-for-n-less-one", "n samples lose one to their own mean: n - 1"},
              of([](double m, double q, double n) { return std::sqrt((q - m * m) / n); })},
             {{"mean-not-subtracted", "the square of the mean is not subtracted"},
              of([](double, double q, double n) { return std::sqrt(q / (n - 1.0)); })}}});
  }
  // Task 6: the floor close below a lamp, using tasks 1, 2 and 5.
  void together() {
    const std::vector<glm::vec4> lamp{four(side, height, albedo), four(away)};
    c.mean("both strategies together", {.probe = 12, .inputs = lamp, .expected = light}) &&
        c.picture("floor", {.probe = 13,
                            .inputs = lamp,
                            .reference =
                                [&](glm::ivec2 p) {
                                  return glm::dvec3(
                                      albedo / kPi *
                                      squareLampIrradiance(side, height,
                                                           {(p.x + 0.5) / 32.0 - 1.5, 0.0, (p.y + 0.5) / 32.0 - 1.0}));
                                },
                            .caption = "The floor close below a square lamp, from above: 64 samples of the lamp and 64 "
                                       "by the cosine a pixel; the reference is exact"});
    Curve curve{"Error against samples, both strategies", "samples a pixel", "standard deviation", {}, {}};
    for (int samples = 1; samples <= 256; samples *= 4) {
      double square = 0.0;
      for (const glm::vec4& v : c.run(14, std::vector<glm::vec4>{lamp[0], lamp[1], four(samples)}, 0, 512))
        square += std::pow(v.x - light, 2.0) / 512.0;
      curve.mine.emplace_back(samples, std::sqrt(square));
      curve.reference.emplace_back(samples, curve.mine.front().y / std::sqrt(samples));
    }
    c.curve(curve);
    // The same against time on this machine, including the overhead of a run without samples.
    Curve time{"Error against time, both strategies, on this machine", "seconds", "standard deviation", {}, {}};
    for (int samples = 4; samples <= 1024; samples *= 4) {
      const auto start = Clock::now();
      double square = 0.0;
      for (const glm::vec4& v : c.run(14, std::vector<glm::vec4>{lamp[0], lamp[1], four(samples)}, 0, 512))
        square += std::pow(v.x - light, 2.0) / 512.0;
      time.mine.emplace_back(secondsSince(start), std::sqrt(square));
    }
    for (const glm::dvec2& p : time.mine)
      time.reference.emplace_back(p.x, time.mine.back().y * std::sqrt(time.mine.back().x / p.x));
    c.curve(time);
  }

  void run() {
    // The README's questions, with the results of common mistakes.
    c.answer("samples", 64.0 * std::pow(error / wanted, 2.0), 0.02,
             {{{"linear", "the error falls with the square root of the samples"}, 64.0 * error / wanted}});
    c.answer(
        "bounces", survival / (1.0 - survival), 0.005,
        {{{"one-off", "the mean of a geometric distribution that begins at 0, not at 1"}, 1.0 / (1.0 - survival)}});
    c.answer("furnace", emission / (1.0 - albedo), 0.005,
             {{{"survival-counts", "survival changes the noise, not the mean"}, emission / (1.0 - albedo * survival)}});
    if (c.task(1)) misWeight();
    if (c.task(2)) lampSample();
    if (c.task(3)) roulette();
    if (c.task(4)) furnacePath();
    if (c.task(5)) standardError();
    if (c.task(6)) together();
    // Numbers that the README quotes.
    c.figure("samples", 64.0 * std::pow(error / wanted, 2.0));
    c.figure("bounces", survival / (1.0 - survival));
    c.figure("furnace", emission / (1.0 - albedo));
  }
};

}  // namespace

extern const Lab kPathsLab;
const Lab kPathsLab{7,
                    "paths",
                    "Path tracing: estimators, multiple importance sampling, roulette, error",
                    {{1, "misWeight", 15, {}},
                     {2, "lampSample", 20, {}},
                     {3, "roulette", 15, {}},
                     {4, "furnacePath", 15, {3}},
                     {5, "standardError", 10, {}},
                     {6, "together: the floor close below a lamp", 10, {1, 2, 5}}},
                    15,
                    [](Checks& c) { PathsChecks{c}.run(); }};

}  // namespace lucerna::demo::labs
