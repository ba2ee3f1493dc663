#include "render/near_plane.hpp"

#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <array>
#include <limits>

namespace lucerna {

namespace {

constexpr double kNowhere = std::numeric_limits<double>::infinity();

/// The least z of the part of a triangle with |x| < z wide and |y| < z high. Space: the camera's, z along the view.
double nearestOfTriangle(std::vector<glm::dvec3>& corners, double wide, double high) {
  const std::array<glm::dvec3, 4> insides{
      {{1.0, 0.0, wide}, {-1.0, 0.0, wide}, {0.0, 1.0, high}, {0.0, -1.0, high}}};  // dot(inside, p) > 0
  std::vector<glm::dvec3> clipped;
  for (const glm::dvec3& inside : insides) {
    clipped.clear();
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const glm::dvec3 &a = corners[i], &b = corners[(i + 1) % corners.size()];
      const double atA = glm::dot(inside, a), atB = glm::dot(inside, b);
      if (atA >= 0.0) clipped.push_back(a);
      if ((atA < 0.0) != (atB < 0.0)) clipped.push_back(glm::mix(a, b, atA / (atA - atB)));
    }
    corners.swap(clipped);
  }
  double nearest = kNowhere;
  for (const glm::dvec3& p : corners) nearest = std::min(nearest, p.z);
  return nearest;
}

}  // namespace

std::vector<double> nearestInView(const Scene& scene, const Camera& camera, double aspect, double within) {
  std::vector<double> nearest(scene.meshes.size(), kNowhere);
  if (camera.isOrthographic()) return nearest;
  const double high = camera.halfHeight(), wide = high * aspect;
  const double reach = within * glm::length(glm::dvec3(wide, high, 1.0));
  glm::dmat4 view = glm::lookAt(glm::dvec3(0.0), camera.direction, camera.up);
  std::vector<glm::dvec3> corners;
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    const Mesh& mesh = scene.meshes[m];
    const Bounds& box = mesh.bounds;
    if (box.empty() || glm::distance(glm::clamp(camera.position, box.min, box.max), camera.position) > reach) continue;
    for (std::uint32_t i = mesh.firstIndex; i + 2 < mesh.firstIndex + mesh.indexCount; i += 3) {
      Bounds triangle;
      corners.clear();
      for (std::uint32_t k = 0; k < 3; ++k) {
        const glm::dvec3 p(scene.vertices[scene.indices[i + k]].position);
        triangle.add(p);
        corners.push_back(glm::dvec3(view * glm::dvec4(p - camera.position, 1.0)) * glm::dvec3(1.0, 1.0, -1.0));
      }
      const glm::dvec3 closest = glm::clamp(camera.position, triangle.min, triangle.max);
      if (glm::distance(closest, camera.position) > reach) continue;
      const double z = nearestOfTriangle(corners, wide, high);
      if (z < within) nearest[m] = std::min(nearest[m], z);
    }
  }
  return nearest;
}

double nearPlane(const Scene& scene, double aspect) {
  const double diagonal = std::max(glm::length(scene.main().extent()), 1e-6), usual = 5e-4 * diagonal;
  double nearest = kNowhere;
  for (const Camera& camera : scene.cameras)
    for (const double z : nearestInView(scene, camera, aspect, usual)) nearest = std::min(nearest, z);
  return 0.5 * nearest >= 1e-6 * diagonal ? std::min(0.5 * nearest, usual) : usual;
}

}  // namespace lucerna
