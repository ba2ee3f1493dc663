#include "forward/sun_frustum.hpp"

#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cmath>

namespace lucerna {

SunFrustum fitSunFrustum(const Scene& scene, const glm::dvec3& sunDirection) {
  const glm::dvec3 up = std::abs(sunDirection.y) < 0.99 ? glm::dvec3(0.0, 1.0, 0.0) : glm::dvec3(1.0, 0.0, 0.0);
  const glm::dvec3 centre = scene.main().centre();
  const glm::dmat4 lightFromWorld = glm::lookAt(centre, centre + sunDirection, up);
  Bounds box;
  for (const Vertex& vertex : scene.vertices)
    if (const glm::dvec3 p(vertex.position); scene.isMain(p)) box.add(glm::dvec3(lightFromWorld * glm::dvec4(p, 1.0)));
  // A flat scene still needs a volume; the margin keeps edge texels inside.
  const double smallest = 1e-3 * std::max({box.extent().x, box.extent().y, box.extent().z, 1e-30});
  const glm::dvec3 margin = glm::max(0.005 * box.extent(), glm::dvec3(smallest));
  box.min -= margin;
  box.max += margin;
  SunFrustum frustum;
  frustum.width = box.extent().x;
  frustum.height = box.extent().y;
  frustum.clipFromWorld =
      glm::ortho(box.min.x, box.max.x, box.min.y, box.max.y, -box.max.z, -box.min.z) * lightFromWorld;
  return frustum;
}

}  // namespace lucerna
