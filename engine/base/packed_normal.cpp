#include "base/packed_normal.hpp"

#include <glm/gtc/packing.hpp>

#include <algorithm>
#include <cmath>

namespace lucerna {

std::uint32_t packNormal(const glm::dvec3& normal) {
  const glm::dvec3 n = normal / (std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z));
  const auto sign = [](double v) { return v < 0.0 ? -1.0 : 1.0; };
  const glm::dvec2 flat =
      n.z >= 0.0 ? glm::dvec2(n) : glm::dvec2((1.0 - std::abs(n.y)) * sign(n.x), (1.0 - std::abs(n.x)) * sign(n.y));
  return glm::packSnorm2x16(glm::vec2(flat));
}

glm::dvec3 unpackNormal(std::uint32_t packed) {
  const glm::dvec2 flat(glm::unpackSnorm2x16(packed));
  glm::dvec3 n(flat, 1.0 - std::abs(flat.x) - std::abs(flat.y));
  const double below = std::max(-n.z, 0.0);
  n.x += n.x < 0.0 ? below : -below;
  n.y += n.y < 0.0 ? below : -below;
  return glm::normalize(n);
}

}  // namespace lucerna
