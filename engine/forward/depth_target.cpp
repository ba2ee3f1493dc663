#include "forward/depth_target.hpp"

#include <algorithm>
#include <utility>

namespace lucerna {

DepthTarget::DepthTarget(const std::string& name, gl::Texture depth)
    : name_(name), depth_(std::move(depth)), framebuffer_(name, {}, &depth_) {}

void DepthTarget::record(const GpuScene& scene, const SurfacePrograms& programs, const gl::RasterState& state,
                         std::span<const View> views) {
  const bool viewsStay = std::ranges::equal(views, views_);
  if (viewsStay && poses_ == scene.poses()) return;
  if (!viewsStay) stillWithout_ = 0;
  views_.assign(views.begin(), views.end());
  poses_ = scene.poses();
  const std::size_t moving = scene.movingMeshes();
  const gl::RasterPass pass(name_, framebuffer_, state);
  if (!viewsStay || moving == 0) {
    pass.clearDepth();
    scene.drawDepth(programs, GpuScene::Meshes::all);
    return;
  }
  if (stillWithout_ != moving) {
    if (!still_) still_ = depth_.sameShape(name_ + " of what stands still");
    pass.clearDepth();
    scene.drawDepth(programs, GpuScene::Meshes::still);
    gl::copyTexels(depth_, *still_);
    stillWithout_ = moving;
  } else {
    gl::copyTexels(*still_, depth_);
  }
  scene.drawDepth(programs, GpuScene::Meshes::moving);
}

}  // namespace lucerna
