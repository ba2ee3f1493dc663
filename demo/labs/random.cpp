#include "labs/random.hpp"

#include "base/data.hpp"

#include <cmath>
#include <numbers>

namespace lucerna::demo::labs {

std::uint64_t Random::word() {
  std::uint64_t z = state_ += 0x9e3779b97f4a7c15u;
  z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
  z = (z ^ z >> 27) * 0x94d049bb133111ebu;
  return z ^ z >> 31;
}
double Random::uniform() { return static_cast<double>(word() >> 11) * 0x1p-53; }
glm::dvec3 Random::direction() {
  const double z = uniform(-1.0, 1.0), angle = uniform(0.0, 2.0 * std::numbers::pi), r = std::sqrt(1.0 - z * z);
  return {r * std::cos(angle), r * std::sin(angle), z};
}

std::filesystem::path labsFolder() { return dataFolder() / "demo/labs"; }

}  // namespace lucerna::demo::labs
