#include "rays/ray_scene.hpp"

#include "base/error.hpp"
#include "scene/motion.hpp"

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
  if (settings_.moves && scene.motion) settings_.bvh.moving = scene.motion->meshes;
  Bvh bvh = buildBvh(scene, settings_.bvh);
  upload(scene, bvh);
  if (!settings_.moves) return;
  bvh_ = std::move(bvh);
  refit_.emplace(*bvh_, scene);
}

void RayScene::update(const Scene& scene, std::span<const std::size_t> meshes) {
  CHECK(settings_.moves, "the scene {} was not said to move", scene.name);
  BvhRefit::Changed changed;
  if (!refit_->refit(*bvh_, scene, meshes, changed)) {
    bvh_ = buildBvh(scene, settings_.bvh);
    refit_.emplace(*bvh_, scene);
    upload(scene, *bvh_);
    return;
  }
  forRuns(changed.nodes, [&](std::size_t first, std::size_t count) {
    nodes_.upload(first * sizeof(shared::BvhNode), count * sizeof(shared::BvhNode), &bvh_->nodes[first]);
  });
  triangles_.upload(0, sizeof bvh_->magnitude, &bvh_->magnitude);
  forRuns(changed.triangles, [&](std::size_t first, std::size_t count) {
    triangles_.upload(4 * sizeof(float) + first * sizeof(shared::BvhTriangle), count * sizeof(shared::BvhTriangle),
                      &bvh_->triangles[first]);
  });
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
