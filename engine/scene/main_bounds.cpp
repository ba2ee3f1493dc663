#include "scene/main_bounds.hpp"

#include <algorithm>

namespace lucerna {

namespace {

double diagonalOf(const Bounds& box) { return box.empty() ? 0.0 : glm::length(box.extent()); }

/// Squared size: as a camera sees it, where there is one, at its farthest from the camera.
double weightOf(const SweptBounds& mesh, const std::vector<Camera>& cameras) {
  const double size = diagonalOf(mesh.own);
  double largest = cameras.empty() ? size : 0.0;
  for (const Camera& camera : cameras)
    if (size > 0.0) largest = std::max(largest, size / (size + mesh.swept.farthestFrom(camera.position)));
  return largest * largest;
}

struct Weighted {
  SweptBounds mesh;
  double weight;
};

/// Coordinate by coordinate.
glm::dvec3 weightedMedian(const std::vector<Weighted>& meshes) {
  glm::dvec3 median(0.0);
  std::vector<std::pair<double, double>> places;  // with weights
  for (int axis = 0; axis < 3; ++axis) {
    places.clear();
    double left = 0.0;
    for (const Weighted& each : meshes) {
      places.emplace_back(each.mesh.own.centre()[axis], each.weight);
      left += 0.5 * each.weight;
    }
    std::ranges::sort(places);
    auto place = places.begin();
    for (left -= place->second; left > 0.0 && place + 1 != places.end(); left -= place->second) ++place;
    median[axis] = place->first;
  }
  return median;
}

}  // namespace

std::optional<Bounds> boundsWithoutFarMeshes(const std::vector<SweptBounds>& all, const std::vector<Camera>& cameras) {
  constexpr double kSmall = 0.01;
  std::vector<Weighted> left;
  double half = 0.0;
  for (const SweptBounds& mesh : all) {
    if (mesh.own.empty()) continue;
    left.push_back({mesh, weightOf(mesh, cameras)});
    half += 0.5 * left.back().weight;
  }
  if (left.size() < 2) return std::nullopt;
  const glm::dvec3 median = weightedMedian(left);
  std::ranges::stable_sort(left, {}, [&](const Weighted& each) { return each.mesh.swept.farthestFrom(median); });
  Bounds main;
  double weight = 0.0;
  const auto isMain = [&](const SweptBounds& mesh) {
    const double distance = main.empty() ? 0.0 : mesh.swept.farthestFrom(main.centre()), size = diagonalOf(mesh.own);
    return weight < half || distance <= kFarOff * diagonalOf(main) || size >= kSmall * distance ||
           std::ranges::any_of(cameras, [&](const Camera& camera) {
             return mesh.swept.farthestFrom(camera.position) < kFarOff * size;
           });
  };
  // Each mesh that is added may bring others near.
  for (bool grows = true; grows;) {
    grows = false;
    std::erase_if(left, [&](const Weighted& each) {
      if (!isMain(each.mesh)) return false;
      main.add(each.mesh.swept);
      weight += each.weight;
      return grows = true;
    });
  }
  return left.empty() ? std::nullopt : std::optional(main);
}

void findMainBounds(Scene& scene) {
  std::vector<SweptBounds> meshes;
  for (const Mesh& mesh : scene.meshes) meshes.push_back({mesh.bounds, mesh.bounds});
  scene.mainBounds = boundsWithoutFarMeshes(meshes, scene.cameras);
}

Bounds Scene::mainAround(const glm::dvec3& place) const {
  const Bounds& box = main();
  if (!mainBounds || glm::distance(place, box.centre()) <= kFarOff * diagonalOf(box)) return box;
  return {place - 0.5 * box.extent(), place + 0.5 * box.extent()};
}

}  // namespace lucerna
