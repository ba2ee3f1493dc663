#include "scene/studio.hpp"

#include "base/angles.hpp"
#include "scene/motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

namespace lucerna {

namespace {

constexpr double kFov = 50.0 * kPi / 180.0;
constexpr double kFovWithin = 70.0 * kPi / 180.0;
constexpr double kWidthOverHeight = 16.0 / 9.0;
constexpr double kBoxFill = 0.95;  ///< into an open box: its opening is the frame
const glm::dvec3 kThreeSides = -glm::normalize(glm::dvec3(0.5, 0.35, 1.0));
constexpr double kSunSlope = 1.49;  ///< downwards over horizontally
const glm::dvec3 kZenith(0.42, 0.47, 0.55);  ///< of the sky, over its horizon
constexpr double kFloorRadius = 4.0;  ///< over that of the scene, about its vertical axis
constexpr int kFloorCorners = 96;

constexpr int kRays = 64;
constexpr std::size_t kMostTriangles = 200000;  // kRays rays are a third of a second of one core

/// What a ray meets first, of all triangles in turn.
struct Hit {
  double distance = std::numeric_limits<double>::infinity();
  bool ofFront = false;
};
Hit firstHit(const Scene& scene, const glm::dvec3& origin, const glm::dvec3& ray) {
  Hit hit;
  for (std::size_t t = 0; t + 2 < scene.indices.size(); t += 3) {
    const auto corner = [&](std::size_t k) {
      return glm::dvec3(scene.vertices[scene.indices[t + k]].position) - origin;
    };
    const glm::dvec3 a = corner(0), u = corner(1) - a, v = corner(2) - a, normal = glm::cross(u, v);
    const double slope = glm::dot(normal, ray);
    if (slope == 0.0) continue;
    const double distance = glm::dot(normal, a) / slope;
    if (!(distance > 0.0 && distance < hit.distance)) continue;
    const glm::dvec3 p = distance * ray - a;
    const double area = glm::dot(normal, normal);
    const double s = glm::dot(glm::cross(p, v), normal) / area, w = glm::dot(glm::cross(u, p), normal) / area;
    if (s >= 0.0 && w >= 0.0 && s + w <= 1.0) hit = {distance, slope < 0.0};
  }
  return hit;
}

/// Directions spread evenly over the sphere [Gonzalez2010], or by the cosine over the hemisphere about +y.
glm::dvec3 spread(int i, bool cosine) {
  const double u = (i + 0.5) / kRays, y = cosine ? std::sqrt(1.0 - u) : 1.0 - 2.0 * u;
  const double angle = i * kPi * (3.0 - std::sqrt(5.0)), r = std::sqrt(1.0 - y * y);
  return {r * std::cos(angle), y, r * std::sin(angle)};
}

/// Rays from a point: how many meet a front, and the mean of the directions of those that meet nothing.
struct Surroundings {
  int fronts = 0;
  glm::dvec3 opening{0.0};
};
Surroundings lookAround(const Scene& scene, const glm::dvec3& point) {
  Surroundings seen;
  if (scene.triangleCount() > kMostTriangles) return seen;
  for (int i = 0; i < kRays; ++i) {
    const glm::dvec3 ray = spread(i, false);
    const Hit hit = firstHit(scene, point, ray);
    if (!std::isfinite(hit.distance)) seen.opening += ray;
    else if (hit.ofFront) ++seen.fronts;
  }
  return seen;
}

/// The direction out of an open box, that of an axis if it is near one. None if what most rays meet is not its inside,
/// or too few leave.
std::optional<glm::dvec3> openingOf(const Surroundings& seen) {
  const double length = glm::length(seen.opening);
  if (seen.fronts < kRays / 2 || length < 1.0 || std::abs(seen.opening.y) > 0.9 * length) return {};
  const glm::dvec3 out = seen.opening / length;
  for (const glm::dvec3& axis : {glm::dvec3(1, 0, 0), glm::dvec3(-1, 0, 0), glm::dvec3(0, 0, 1), glm::dvec3(0, 0, -1)})
    if (glm::dot(axis, out) > 0.9) return axis;
  return out;
}

constexpr int kMostBeside = kRays / 10;  // rays from within a closed room that meet no front

/// As lookAround() counts, but for no longer than it takes to see that it is not.
bool isEnclosed(const Scene& scene, const glm::dvec3& point) {
  int beside = 0;
  for (int i = 0; i < kRays && beside <= kMostBeside; ++i)
    if (!firstHit(scene, point, spread(i, false)).ofFront) ++beside;
  return beside <= kMostBeside;
}

/// Where the scene's light comes from: points that a room may enclose.
std::vector<glm::dvec3> placesOfLamps(const Scene& scene) {
  std::vector<glm::dvec3> points;
  for (const PointLight& lamp : scene.points) points.push_back(lamp.position);
  for (const SpotLight& lamp : scene.spots) points.push_back(lamp.position);
  const double nudge = 1e-3 * glm::length(scene.main().extent());
  for (const Mesh& mesh : scene.meshes) {
    if (scene.materials[static_cast<std::size_t>(mesh.material)].emission == glm::vec3(0.0f) || mesh.indexCount < 3)
      continue;
    const auto corner = [&](std::uint32_t k) {
      return glm::dvec3(scene.vertices[scene.indices[mesh.firstIndex + k]].position);
    };
    const glm::dvec3 up = glm::cross(corner(1) - corner(0), corner(2) - corner(0));
    if (glm::length(up) > 0.0) points.push_back((corner(0) + corner(1) + corner(2)) / 3.0 + nudge * glm::normalize(up));
  }
  constexpr std::size_t kMostPoints = 8;
  points.resize(std::min(points.size(), kMostPoints));
  return points;
}

/// A point within a closed room with light of its own: the scene's middle, from which `seen` is, or a lamp.
std::optional<glm::dvec3> pointWithin(const Scene& scene, const Surroundings& seen) {
  if (scene.defaultSun || scene.triangleCount() > kMostTriangles) return {};
  if (seen.fronts >= kRays - kMostBeside) return scene.main().centre();
  for (const glm::dvec3& point : placesOfLamps(scene))
    if (isEnclosed(scene, point)) return point;
  return {};
}

/// Along the longest level line through a point of a closed room, half way up, from close to its end.
Camera viewWithin(const Scene& scene, const glm::dvec3& point) {
  constexpr int kLines = 16;
  constexpr double kKeptFromWall = 0.1;  // of the way there
  Camera camera;
  camera.name = "default";
  camera.verticalFov = kFovWithin;
  const glm::dvec3 down(0.0, -1.0, 0.0);
  const double below = firstHit(scene, point, down).distance, above = firstHit(scene, point, -down).distance;
  const glm::dvec3 middle = point + (std::isfinite(below + above) ? 0.5 * (below - above) : 0.0) * down;
  double longest = 0.0;
  for (int i = 0; i < kLines; ++i) {
    const double angle = kPi * i / kLines;
    const glm::dvec3 ahead(std::cos(angle), 0.0, -std::sin(angle));
    const double back = firstHit(scene, middle, -ahead).distance,
                 length = back + firstHit(scene, middle, ahead).distance;
    if (!(std::isfinite(length) && length > longest)) continue;
    longest = length;
    camera.direction = ahead;
    camera.position = middle - (1.0 - kKeptFromWall) * back * ahead;
  }
  camera.up = {0.0, 1.0, 0.0};
  return camera;
}

/// Moves a camera so that all vertices fill that part of the picture's height or width, and are in its middle.
void frame(Camera& camera, const Scene& scene, double fill) {
  const glm::dvec3 right = glm::normalize(glm::cross(camera.direction, camera.up)), centre = scene.main().centre();
  const glm::dvec2 slope = fill * std::tan(0.5 * camera.verticalFov) * glm::dvec2(kWidthOverHeight, 1.0);
  // A vertex at (x, z) from the centre is within the picture's right edge for a camera at (c, -d) if
  // x - c <= slope (z + d), and so on: each edge has one vertex that is farthest beyond it.
  glm::dvec2 beyond(-1e300), before(-1e300);
  for (const Vertex& vertex : scene.vertices) {
    if (!scene.isMain(glm::dvec3(vertex.position))) continue;
    const glm::dvec3 p = glm::dvec3(vertex.position) - centre;
    const glm::dvec2 at(glm::dot(p, right), glm::dot(p, camera.up));
    const double z = glm::dot(p, camera.direction);
    beyond = glm::max(beyond, at - slope * z);
    before = glm::max(before, -at - slope * z);
  }
  const glm::dvec2 distances = 0.5 * (beyond + before) / slope, middle = 0.5 * (beyond - before);
  const double distance = std::max({distances.x, distances.y, 1e-9});
  camera.position = centre + middle.x * right + middle.y * camera.up - distance * camera.direction;
}

}  // namespace

Camera studioView(const Scene& scene) {
  const Surroundings seen = lookAround(scene, scene.main().centre());
  const std::optional<glm::dvec3> opening = openingOf(seen);
  if (!opening)
    if (const auto point = pointWithin(scene, seen)) return viewWithin(scene, *point);
  Camera camera;
  camera.name = "default";
  camera.verticalFov = kFov;
  camera.direction = opening ? -*opening : kThreeSides;
  camera.up = glm::normalize(glm::dvec3(0.0, 1.0, 0.0) - camera.direction.y * camera.direction);
  frame(camera, scene, opening ? kBoxFill : kStudioFill);
  return camera;
}

glm::dvec3 studioSun(const Camera& camera) {
  const glm::dvec2 ahead = glm::normalize(glm::dvec2(camera.direction.x, camera.direction.z));
  return glm::normalize(glm::dvec3(ahead.x, -kSunSlope, ahead.y));
}

// Radiance at elevation asin(s): G + (Z - G) f, f = 3 s^2 - 2 s^3, of the floor's G and the zenith's Z = kZenith G. The
// sky's irradiance is 2 pi (int_0^1 (1 - f) s ds G + int_0^1 f s ds Z) = 2 pi (0.15 G + 0.35 Z), and
// G = albedo / pi (sun + sky).
glm::vec3 studioSunShare() { return {1.0 - 2.0 * static_cast<double>(kFloorAlbedo) * (0.15 + 0.35 * kZenith)}; }

Image studioSky(const DirectionalLight& sun, int height) {
  const glm::dvec3 ofSun = -sun.direction.y * glm::dvec3(sun.irradiance);
  const double albedo = static_cast<double>(kFloorAlbedo);
  const glm::dvec3 floor = albedo / kPi * ofSun / glm::dvec3(studioSunShare());
  Image picture(2 * height, height, glm::vec3(floor));
  for (int row = 0; row < height / 2; ++row) {
    const double s = std::cos(kPi * (row + 0.5) / height), f = s * s * (3.0 - 2.0 * s);
    const glm::vec3 radiance(floor * (1.0 + f * (kZenith - 1.0)));
    std::fill_n(picture.pixels.begin() + static_cast<std::ptrdiff_t>(row) * 2 * height, 2 * height, radiance);
  }
  return picture;
}

bool glowsOutwards(const Scene& scene) {
  if (scene.triangleCount() > kMostTriangles || lookAround(scene, scene.main().centre()).fronts >= kRays / 2)
    return false;
  std::vector<std::array<glm::dvec3, 3>> triangles;
  std::vector<double> areas{0.0};  // summed
  for (const Mesh& mesh : scene.meshes) {
    if (scene.materials[static_cast<std::size_t>(mesh.material)].emission == glm::vec3(0.0f)) continue;
    for (std::uint32_t i = mesh.firstIndex; i + 2 < mesh.firstIndex + mesh.indexCount; i += 3) {
      const auto corner = [&](std::uint32_t k) { return glm::dvec3(scene.vertices[scene.indices[i + k]].position); };
      triangles.push_back({corner(0), corner(1), corner(2)});
      const auto& [a, b, c] = triangles.back();
      areas.push_back(areas.back() + 0.5 * glm::length(glm::cross(b - a, c - a)));
    }
  }
  int met = 0;
  const double nudge = 1e-5 * glm::length(scene.main().extent());
  for (int i = 0; i < kRays; ++i) {
    const double at = areas.back() * ((i * 37 % kRays) + 0.5) / kRays;  // another order than that of directions
    const auto found = static_cast<std::size_t>(std::ranges::lower_bound(areas, at) - areas.begin());
    const auto& [a, b, c] = triangles[std::clamp(found, std::size_t{1}, triangles.size()) - 1];
    const glm::dvec3 up = glm::normalize(glm::cross(b - a, c - a));
    const glm::dvec3 side =
        glm::normalize(glm::cross(std::abs(up.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0), up));
    const glm::dvec3 local = spread(i, true);
    const glm::dvec3 ray = local.x * side + local.y * up + local.z * glm::cross(side, up);
    if (std::isfinite(firstHit(scene, (a + b + c) / 3.0 + nudge * up, ray).distance)) ++met;
  }
  return met < kRays / 3;
}

void addFloor(Scene& scene) {
  const Bounds& all = scene.mainBounds ? *scene.mainBounds : scene.motion ? scene.motion->bounds : scene.bounds;
  const glm::dvec3 extent = all.extent(), centre = all.centre();
  const double radius = kFloorRadius * 0.5 * std::max({std::hypot(extent.x, extent.z), 0.2 * extent.y, 1e-9});
  // Slightly below, so that a model's own floor stays visible.
  const double height = all.min.y - 1e-4 * std::max(glm::length(extent), 1e-9);
  Mesh mesh;
  mesh.name = "floor";
  mesh.firstIndex = static_cast<std::uint32_t>(scene.indices.size());
  mesh.indexCount = 3 * kFloorCorners;
  mesh.material = static_cast<int>(scene.materials.size());
  const auto first = static_cast<std::uint32_t>(scene.vertices.size());
  std::vector<Vertex> vertices;
  std::vector<std::uint32_t> indices;
  const auto add = [&](double x, double z) {
    Vertex vertex;
    vertex.position = glm::vec3(centre.x + radius * x, height, centre.z + radius * z);
    vertex.normal = glm::vec3(0.0f, 1.0f, 0.0f);
    vertices.push_back(vertex);
    mesh.bounds.add(glm::dvec3(vertex.position));
  };
  add(0.0, 0.0);
  for (int i = 0; i < kFloorCorners; ++i) {
    const double angle = 2.0 * kPi * i / kFloorCorners;
    add(std::cos(angle), std::sin(angle));
    const auto corner = static_cast<std::uint32_t>(i);
    indices.insert(indices.end(), {first, first + 1 + (corner + 1) % kFloorCorners, first + 1 + corner});
  }
  const auto append = [&](std::vector<Vertex>& toVertices, std::vector<std::uint32_t>& toIndices) {
    toVertices.insert(toVertices.end(), vertices.begin(), vertices.end());
    toIndices.insert(toIndices.end(), indices.begin(), indices.end());
  };
  append(scene.vertices, scene.indices);
  Material material;
  material.name = "floor";
  material.diffuse = glm::vec3(kFloorAlbedo);
  scene.materials.push_back(material);
  scene.meshes.push_back(mesh);
  scene.bounds.add(mesh.bounds);
  if (scene.mainBounds) scene.mainBounds->add(mesh.bounds);
  if (!scene.motion) return;
  if (!scene.motion->restVertices.empty()) append(scene.motion->restVertices, scene.motion->restIndices);
  scene.motion->bounds.add(mesh.bounds);
}

}  // namespace lucerna
