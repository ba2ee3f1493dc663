#include "shared/stage_view.hpp"

#include "base/statistics.hpp"
#include "gl/draw.hpp"
#include "gl/pass.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <vector>

namespace lucerna::demo {

namespace {

enum Shape { flat, layered, volume, threeVolumes };  // SHAPE of shaders/walk/stage.frag

Shape shapeOf(const StagePicture& picture) {
  if (picture.green) return threeVolumes;
  switch (picture.texture->kind()) {
    case gl::TextureKind::volume: return volume;
    case gl::TextureKind::array: return layered;
    default: return flat;
  }
}

}  // namespace

void StageView::draw(const StagePicture& picture, int layer, float factor, const Bounds& bounds) {
  const gl::Texture* texture = picture.texture;
  // Shadow maps are comparison textures, whose depths cannot be read directly: copy them first.
  if (picture.kind == StagePicture::Kind::depth && shapeOf(picture) == flat) {
    if (!copy_.id() || copy_.size2d() != texture->size2d() || copy_.format() != texture->format())
      copy_ = gl::Texture("depth to be looked at", texture->format(), texture->size2d());
    gl::copyTexels(*texture, {0, 0}, copy_, {0, 0}, texture->size2d());
    texture = &copy_;
  }
  if (!result_.id() || result_.size2d() != texture->size2d()) {
    result_ = gl::Texture("stage view", gl::Format::rgba32f, texture->size2d());
    const std::array<const gl::Texture*, 1> colors{&result_};
    target_ = gl::Framebuffer("stage view", colors);
  }
  const gl::Program& program =
      programs_.loadRaster("stage view", "lib/fullscreen.vert", "walk/stage.frag", {{"SHAPE", shapeOf(picture)}});
  const gl::RasterPass pass("stage view", target_, {});
  program.use();
  texture->bind(0);
  if (picture.green) picture.green->bind(1), picture.blue->bind(2);
  program.set("layer", std::clamp(layer, 0, texture->size().z - 1));
  program.set("kind", static_cast<int>(picture.kind));
  program.set("factor", factor);
  program.set("minimum", glm::vec3(bounds.min));
  program.set("extent", glm::max(glm::vec3(bounds.extent()), glm::vec3(1e-30f)));
  gl::drawFullScreen(noAttributes_);
}

const gl::Texture& StageView::recordUnscaled(const StagePicture& picture, int layer, const Bounds& bounds) {
  draw(picture, layer, 1.0f, bounds);
  return result_;
}

const gl::Texture& StageView::record(const StagePicture& picture, int layer, float factor, const Bounds& bounds) {
  // Light has no fixed scale: of the lit texels, one in ten becomes brighter than white.
  const std::string measured = fmt::format("{} {}", picture.name, layer);
  if (picture.isLight() && measured != measured_) {
    std::vector<double> lit;
    for (const glm::vec4& texel : recordUnscaled(picture, layer, bounds).readRgba())
      if (const float most = std::max({texel.x, texel.y, texel.z}); most > 0.0f) lit.push_back(most);
    usualFactor_ = lit.empty() ? 1.0f : static_cast<float>(1.0 / percentile(lit, 0.9));
    measured_ = measured;
  }
  draw(picture, layer, picture.isLight() ? factor * usualFactor_ : 1.0f, bounds);
  return result_;
}

}  // namespace lucerna::demo
