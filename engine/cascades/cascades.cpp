#include "cascades/cascades.hpp"

#include "base/error.hpp"

#include <algorithm>
#include <cmath>

namespace lucerna {

std::vector<Cascade> placeCascades(const CascadeSettings& settings, const Bounds& scene,
                                   const glm::dvec3& cameraPosition, const glm::dvec3& cameraDirection) {
  CHECK(settings.cells >= 1 && settings.cascades >= 1, "cells = {}, cascades = {}", settings.cells, settings.cascades);
  const glm::dvec3 extent = scene.extent();
  double coarsest = settings.cellSize;
  if (coarsest <= 0.0) {
    // Half the cells span the scene: eight steps then carry light across a quarter of it. Smaller cells would resolve
    // more detail, which is the finer cascades' job, but would leave most of the scene dark.
    const double longest = std::max({extent.x, extent.y, extent.z});
    coarsest = longest > 0.0 ? settings.spanOfScene * longest / settings.cells : 1.0;
  }

  std::vector<Cascade> cascades;
  for (int k = 0; k < settings.cascades; ++k) {
    Cascade cascade;
    cascade.cellSize = coarsest / std::pow(settings.ratio, settings.cascades - 1 - k);
    const double half = 0.5 * settings.cells * cascade.cellSize;
    glm::dvec3 centre = cameraPosition + cameraDirection * (settings.push * half);
    if (!scene.empty() && settings.heldInScene) {
      // Margin that gives the grid weight at the scene's outer surfaces: it fades out about three cells before its
      // border.
      const double beyond = std::min(4.0, 0.25 * settings.cells) * cascade.cellSize;
      const glm::dvec3 low = scene.min + half - beyond;
      const glm::dvec3 high = scene.max - half + beyond;
      for (int axis = 0; axis < 3; ++axis)
        centre[axis] = low[axis] < high[axis] ? std::clamp(centre[axis], low[axis], high[axis]) : scene.centre()[axis];
    }
    cascade.centre = centre;
    const std::int64_t stride = k + 1 < settings.cascades ? settings.steps : 1;
    for (int axis = 0; axis < 3; ++axis)
      cascade.firstCell[axis] = stride * static_cast<std::int64_t>(std::floor(
                                             (centre[axis] - half) / (cascade.cellSize * static_cast<double>(stride))));
    cascades.push_back(cascade);
  }
  return cascades;
}

std::vector<Cascade> placeCascadesAround(const CascadeSettings& settings, const Bounds& scene, const Camera& camera,
                                         double aspect) {
  CascadeSettings single = settings;
  single.steps = 1;
  std::vector<Cascade> cascades = placeCascades(single, scene, camera.position, camera.direction);
  const double toCorner = camera.halfHeight() * std::sqrt(1.0 + aspect * aspect);  // at distance 1 along the view
  const double cosine = 1.0 / std::sqrt(1.0 + toCorner * toCorner);  // of the view's corners
  const bool held = settings.heldInScene && !scene.empty();
  const glm::dvec3 nearest = held ? glm::clamp(camera.position, scene.min, scene.max) : camera.position;
  for (Cascade& cascade : cascades) {
    // A point at the distance t in a corner of the view is |t v - pushed d| from the grid's centre, for unit vectors
    // with <v, d> = cosine. It is inside where that is at most `half`, as the grid holds a ball of that radius: from
    // its side are taken a cell of snapping, half a cell of interpolation, and a cell in which the grid fades out.
    const double half = (0.5 * settings.cells - 2.5) * cascade.cellSize,
                 pushed = settings.push * 0.5 * settings.cells * cascade.cellSize,
                 beside2 = pushed * pushed * (1.0 - cosine * cosine);
    cascade.reach = half > 0.0 ? pushed * cosine + std::sqrt(std::max(half * half - beside2, 0.0)) : 0.0;
    if (camera.isOrthographic() && half > 0.0) {  // its corners are toCorner from the axis everywhere
      const double along = std::sqrt(std::max(half * half - toCorner * toCorner, 0.0));
      cascade.reach = along > 0.0 ? std::hypot(pushed + along, toCorner) : cascade.cellSize;
    }
    cascade.centre = nearest;
  }
  return cascades;
}

shared::CascadeConstants cascadeConstants(const CascadeSettings& settings, const std::vector<Cascade>& cascades,
                                          float blendBand, float referenceIrradiance, float lookupOffset) {
  CHECK(referenceIrradiance > 0.0f, "E_ref = {}", referenceIrradiance);
  CHECK(static_cast<int>(cascades.size()) == settings.cascades, "{} cascades", cascades.size());
  shared::CascadeConstants constants{};
  for (std::size_t k = 0; k < cascades.size(); ++k) {
    const Cascade& cascade = cascades[k];
    auto& target = constants.cascades[k];
    target.minimum = glm::vec3(cascade.minimum());
    target.cellSize = static_cast<float>(cascade.cellSize);
    target.blendCentre = glm::vec3(cascade.centre);
    // Snapping moves the grid by up to two cells and the trilinear lookup needs half a cell more.
    const bool coarsest = k + 1 == cascades.size();
    const double half =
        cascade.reach > 0.0 ? cascade.reach : (0.5 * settings.cells - 2.5 - lookupOffset) * cascade.cellSize;
    target.blendHalf = coarsest ? 1e30f : static_cast<float>(half);
    if (!coarsest && target.blendHalf <= 0.0f) target.blendHalf = 1e-30f;  // too few cells to blend: never used
  }
  constants.shape = {settings.cells, settings.cascades, 0, 0};
  constants.referenceIrradiance = referenceIrradiance;
  constants.blendBand = blendBand;
  constants.lookupOffset = lookupOffset;
  return constants;
}

}  // namespace lucerna
