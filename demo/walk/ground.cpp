#include "walk/ground.hpp"

#include <algorithm>

namespace lucerna::demo {

bool wantsGround(const Scene& scene) { return scene.defaultSun; }

void addGround(Scene& scene) {
  const glm::dvec3 extent = scene.bounds.extent(), centre = scene.bounds.centre();
  const double half = 1.5 * std::max({extent.x, extent.z, 0.1 * extent.y, 1e-9});
  const double height =
      scene.bounds.min.y -
      1e-4 * std::max(glm::length(extent), 1e-9);  // slightly below, so that a model's own floor stays visible
  const auto first = static_cast<std::uint32_t>(scene.vertices.size());
  Mesh mesh;
  mesh.name = "ground";
  mesh.firstIndex = static_cast<std::uint32_t>(scene.indices.size());
  mesh.indexCount = 6;
  mesh.material = static_cast<int>(scene.materials.size());
  for (const glm::dvec2& corner :
       {glm::dvec2(-1.0, -1.0), glm::dvec2(-1.0, 1.0), glm::dvec2(1.0, 1.0), glm::dvec2(1.0, -1.0)}) {
    Vertex vertex;
    vertex.position = glm::vec3(centre.x + half * corner.x, height, centre.z + half * corner.y);
    vertex.normal = glm::vec3(0.0f, 1.0f, 0.0f);
    scene.vertices.push_back(vertex);
    mesh.bounds.add(glm::dvec3(vertex.position));
  }
  for (const std::uint32_t corner : {0u, 1u, 2u, 0u, 2u, 3u}) scene.indices.push_back(first + corner);
  Material material;
  material.name = "ground";
  material.diffuse = glm::vec3(0.4f);
  scene.materials.push_back(material);
  scene.meshes.push_back(mesh);
  scene.bounds.add(mesh.bounds);
}

}  // namespace lucerna::demo
