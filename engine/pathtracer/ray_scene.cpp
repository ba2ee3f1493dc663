#include "pathtracer/ray_scene.hpp"

#include "base/error.hpp"

#include <algorithm>

namespace lucerna {

RayScene::RayScene(const Scene& scene, const gl::Capabilities& capabilities, const Settings& settings) {
  const Bvh bvh = buildBvh(scene, settings);
  const std::size_t nodeBytes = bvh.nodes.size() * sizeof(shared::BvhNode), triangleBytes = bvh.triangles.size() * sizeof(shared::BvhTriangle);
  const auto limit = static_cast<std::size_t>(capabilities.maxShaderStorageBlockSize);
  if (std::max(nodeBytes + sizeof bvh.header, triangleBytes) > limit)
    throwMissingCapability("{}: its {} triangles need shader storage blocks of {} bytes; this driver has at most {}", scene.name, scene.triangleCount(),
                           std::max(nodeBytes + sizeof bvh.header, triangleBytes), limit);
  nodes_ = gl::Buffer("bvh nodes", sizeof bvh.header + nodeBytes, nullptr, GL_STATIC_DRAW);
  nodes_.upload(0, sizeof bvh.header, &bvh.header);
  nodes_.upload(sizeof bvh.header, nodeBytes, bvh.nodes.data());
  // An empty scene still binds something.
  triangles_ = gl::Buffer("bvh triangles", std::max(triangleBytes, sizeof(shared::BvhTriangle)), nullptr, GL_STATIC_DRAW);
  if (triangleBytes > 0) triangles_.upload(0, triangleBytes, bvh.triangles.data());
  origin_ = bvh.origin;
  statistics_ = bvh.statistics;
}

void RayScene::bind() const {
  nodes_.bind(GL_SHADER_STORAGE_BUFFER, kNodesBinding);
  triangles_.bind(GL_SHADER_STORAGE_BUFFER, kTrianglesBinding);
}

}  // namespace lucerna
