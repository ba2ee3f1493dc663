#include "support/radiosity_scenes.hpp"

#include <array>
#include <cmath>
#include <numbers>

namespace lucerna::test {

int lambertian(SceneBuilder& builder, double reflectance, double exitance) {
  const int index = builder.material(glm::vec3(static_cast<float>(reflectance)));
  builder.materialAt(index).emission = glm::vec3(static_cast<float>(exitance / std::numbers::pi));
  return index;
}

Scene cubeRoom(int n, const std::function<int(SceneBuilder&, int wall, double u, double v)>& material) {
  SceneBuilder builder;
  struct Wall {
    glm::dvec3 centre, u, v;  // front along cross(u, v), inwards
  };
  const Wall walls[6] = {{{0, -0.5, 0}, {0, 0, 1}, {1, 0, 0}}, {{0, 0.5, 0}, {1, 0, 0}, {0, 0, 1}},
                         {{0, 0, -0.5}, {1, 0, 0}, {0, 1, 0}}, {{0, 0, 0.5}, {0, 1, 0}, {1, 0, 0}},
                         {{-0.5, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0.5, 0, 0}, {0, 0, 1}, {0, 1, 0}}};
  for (int w = 0; w < 6; ++w)
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        const double u = (i + 0.5) / n, v = (j + 0.5) / n;
        const int m = material(builder, w, u, v);
        builder.plate(walls[w].centre + (u - 0.5) * walls[w].u + (v - 0.5) * walls[w].v,
                      walls[w].u / static_cast<double>(n), walls[w].v / static_cast<double>(n), m);
      }
  return builder.scene();
}

Scene cubeRoom(int n, double reflectance, double exitance) {
  int index = -1;
  return cubeRoom(n, [&](SceneBuilder& builder, int, double, double) {
    return index < 0 ? index = lambertian(builder, reflectance, exitance) : index;
  });
}

void addSphere(SceneBuilder& builder, double radius, int level, bool inside,
               const std::function<int(const glm::dvec3& centroid)>& material) {
  const double g = 0.5 * (1.0 + std::sqrt(5.0));
  const std::array<glm::dvec3, 12> p{{{-1, g, 0},
                                      {1, g, 0},
                                      {-1, -g, 0},
                                      {1, -g, 0},
                                      {0, -1, g},
                                      {0, 1, g},
                                      {0, -1, -g},
                                      {0, 1, -g},
                                      {g, 0, -1},
                                      {g, 0, 1},
                                      {-g, 0, -1},
                                      {-g, 0, 1}}};
  const int faces[20][3] = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                            {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                            {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  std::function<void(glm::dvec3, glm::dvec3, glm::dvec3, int)> divide = [&](glm::dvec3 a, glm::dvec3 b, glm::dvec3 c,
                                                                            int depth) {
    if (depth > 0) {
      const glm::dvec3 ab = glm::normalize(a + b), bc = glm::normalize(b + c), ca = glm::normalize(c + a);
      divide(a, ab, ca, depth - 1);
      divide(b, bc, ab, depth - 1);
      divide(c, ca, bc, depth - 1);
      divide(ab, bc, ca, depth - 1);
      return;
    }
    if (inside) std::swap(b, c);
    builder.triangle(radius * a, radius * b, radius * c, material((a + b + c) / 3.0 * radius));
  };
  for (const auto& f : faces)
    divide(glm::normalize(p[static_cast<std::size_t>(f[0])]), glm::normalize(p[static_cast<std::size_t>(f[1])]),
           glm::normalize(p[static_cast<std::size_t>(f[2])]), level);
}

RadiositySolutionSettings wholeTriangles(double error) {
  RadiositySolutionSettings settings;
  settings.wholeTriangles = true;
  settings.hemicubes.resolution = 32;
  settings.error = error;
  return settings;
}

HemicubeSettings pixelsAlone(int resolution) {
  HemicubeSettings settings;
  settings.resolution = resolution;
  settings.exactPixels = 0;
  return settings;
}

Scene dark(Scene scene) {
  scene.sun.reset();
  return scene;
}

void addBox(SceneBuilder& builder, const Box& box, int material, bool inside, bool bottom) {
  const glm::dvec3 centre = 0.5 * (box.low + box.high), size = box.high - box.low;
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) {
      if (axis == 1 && side < 0.0 && !bottom) continue;
      glm::dvec3 at = centre, u(0.0), v(0.0);
      at[axis] += 0.5 * side * size[axis];
      u[(axis + 1) % 3] = size[(axis + 1) % 3];
      v[(axis + 2) % 3] = size[(axis + 2) % 3];
      if ((side > 0.0) == inside) std::swap(u, v);
      builder.plate(at, u, v, material);
    }
}

std::size_t countTJunctions(const RadiosityMesh& mesh) {
  std::vector<bool> used(mesh.points.size(), false);
  for (const Patch& patch : mesh.patches)
    for (const std::uint32_t p : patch.point) used[p] = true;
  std::size_t count = 0;
  for (std::size_t p = 0; p < mesh.points.size(); ++p) {
    bool inside = false;
    for (std::size_t i = 0; used[p] && i < mesh.patches.size() && !inside; ++i) {
      const auto c = mesh.corners(mesh.patches[i]);
      for (std::size_t k = 0; k < 3; ++k) {
        if (mesh.patches[i].point[k] == p || mesh.patches[i].point[(k + 1) % 3] == p) continue;
        const glm::dvec3 along = c[(k + 1) % 3] - c[k], to = mesh.points[p] - c[k];
        const double t = glm::dot(to, along) / glm::dot(along, along);
        if (t > 1e-6 && t < 1.0 - 1e-6 && glm::length(to - t * along) < 1e-6 * glm::length(along)) inside = true;
      }
    }
    count += inside;
  }
  return count;
}

}  // namespace lucerna::test
