#include "support/small_scenes.hpp"

#include <cmath>

namespace lucerna::test {

SceneBuilder::SceneBuilder() {
  scene_.name = "test";
  sun({0.0, -1.0, 0.0}, glm::vec3(1.0f));
}

int SceneBuilder::material(const glm::vec3& albedo) {
  Material& material = scene_.materials.emplace_back();
  material.diffuse = albedo;
  return static_cast<int>(scene_.materials.size()) - 1;
}

int SceneBuilder::texture(int width, int height, std::vector<std::uint8_t> rgba, bool hasAlpha) {
  Texture& texture = scene_.textures.emplace_back();
  texture.file = "made in memory";
  texture.bitmap.width = width;
  texture.bitmap.height = height;
  texture.bitmap.rgba = std::move(rgba);
  texture.bitmap.hasAlpha = hasAlpha;
  return static_cast<int>(scene_.textures.size()) - 1;
}

void SceneBuilder::plate(const glm::dvec3& centre, const glm::dvec3& edgeU, const glm::dvec3& edgeV, int material,
                         float normalSign) {
  Mesh& mesh = scene_.meshes.emplace_back();
  mesh.firstIndex = static_cast<std::uint32_t>(scene_.indices.size());
  mesh.indexCount = 6;
  mesh.material = material;
  const auto first = static_cast<std::uint32_t>(scene_.vertices.size());
  const glm::vec3 normal = normalSign * glm::vec3(glm::normalize(glm::cross(edgeU, edgeV)));
  for (const glm::dvec2& corner : {glm::dvec2(0, 0), glm::dvec2(1, 0), glm::dvec2(1, 1), glm::dvec2(0, 1)}) {
    const glm::dvec3 p = centre + (corner.x - 0.5) * edgeU + (corner.y - 0.5) * edgeV;
    scene_.vertices.push_back({glm::vec3(p), glm::vec2(corner), normal});
    mesh.bounds.add(p);
  }
  for (const std::uint32_t i : {0u, 1u, 2u, 0u, 2u, 3u}) scene_.indices.push_back(first + i);
  scene_.bounds.add(mesh.bounds);
}

void SceneBuilder::triangle(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, int material) {
  Mesh& mesh = scene_.meshes.emplace_back();
  mesh.firstIndex = static_cast<std::uint32_t>(scene_.indices.size());
  mesh.indexCount = 3;
  mesh.material = material;
  const glm::vec3 normal(glm::normalize(glm::cross(b - a, c - a)));
  for (const glm::dvec3& p : {a, b, c}) {
    scene_.indices.push_back(static_cast<std::uint32_t>(scene_.vertices.size()));
    scene_.vertices.push_back({glm::vec3(p), glm::vec2(0.0f), normal});
    mesh.bounds.add(p);
  }
  scene_.bounds.add(mesh.bounds);
}

void SceneBuilder::sun(const glm::dvec3& direction, const glm::vec3& irradiance) {
  scene_.sun = DirectionalLight{glm::normalize(direction), irradiance};
}

Camera lookingAt(const glm::dvec3& position, const glm::dvec3& target, double verticalFov) {
  Camera camera;
  camera.position = position;
  camera.direction = glm::normalize(target - position);
  camera.up = std::abs(camera.direction.y) < 0.99 ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, -1);
  camera.verticalFov = verticalFov;
  return camera;
}

Scene openBox(double scale) {
  SceneBuilder builder;
  const int grey = builder.material(glm::vec3(0.7f)), red = builder.material({0.6f, 0.1f, 0.1f}),
            green = builder.material({0.1f, 0.6f, 0.1f});
  const double s = 10.0 * scale, h = 0.5 * s;
  builder.plate({0, -h, 0}, {0, 0, s}, {s, 0, 0}, grey);  // floor
  builder.plate({0, 0, -h}, {s, 0, 0}, {0, s, 0}, grey);  // back
  builder.plate({-h, 0, 0}, {0, s, 0}, {0, 0, s}, red);  // left
  builder.plate({h, 0, 0}, {0, 0, s}, {0, s, 0}, green);  // right
  builder.sun({-0.35, -1.0, -0.1}, {3.0f, 2.9f, 2.7f});
  return builder.scene();
}

Camera openBoxCamera(double scale) {
  return lookingAt(scale * glm::dvec3(0.0, 1.0, 12.0), glm::dvec3(0.0, -scale, 0.0));
}

}  // namespace lucerna::test
