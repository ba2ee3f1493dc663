#include "rays/ray_scene.hpp"

#include "base/error.hpp"

#include <algorithm>
#include <cstring>

namespace lucerna {

static_assert(sizeof(shared::BvhNode) == 16 * BVH_NODE_TEXELS &&
              sizeof(shared::BvhTriangle) == 16 * BVH_TRIANGLE_TEXELS);
static_assert(BVH_MAX_DEPTH * 2 * sizeof(GLuint) * 64 <= 1 << 15,
              "a group's stacks fit in the shared memory that OpenGL 4.3 guarantees");

RayScene::RayScene(const Scene& scene, const gl::Capabilities& capabilities, const Settings& settings)
    : settings_(settings),
      limit_(16 * static_cast<std::size_t>(capabilities.maxTextureBufferSize)),
      sharedStack_(settings.sharedStack.value_or(!capabilities.softwareRenderer)) {
  Bvh bvh = buildBvh(scene, settings_.bvh);
  upload(scene, bvh);
  if (settings_.moves) bvh_ = std::move(bvh);
}

void RayScene::update(const Scene& scene) {
  CHECK(settings_.moves, "the scene {} was not said to move", scene.name);
  if (!refitBvh(*bvh_, scene)) bvh_ = buildBvh(scene, settings_.bvh);
  upload(scene, *bvh_);
}

void RayScene::upload(const Scene& scene, const Bvh& bvh) {
  // Texel 0 of the triangles holds the magnitude.
  std::vector<float> words(4 + bvh.triangles.size() * sizeof(shared::BvhTriangle) / sizeof(float));
  words[0] = bvh.magnitude;
  if (!bvh.triangles.empty())
    std::memcpy(words.data() + 4, bvh.triangles.data(), bvh.triangles.size() * sizeof(shared::BvhTriangle));
  const std::size_t nodeBytes = bvh.nodes.size() * sizeof(shared::BvhNode),
                    triangleBytes = words.size() * sizeof(float);
  if (std::max(nodeBytes, triangleBytes) > limit_)
    throwMissingCapability(
        "{}: its {} triangles need a buffer texture of {} bytes; this driver has at most {} "
        "(GL_MAX_TEXTURE_BUFFER_SIZE)",
        scene.name, scene.triangleCount(), std::max(nodeBytes, triangleBytes), limit_);
  const auto put = [](gl::BufferTexture& texture, const char* name, std::size_t bytes, const void* data) {
    if (texture.bytes() == bytes) texture.upload(0, bytes, data);
    else texture = gl::BufferTexture(name, gl::Format::rgba32ui, bytes, data);
  };
  put(nodes_, "bvh nodes", nodeBytes, bvh.nodes.data());
  put(triangles_, "bvh triangles", triangleBytes, words.data());
  origin_ = bvh.origin;
  statistics_ = bvh.statistics;
}

int RayScene::sharedStack() const {
  if (!sharedStack_) return 0;
  return settings_.moves ? BVH_MAX_DEPTH : std::min((std::max(statistics_.depth, 1) + 1) / 2 * 2, BVH_MAX_DEPTH);
}

void RayScene::bind() const {
  nodes_.bind(kNodesUnit);
  triangles_.bind(kTrianglesUnit);
}

}  // namespace lucerna
