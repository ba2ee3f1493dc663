// Template of a lab: copy the folder, give it a number, and list it in lab_list.cpp.
#include "labs/lab.hpp"

#include <cmath>
#include <numbers>

namespace lucerna::demo::labs {

namespace {

constexpr double kPi = std::numbers::pi;

void check(Checks& c) {
  // Questions: what they are about follows from the seed, and the figure from a formula.
  const double radius = c.yours("radius", 0.5, 3.0);
  c.answer("area", kPi * radius * radius, 0.005,
           {{{"circumference", "that is the circumference"}, 2.0 * kPi * radius}});

  // A function against its twin in double precision, with what typical mistakes would give.
  if (c.task(1)) {
    const auto of = [](double (*area)(double)) { return [=](Point p) { return glm::dvec4(area(p[0].x)); }; };
    c.twin(
        "areas",
        {.probe = 1,
         .draw = [](Random& r, std::span<glm::vec4> p) { p[0] = glm::vec4(static_cast<float>(r.uniform(0.1, 5.0))); },
         .truth = of([](double r) { return kPi * r * r; }),
         .mistakes = {{{"circumference", "that is the circumference"}, of([](double r) { return 2.0 * kPi * r; })},
                      {{"not-squared", "the radius must be squared"}, of([](double r) { return kPi * r; })}}});
  }
  // Samples against the shares of bins: eight rings of equal area.
  if (c.task(2)) {
    std::vector<double> crowded;
    for (int k = 0; k < 8; ++k) crowded.push_back(std::sqrt((k + 1) / 8.0) - std::sqrt(k / 8.0));
    c.chiSquare("points in eight rings",
                {.probe = 2,
                 .bin =
                     [](const glm::vec4& v) {
                       const float square = v.x * v.x + v.y * v.y;
                       return square > 1.00001f ? -1 : std::min(7, static_cast<int>(8.0f * square));
                     },
                 .shares = std::vector<double>(8, 0.125),
                 .mistakes = {
                     {{"uniform-radius", "the radius is uniform, so the middle is crowded: take the root"}, crowded}}});
  }
  c.figure("area", kPi * radius * radius);
}

}  // namespace

extern const Lab kTemplateLab;
const Lab kTemplateLab{0,  "template", "Template: the disc", {{1, "discArea", 40, {}}, {2, "discPoint", 40, {}}},
                       20, check};

}  // namespace lucerna::demo::labs
