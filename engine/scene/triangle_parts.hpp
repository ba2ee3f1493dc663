// Divides a triangle into n x n equal triangles, for sampling values over it (no GL, pure).
//
// Strip i = 0..n-1 along the second corner has 2 (n - i) - 1 parts, every second one upside down. Shaders:
// radiosity/triangle_parts.glsl.
#pragma once

#include <glm/glm.hpp>

#include <algorithm>
#include <vector>

namespace lucerna {

/// Weights of the second and third corner at each part's centroid, strip after strip.
inline std::vector<glm::dvec2> partCentroids(int n) {
  std::vector<glm::dvec2> centroids;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < 2 * (n - i) - 1; ++j) {
      const double third = j % 2 == 0 ? 1.0 / 3.0 : 2.0 / 3.0;
      centroids.emplace_back((i + third) / n, (j / 2 + third) / n);
    }
  return centroids;
}

/// The part that contains a point of the triangle, numbered as in partCentroids.
inline int partAt(int n, const glm::dvec2& weights) {
  const glm::dvec2 at = static_cast<double>(n) * weights;
  const int i = std::clamp(static_cast<int>(at.x), 0, n - 1), pair = std::clamp(static_cast<int>(at.y), 0, n - 1 - i);
  const bool upsideDown = at.x - i + at.y - pair > 1.0;
  return i * (2 * n - i) + std::min(2 * pair + upsideDown, 2 * (n - i) - 2);
}

}  // namespace lucerna
