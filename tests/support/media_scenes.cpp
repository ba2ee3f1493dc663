#include "support/media_scenes.hpp"

#include <array>
#include <cmath>

namespace lucerna::test {

namespace {
void addMesh(Scene& scene, const std::vector<std::array<glm::dvec3, 3>>& triangles, int material) {
  Mesh mesh;
  mesh.material = material;
  mesh.firstIndex = static_cast<std::uint32_t>(scene.indices.size());
  for (const auto& t : triangles) {
    const glm::dvec3 normal = glm::normalize(glm::cross(t[1] - t[0], t[2] - t[0]));
    for (const glm::dvec3& p : t) {
      scene.indices.push_back(static_cast<std::uint32_t>(scene.vertices.size()));
      Vertex v;
      v.position = glm::vec3(p);
      v.normal = glm::vec3(normal);
      scene.vertices.push_back(v);
      mesh.bounds.add(p);
    }
  }
  mesh.indexCount = static_cast<std::uint32_t>(scene.indices.size()) - mesh.firstIndex;
  scene.bounds.add(mesh.bounds);
  scene.meshes.push_back(mesh);
}
}  // namespace

void addBox(Scene& scene, const glm::dvec3& min, const glm::dvec3& max, int material) {
  const auto corner = [&](int i) {
    return glm::dvec3(i & 1 ? max.x : min.x, i & 2 ? max.y : min.y, i & 4 ? max.z : min.z);
  };
  const int quads[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  std::vector<std::array<glm::dvec3, 3>> triangles;
  for (const auto& q : quads) {
    triangles.push_back({corner(q[0]), corner(q[1]), corner(q[2])});
    triangles.push_back({corner(q[0]), corner(q[2]), corner(q[3])});
  }
  addMesh(scene, triangles, material);
}

void addSphere(Scene& scene, const glm::dvec3& centre, double radius, int level, int material) {
  std::vector<std::array<glm::dvec3, 3>> triangles;
  for (int i = 0; i < 8; ++i) {
    const glm::dvec3 x(i & 1 ? -1.0 : 1.0, 0.0, 0.0), y(0.0, i & 2 ? -1.0 : 1.0, 0.0), z(0.0, 0.0, i & 4 ? -1.0 : 1.0);
    if (x.x * y.y * z.z > 0.0) triangles.push_back({x, y, z});
    else triangles.push_back({x, z, y});
  }
  for (int l = 0; l < level; ++l) {
    std::vector<std::array<glm::dvec3, 3>> finer;
    for (const auto& t : triangles) {
      const glm::dvec3 ab = glm::normalize(t[0] + t[1]), bc = glm::normalize(t[1] + t[2]),
                       ca = glm::normalize(t[2] + t[0]);
      finer.insert(finer.end(), {{t[0], ab, ca}, {ab, t[1], bc}, {ca, bc, t[2]}, {ab, bc, ca}});
    }
    triangles = finer;
  }
  double volume = 0.0;
  for (const auto& t : triangles) volume += glm::dot(t[0], glm::cross(t[1], t[2])) / 6.0;
  const double scale = radius * std::cbrt(4.0 * M_PI / 3.0 / volume);
  for (auto& t : triangles)
    for (glm::dvec3& p : t) p = centre + scale * p;
  addMesh(scene, triangles, material);
}

int addBoundary(Scene& scene, Bsdf bsdf, double ior, int interior, int priority) {
  Material m;
  m.bsdf = bsdf;
  m.ior = static_cast<float>(ior);
  m.interior = interior;
  m.priority = priority;
  m.diffuse = glm::vec3(0.0f);
  scene.materials.push_back(m);
  return static_cast<int>(scene.materials.size()) - 1;
}

Medium homogeneous(const glm::dvec3& scattering, const glm::dvec3& absorption, double g) {
  Medium medium;
  medium.scattering = glm::vec3(scattering);
  medium.absorption = glm::vec3(absorption);
  medium.anisotropy = glm::vec3(static_cast<float>(g));
  return medium;
}
Medium grey(double albedo, double depth, double g) {
  return homogeneous(glm::dvec3(albedo * depth), glm::dvec3((1.0 - albedo) * depth), g);
}

Environment halves() {
  Environment environment;
  environment.radiance = glm::vec3(1.0f);
  Image picture(1, 2);
  picture.at(0, 0) = glm::vec3(1.0f, 0.0f, 0.0f);
  picture.at(0, 1) = glm::vec3(0.0f, 1.0f, 0.0f);
  environment.picture = picture;
  return environment;
}

Environment constantEnvironment(double radiance) {
  Environment environment;
  environment.radiance = glm::vec3(static_cast<float>(radiance));
  return environment;
}

Camera cameraAt(const glm::dvec3& from, const glm::dvec3& to, double fov) {
  Camera camera;
  camera.position = from;
  camera.direction = glm::normalize(to - from);
  camera.up = std::abs(camera.direction.y) > 0.9 ? glm::dvec3(0.0, 0.0, 1.0) : glm::dvec3(0.0, 1.0, 0.0);
  camera.verticalFov = fov;
  return camera;
}

Scene slab(const Medium& medium, double ior, double cosine, double halfWidth) {
  Scene scene;
  scene.name = "slab";
  scene.media = {medium};
  addBoundary(scene, ior == 1.0 ? Bsdf::none : Bsdf::dielectric, ior, 0);
  addBox(scene, {-halfWidth, -0.5, -halfWidth}, {halfWidth, 0.5, halfWidth}, 0);
  scene.environment = halves();
  const glm::dvec3 at(0.013, 0.5, 0.007);  // off the diagonals of the box's faces
  scene.cameras = {cameraAt(at + 2.0 * glm::dvec3(std::sqrt(1.0 - cosine * cosine), cosine, 0.0), at)};
  return scene;
}

}  // namespace lucerna::test
