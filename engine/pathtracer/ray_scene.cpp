#include "pathtracer/ray_scene.hpp"

#include "base/error.hpp"

#include <algorithm>
#include <cstring>

namespace lucerna {

static_assert(sizeof(shared::BvhNode) == 16 * BVH_NODE_TEXELS && sizeof(shared::BvhTriangle) == 16 * BVH_TRIANGLE_TEXELS);

RayScene::RayScene(const Scene& scene, const gl::Capabilities& capabilities, const Settings& settings) {
  const Bvh bvh = buildBvh(scene, settings);
  const std::size_t nodeBytes = bvh.nodes.size() * sizeof(shared::BvhNode), triangleBytes = bvh.triangles.size() * sizeof(shared::BvhTriangle);
  const auto limit = 16 * static_cast<std::size_t>(capabilities.maxTextureBufferSize);
  const std::size_t most = std::max(nodeBytes, 16 + triangleBytes);
  if (most > limit)
    throwMissingCapability("{}: its {} triangles need a buffer texture of {} bytes; this driver has at most {}", scene.name, scene.triangleCount(), most, limit);
  nodes_ = gl::BufferTexture("bvh nodes", GL_RGBA32UI, nodeBytes, bvh.nodes.data());
  // A header of one texel: the magnitude.
  std::vector<float> words(4 + triangleBytes / sizeof(float));
  words[0] = bvh.magnitude;
  if (triangleBytes > 0) std::memcpy(words.data() + 4, bvh.triangles.data(), triangleBytes);
  triangles_ = gl::BufferTexture("bvh triangles", GL_RGBA32UI, words.size() * sizeof(float), words.data());
  origin_ = bvh.origin;
  statistics_ = bvh.statistics;
}

void RayScene::bind() const {
  nodes_.bind(kNodesUnit);
  triangles_.bind(kTrianglesUnit);
}

}  // namespace lucerna
