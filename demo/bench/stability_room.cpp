#include "bench/stability_room.hpp"

#include <cmath>
#include <utility>
#include <vector>

namespace lucerna::demo::bench {

namespace {

class RoomScene {
 public:
  explicit RoomScene(const Room& room) {
    scene_.name = "stability";
    const double s = 10.0 * room.scale, h = 0.5 * s;
    const bool coloured = !room.closed;  // a closed room has one exact answer only where all walls are alike
    material(glm::vec3(room.albedo), room.emission);
    material(room.albedo * (coloured ? glm::vec3(0.85f, 0.15f, 0.15f) : glm::vec3(1.0f)), room.emission);
    material(room.albedo * (coloured ? glm::vec3(0.15f, 0.85f, 0.15f) : glm::vec3(1.0f)), room.emission);
    plate(room.place + glm::dvec3(0, -h, 0), {0, 0, s}, {s, 0, 0}, 0);  // floor
    plate(room.place + glm::dvec3(0, 0, -h), {s, 0, 0}, {0, s, 0}, 0);  // back
    plate(room.place + glm::dvec3(-h, 0, 0), {0, s, 0}, {0, 0, s}, 1);  // left
    plate(room.place + glm::dvec3(h, 0, 0), {0, 0, s}, {0, s, 0}, 2);   // right
    if (room.closed) {
      plate(room.place + glm::dvec3(0, h, 0), {s, 0, 0}, {0, 0, s}, 0);  // roof
      plate(room.place + glm::dvec3(0, 0, h), {0, s, 0}, {s, 0, 0}, 0);  // front
    }
    if (room.badTriangles) addBad(room.place, s);
    if (!room.closed) scene_.sun = DirectionalLight{glm::normalize(room.sun), glm::vec3(room.irradiance)};
    Camera camera;
    camera.position = room.place + room.scale * (room.closed ? glm::dvec3(0.0, 0.5, 3.0) : glm::dvec3(0.0, 1.0, 12.0));
    camera.direction = glm::normalize(glm::dvec3(0.0, -2.0, -12.0));
    scene_.cameras.push_back(camera);
  }
  Scene scene() { return std::move(scene_); }

 private:
  void material(const glm::vec3& albedo, const glm::vec3& emission) {
    Material& material = scene_.materials.emplace_back();
    material.diffuse = albedo;
    material.emission = emission;
  }

  void triangles(const std::vector<glm::dvec3>& corners, const glm::vec3& normal, int material, std::initializer_list<std::uint32_t> order) {
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
  void plate(const glm::dvec3& centre, const glm::dvec3& u, const glm::dvec3& v, int material) {
    std::vector<glm::dvec3> corners;
    for (const glm::dvec2& c : {glm::dvec2(-.5, -.5), glm::dvec2(.5, -.5), glm::dvec2(.5, .5), glm::dvec2(-.5, .5)}) corners.push_back(centre + c.x * u + c.y * v);
    triangles(corners, glm::vec3(glm::normalize(glm::cross(u, v))), material, {0, 1, 2, 0, 2, 3});
  }
  void addBad(const glm::dvec3& o, double s) {
    const glm::dvec3 a = o + 0.3 * s * glm::dvec3(-1, -1, 0), b = a + glm::dvec3(0, 0.2 * s, 0);
    triangles({a, a, a}, {0, 1, 0}, 0, {0, 1, 2});
    triangles({a, b, 0.5 * (a + b)}, {0, 0, 1}, 0, {0, 1, 2});
    triangles({o + 0.5 * s * glm::dvec3(-1, -1, -1), o + 0.5 * s * glm::dvec3(1, -1, -1), o + 0.5 * s * glm::dvec3(1, -1.0 + 1e-12, -1)}, {0, 0, 1}, 0, {0, 1, 2});
  }

  Scene scene_;
};

}  // namespace

Scene makeRoom(const Room& room) { return RoomScene(room).scene(); }

}  // namespace lucerna::demo::bench
