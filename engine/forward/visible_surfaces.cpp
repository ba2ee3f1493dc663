#include "forward/visible_surfaces.hpp"

#include "gl/pass.hpp"
#include "shared/bindings.h"

#include <array>

namespace lucerna {

namespace {}

VisibleSurfaces::VisibleSurfaces(gl::ProgramLibrary& programs, const GpuScene& scene, const gl::Texture& depth) {
  const auto load = [&](const char* name, bool masked) {
    return &programs.loadRaster(name, "forward/surface.vert", "forward/visible.frag", scene.materialFlags(masked));
  };
  programs_.opaque = load("visible surfaces opaque", false);
  if (scene.features().alphaMasks) programs_.masked = load("visible surfaces masked", true);
  resize(depth);
}

void VisibleSurfaces::resize(const gl::Texture& depth) {
  depth_ = &depth;
  normal_ = gl::Texture("visible normals", gl::Format::rgba16f, depth.size2d());
  const std::array<const gl::Texture*, 1> colors{&normal_};
  target_ = gl::Framebuffer("visible surfaces", colors, &depth);
}

void VisibleSurfaces::record(const GpuScene& scene, const GpuScene::View& view) const {
  gl::RasterState state;
  state.depth = gl::Depth::lessWrite;
  const gl::RasterPass pass("visible surfaces", target_, state);
  pass.clearDepth();  // normals are only read where depth has a surface
  scene.draw(programs_, view);
}

void VisibleSurfaces::bind(const gl::Program& program, const glm::mat4& worldFromClip) const {
  depth_->bind(UNIT_VISIBLE_DEPTH);
  normal_.bind(UNIT_VISIBLE_NORMAL);
  program.set("worldFromClip", worldFromClip);
}

}  // namespace lucerna
