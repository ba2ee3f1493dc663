#include "radiosity/original/map.hpp"

#include "base/error.hpp"

#include <cmath>

namespace lucerna {

MultiplierMap makeMultiplierMap(int view, bool published) {
  CHECK(view >= 2, "view {}", view);
  const int half = view / 2;
  const auto fromMiddle = [&](int i) { return std::abs(0.5 + i - view / 2.0) / (view / 2.0); };
  const auto weight = [&](double a, double b, double cosine) {
    const double r2 = 1.0 + a * a + b * b;
    return published ? cosine / r2 : cosine / (r2 * r2);
  };
  MultiplierMap map;
  map.view = view;
  std::vector<double> top, side;
  double sum = 0.0;
  for (int y = 0; y < view; ++y)
    for (int x = 0; x < view; ++x) sum += top.emplace_back(weight(fromMiddle(x), fromMiddle(y), 1.0));
  for (int y = view - half; y < view; ++y)
    for (int x = 0; x < view; ++x) sum += 4.0 * side.emplace_back(weight(fromMiddle(x), fromMiddle(y), fromMiddle(y)));
  for (double w : top) map.top.push_back(static_cast<float>(w / sum));
  for (double w : side) map.side.push_back(static_cast<float>(w / sum));
  return map;
}

}  // namespace lucerna
