#include "support/rsm_reference.hpp"

#include "base/angles.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace lucerna::reference {

glm::dvec2 RsmMap::project(const glm::dvec3& point) const {
  return {glm::dot(point - corner, right) / width, glm::dot(point - corner, up) / height};
}

glm::dvec3 RsmMap::rayOrigin(int x, int y) const {
  return corner + right * (width * (x + 0.5) / size.x) + up * (height * (y + 0.5) / size.y);
}

glm::dmat4 RsmMap::clipFromWorld(double range) const {
  const glm::dvec3 rows[3] = {right * (2.0 / width), up * (2.0 / height), direction / range};
  const glm::dvec3 middle = corner + 0.5 * (right * width + up * height);
  glm::dmat4 clip(0.0);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) clip[column][row] = rows[row][column];
    clip[3][row] = -glm::dot(rows[row], middle);
  }
  clip[3][3] = 1.0;
  return clip;
}

double polygonFormFactor(std::span<const glm::dvec3> corners, const glm::dvec3& normal) {
  std::vector<glm::dvec3> kept;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const glm::dvec3 a = corners[i], b = corners[(i + 1) % corners.size()];
    const double ha = glm::dot(a, normal), hb = glm::dot(b, normal);
    if (ha >= 0.0) kept.push_back(a);
    if ((ha > 0.0 && hb < 0.0) || (ha < 0.0 && hb > 0.0)) kept.push_back(a + (b - a) * (ha / (ha - hb)));
  }
  double sum = 0.0;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    const glm::dvec3 a = kept[i], b = kept[(i + 1) % kept.size()], across = glm::cross(a, b);
    const double length = glm::length(across);
    if (length > 0.0) sum += std::atan2(length, glm::dot(a, b)) * glm::dot(across, normal) / length;
  }
  return std::abs(sum) / (2.0 * kPi);
}

glm::dvec3 surfelIrradiance(const RsmMap& map, const RsmMap::Texel& texel, const glm::dvec3& x, const glm::dvec3& n,
                            const GatherOptions& options) {
  const glm::dvec3 d = x - texel.position;
  const double distance = glm::length(d);
  if (!texel.surface || distance == 0.0) return glm::dvec3(0.0);
  const double emitted = glm::dot(texel.normal, d) / distance;
  if (emitted <= 0.0) return glm::dvec3(0.0);
  const double cosine = std::max(texel.cosine, 0.05);
  const double width = map.width / map.size.x, height = map.height / map.size.y;
  // The outline's squared edges, were it tilted along the longer one: w^2 and h^2 / cos^2; their symmetric mean,
  // doubled twice.
  const double nearDistance = std::sqrt((width * width + height * height) * (1.0 + 1.0 / (cosine * cosine)));
  if (options.nearField == NearField::quad && distance < nearDistance) {
    // The other side of the surfel's own sheet: facing it, and nearer its plane than a twentieth of the edge (half of
    // nearDistance).
    const double facing = -glm::dot(texel.normal, n);
    if (facing > 0.0 && emitted * distance < 0.05 * facing * 0.5 * nearDistance) return glm::dvec3(0.0);
    const double slope = std::max(-glm::dot(texel.normal, map.direction), 0.05);
    const auto onSurface = [&](const glm::dvec3& edge) {
      return edge + map.direction * (glm::dot(texel.normal, edge) / slope);
    };
    const glm::dvec3 u = onSurface(map.right * width), v = onSurface(map.up * height);
    const std::array<glm::dvec3, 4> outline{-d + 0.5 * (u + v), -d + 0.5 * (u - v), -d - 0.5 * (u + v),
                                            -d + 0.5 * (v - u)};
    return texel.flux / glm::length(glm::cross(u, v)) * polygonFormFactor(outline, n);
  }
  const double received = -glm::dot(n, d) / distance;
  if (received <= 0.0) return glm::dvec3(0.0);
  double d2 = distance * distance;
  if (options.nearField == NearField::disc) d2 += map.texelArea() / cosine / kPi;
  if (options.nearField == NearField::clamp) d2 = std::max(d2, options.minimumDistance * options.minimumDistance);
  return texel.flux * (emitted * received / (kPi * d2));
}

glm::dvec3 bruteForceIrradiance(const RsmMap& map, const glm::dvec3& x, const glm::dvec3& n,
                                const GatherOptions& options) {
  glm::dvec3 sum(0.0);
  for (const RsmMap::Texel& texel : map.texels) sum += surfelIrradiance(map, texel, x, n, options);
  return sum;
}

Gathered gather(const RsmMap& map, std::span<const glm::vec4> pattern, const glm::dvec3& x, const glm::dvec3& n,
                double rotation, const GatherOptions& options) {
  Gathered result;
  const glm::dvec2 size(map.size);
  glm::dvec2 centre = map.project(x) * size;
  if (options.wholeMap) centre = glm::clamp(centre, glm::dvec2(0.0), size);
  for (const glm::vec4& sample : pattern) {
    const double sine = static_cast<double>(sample.x), cosine = static_cast<double>(sample.y);
    const glm::dvec2 turned(std::cos(rotation) * sine + std::sin(rotation) * cosine,
                            std::cos(rotation) * cosine - std::sin(rotation) * sine);
    const glm::dvec2 at = centre + options.radius * size * turned;
    result.boundaryDistance =
        std::min({result.boundaryDistance, std::abs(at.x - std::round(at.x)), std::abs(at.y - std::round(at.y))});
    if (at.x < 0.0 || at.y < 0.0 || at.x >= size.x || at.y >= size.y) continue;
    const RsmMap::Texel& texel = map.at(static_cast<int>(at.x), static_cast<int>(at.y));
    result.irradiance += static_cast<double>(sample.z) * surfelIrradiance(map, texel, x, n, options);
  }
  const double area = 2.0 * kPi * options.radius * size.x * options.radius * size.y;  // in texels
  result.irradiance *= area / static_cast<double>(pattern.size());
  return result;
}

}  // namespace lucerna::reference
