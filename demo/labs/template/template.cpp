// Template of a lab: copy the folder, give it a number, and list it in lab_list.cpp.
#include "labs/lab.hpp"

#include <cmath>
#include <numbers>

namespace lucerna::demo::labs {

static void check(Checks& c) {
  constexpr double kPi = std::numbers::pi;
  const Mistake circumference{"circumference", "that is the circumference"};
  // A question: its parameter follows from the seed, and its number from a formula.
  const double radius = c.yours("radius", 0.5, 3.0);
  c.answer("area", kPi * radius * radius, 0.005, {{circumference, 2.0 * kPi * radius}});
  c.figure("area", kPi * radius * radius);
  // A function compared with its reference implementation in double precision, with the results of typical mistakes.
  if (c.task(1))
    c.againstReference(
        "areas",
        {.probe = 1,
         .draw = [](Random& r, std::span<glm::vec4> p) { p[0].x = static_cast<float>(r.uniform(0.1, 5.0)); },
         .reference = [](Point p) { return glm::dvec4(kPi * p[0].x * p[0].x); },
         .mistakes = {{circumference, [](Point p) { return glm::dvec4(2.0 * kPi * p[0].x); }},
                      {{"not-squared", "square the radius"}, [](Point p) { return glm::dvec4(kPi * p[0].x); }}}});
  // Samples compared with the probabilities of bins: eight rings of equal area; 8 is outside.
  std::vector<double> crowded;
  for (int k = 0; k < 8; ++k) crowded.push_back(std::sqrt((k + 1) / 8.0) - std::sqrt(k / 8.0));
  const auto ringOf = [](const glm::vec4& v) { return static_cast<int>(glm::min(8.0f, 7.9999f * glm::dot(v, v))); };
  if (c.task(2))
    c.chiSquare("points in eight rings",
                {.probe = 2,
                 .bin = ringOf,
                 .shares = std::vector<double>(8, 0.125),
                 .mistakes = {{{"uniform-radius", "a uniform radius crowds the middle: take the root"}, crowded}}});
}

extern const Lab kTemplateLab;
const Lab kTemplateLab{0, "template", "The disc", {{1, "discArea", 40, {}}, {2, "discPoint", 40, {}}}, 20, check};

}  // namespace lucerna::demo::labs
