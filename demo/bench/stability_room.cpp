#include "bench/stability_room.hpp"

#include <cmath>
#include <utility>

namespace lucerna::demo::bench {

int SceneParts::material(const glm::vec3& albedo, const glm::vec3& emission) {
  Material& material = scene_.materials.emplace_back();
  material.diffuse = albedo;
  material.emission = emission;
  return static_cast<int>(scene_.materials.size()) - 1;
}

void SceneParts::triangles(const std::vector<glm::dvec3>& corners, const glm::vec3& normal, int material,
                           std::initializer_list<std::uint32_t> order) {
  Mesh& mesh = scene_.meshes.emplace_back();
  mesh.firstIndex = static_cast<std::uint32_t>(scene_.indices.size());
  mesh.indexCount = static_cast<std::uint32_t>(order.size());
  mesh.material = material;
  const auto first = static_cast<std::uint32_t>(scene_.vertices.size());
  for (const glm::dvec3& p : corners) {
    scene_.vertices.push_back({glm::vec3(p), glm::vec2(0.0f), normal});
    mesh.bounds.add(p);
  }
  for (const std::uint32_t i : order) scene_.indices.push_back(first + i);
  scene_.bounds.add(mesh.bounds);
}

void SceneParts::plate(const glm::dvec3& centre, const glm::dvec3& u, const glm::dvec3& v, int material) {
  std::vector<glm::dvec3> corners;
  for (const glm::dvec2& c : {glm::dvec2(-.5, -.5), glm::dvec2(.5, -.5), glm::dvec2(.5, .5), glm::dvec2(-.5, .5)})
    corners.push_back(centre + c.x * u + c.y * v);
  triangles(corners, glm::vec3(glm::normalize(glm::cross(u, v))), material, {0, 1, 2, 0, 2, 3});
}

void SceneParts::box(const glm::dvec3& min, const glm::dvec3& max, int material) {
  const auto corner = [&](int i) {
    return glm::dvec3(i & 1 ? max.x : min.x, i & 2 ? max.y : min.y, i & 4 ? max.z : min.z);
  };
  constexpr int kFaces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  for (const auto& f : kFaces) {
    const std::vector<glm::dvec3> p{corner(f[0]), corner(f[1]), corner(f[2]), corner(f[3])};
    triangles(p, glm::vec3(glm::normalize(glm::cross(p[1] - p[0], p[2] - p[0]))), material, {0, 1, 2, 0, 2, 3});
  }
}

namespace {

void addBad(SceneParts& parts, const glm::dvec3& o, double s) {
  const glm::dvec3 a = o + 0.3 * s * glm::dvec3(-1, -1, 0), b = a + glm::dvec3(0, 0.2 * s, 0);
  parts.triangles({a, a, a}, {0, 1, 0}, 0, {0, 1, 2});
  parts.triangles({a, b, 0.5 * (a + b)}, {0, 0, 1}, 0, {0, 1, 2});
  parts.triangles({o + 0.5 * s * glm::dvec3(-1, -1, -1), o + 0.5 * s * glm::dvec3(1, -1, -1),
                   o + 0.5 * s * glm::dvec3(1, -1.0 + 1e-12, -1)},
                  {0, 0, 1}, 0, {0, 1, 2});
}

}  // namespace

Scene makeRoom(const Room& room) {
  SceneParts parts("stability");
  const double s = 10.0 * room.scale, h = 0.5 * s;
  const bool coloured = !room.closed;  // a closed room has an exact answer only if all walls are alike
  parts.material(glm::vec3(room.albedo), room.emission);
  parts.material(room.albedo * (coloured ? glm::vec3(0.85f, 0.15f, 0.15f) : glm::vec3(1.0f)), room.emission);
  parts.material(room.albedo * (coloured ? glm::vec3(0.15f, 0.85f, 0.15f) : glm::vec3(1.0f)), room.emission);
  parts.plate(room.place + glm::dvec3(0, -h, 0), {0, 0, s}, {s, 0, 0}, 0);  // floor
  parts.plate(room.place + glm::dvec3(0, 0, -h), {s, 0, 0}, {0, s, 0}, 0);  // back
  parts.plate(room.place + glm::dvec3(-h, 0, 0), {0, s, 0}, {0, 0, s}, 1);  // left
  parts.plate(room.place + glm::dvec3(h, 0, 0), {0, 0, s}, {0, s, 0}, 2);  // right
  if (room.closed) {
    parts.plate(room.place + glm::dvec3(0, h, 0), {s, 0, 0}, {0, 0, s}, 0);  // roof
    parts.plate(room.place + glm::dvec3(0, 0, h), {0, s, 0}, {s, 0, 0}, 0);  // front
  }
  if (room.badTriangles) addBad(parts, room.place, s);
  if (!room.closed) parts.scene().sun = DirectionalLight{glm::normalize(room.sun), glm::vec3(room.irradiance)};
  Camera camera;
  camera.position = room.place + room.scale * (room.closed ? glm::dvec3(0.0, 0.5, 3.0) : glm::dvec3(0.0, 1.0, 12.0));
  camera.direction = glm::normalize(glm::dvec3(0.0, -2.0, -12.0));
  parts.scene().cameras.push_back(camera);
  return std::move(parts.scene());
}

}  // namespace lucerna::demo::bench
