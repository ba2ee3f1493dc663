#include "forward/sun_cascades.hpp"

#include "base/error.hpp"

#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cmath>

namespace lucerna {

namespace {
constexpr double kFilterTexels =
    4.0;  // border of two texels per side, so that the filter and the normal offset stay inside the map
}

bool hasFewTexels(const Bounds& part, double texel) {
  constexpr double kLeastAcross = 4.0;
  const glm::dvec3 extent = part.extent();
  const double across = std::max({extent.x, extent.y, extent.z});
  return across > 0.0 && across < kLeastAcross * texel;
}

int neededCascades(const Scene& scene, std::span<const Bounds> parts, double texel) {
  const auto isSmall = [&](const Bounds& part) { return hasFewTexels(part, texel); };
  const auto isSmallMesh = [&](const Mesh& mesh) { return mesh.indexCount > 0 && isSmall(mesh.bounds); };
  const bool hasSmall = std::ranges::any_of(parts, isSmall) || std::ranges::any_of(scene.meshes, isSmallMesh);
  return hasSmall ? SUN_MAX_CASCADES : 1;
}

std::vector<double> splitDistances(double near, double far, int cascades, double lambda) {
  CHECK(near > 0.0 && far > near && cascades >= 1, "near = {}, far = {}, cascades = {}", near, far, cascades);
  std::vector<double> distances{near};
  for (int i = 1; i < cascades; ++i) {
    const double part = static_cast<double>(i) / cascades;
    distances.push_back(lambda * near * std::pow(far / near, part) + (1.0 - lambda) * (near + (far - near) * part));
  }
  distances.push_back(far);
  return distances;
}

std::vector<SunCascade> placeSunCascades(const SunCascadeSettings& settings, const Scene& scene,
                                         const glm::dvec3& sunDirection, const SunFrustum& whole, const Camera& camera,
                                         double aspect, double near, int mapSize) {
  CHECK(settings.cascades >= 1 && settings.cascades <= SUN_MAX_CASCADES, "cascades = {}", settings.cascades);
  const Bounds bounds = scene.mainAround(camera.position);
  const double diagonal = std::max(glm::length(bounds.extent()), 1e-6);
  const double farthest = bounds.farthestFrom(camera.position);
  const double far =
      std::max(diagonal * std::exp2(std::ceil(4.0 * std::log2(std::max(farthest / diagonal, 1.0))) / 4.0), 2.0 * near);
  const std::vector<double> splits = splitDistances(near, far, settings.cascades, settings.split);

  // Squared tangent of the angle between the view's axis and its corners; of an orthographic view, squared distance.
  const double tangent = camera.halfHeight();
  const double corner2 = tangent * tangent * (1.0 + aspect * aspect);
  // The same axes as the whole scene's frustum; z from `whole`, which is orthographic: clip z depends on depth alone.
  const glm::dvec3 up = std::abs(sunDirection.y) < 0.99 ? glm::dvec3(0.0, 1.0, 0.0) : glm::dvec3(1.0, 0.0, 0.0);
  const glm::dmat4 lightFromWorld = glm::lookAt(glm::dvec3(0.0), sunDirection, up);
  const double wholeTexel = std::max(whole.width, whole.height) / mapSize;

  std::vector<SunCascade> cascades;
  for (int i = 0; i < settings.cascades; ++i) {
    const double a = splits[static_cast<std::size_t>(i)], b = splits[static_cast<std::size_t>(i) + 1];
    // The smallest sphere through the slice's corners with its centre on the axis; not beyond the far plane.
    const double along = camera.isOrthographic() ? 0.5 * (a + b) : std::min(0.5 * (a + b) * (1.0 + corner2), b);
    const double toCorner = std::sqrt(corner2), nearCorner = camera.isOrthographic() ? toCorner : a * toCorner,
                 farCorner = camera.isOrthographic() ? toCorner : b * toCorner;
    const double radius = std::max(std::hypot(b - along, farCorner), std::hypot(along - a, nearCorner));
    SunCascade cascade;
    cascade.texel = 2.0 * radius / std::max(mapSize - kFilterTexels, 1.0);
    if (cascade.texel >= wholeTexel) {
      cascades.push_back({whole.clipFromWorld, wholeTexel});
      continue;
    }
    const glm::dvec3 centre(lightFromWorld * glm::dvec4(camera.position + along * camera.direction, 1.0));
    const glm::dvec2 snapped = cascade.texel * glm::floor(glm::dvec2(centre) / cascade.texel);
    const double half = 0.5 * mapSize * cascade.texel;
    glm::dmat4 clip =
        glm::ortho(snapped.x - half, snapped.x + half, snapped.y - half, snapped.y + half, -1.0, 1.0) * lightFromWorld;
    for (int column = 0; column < 4; ++column) clip[column].z = whole.clipFromWorld[column].z;
    cascade.clipFromWorld = clip;
    cascades.push_back(cascade);
  }
  return cascades;
}

}  // namespace lucerna
