#include "walk/compare.hpp"

#include "gl/pass.hpp"

#include <algorithm>
#include <cmath>

namespace lucerna::demo {

namespace {

constexpr glm::ivec2 kMeter(32, 18);
constexpr float kMagnifierRadius = 80.0f, kMagnification = 8.0f;

glm::vec2 middleOfPixel(const glm::vec2& cursor) { return glm::floor(cursor) + 0.5f; }

}  // namespace

Compare::Compare(gl::ProgramLibrary& programs)
    : compose_(&programs.loadRaster("compose", "lib/fullscreen.vert", "walk/compose.frag")),
      meter_(&programs.loadRaster("exposure meter", "lib/fullscreen.vert", "walk/meter.frag")),
      noAttributes_("window picture"),
      black_("black", gl::Format::rgba32f, glm::ivec2(1)),
      meterPicture_("exposure meter", gl::Format::rgba32f, kMeter) {
  const glm::vec4 zero(0.0f);
  black_.upload(gl::Texels::rgbaFloat, &zero);
  const std::array<const gl::Texture*, 1> colors{&meterPicture_};
  meterTarget_ = gl::Framebuffer("exposure meter", colors);
}

void Compare::record(const gl::Framebuffer& target, glm::ivec2 size, const Inputs& in) const {
  const gl::RasterPass pass("window picture", target, {});
  pass.restrictTo({0, 0}, size);
  compose_->use();
  const auto bind = [&](GLuint unit, const gl::Texture* texture) { (texture ? *texture : black_).bind(unit); };
  bind(0, in.left.radiance);
  bind(1, in.layout == Layout::one ? in.left.radiance : in.right.radiance);
  bind(2, in.reference);
  bind(3, in.standardError);
  bind(4, in.left.flip);
  bind(5, in.right.flip);
  compose_->set("views", glm::ivec2(static_cast<int>(in.left.show), static_cast<int>(in.right.show)));
  compose_->set("pixels", glm::vec2(size));
  compose_->set("split", in.layout == Layout::one ? 1.0f : in.split);
  compose_->set("sideBySide", in.layout == Layout::sideBySide ? 1 : 0);
  compose_->set("zoom", in.zoom);
  compose_->set("centre", in.centre);
  compose_->set("interpolates", in.interpolates);
  compose_->set("exposure", in.exposure);
  compose_->set("errorScale", in.errorScale);
  glm::vec4 magnifier(0.0f);
  if (in.magnifier) {
    const glm::vec2 middle = middleOfPixel(*in.magnifier);
    magnifier = {middle.x, static_cast<float>(size.y) - middle.y, kMagnifierRadius, kMagnification};
  }
  compose_->set("magnifier", magnifier);
  compose_->set("bars[0]", in.left.bar);
  compose_->set("bars[1]", in.layout == Layout::one ? glm::vec4(0.0f) : in.right.bar);
  gl::drawFullScreen(noAttributes_);
}

// Middle grey: 18 % of white, where the curve of shaders/lib/tonemap.glsl gives a bright room its usual look.
std::optional<float> Compare::meteredExposure(const gl::Texture& radiance) const {
  {
    const gl::RasterPass pass("exposure meter", meterTarget_, {});
    meter_->use();
    radiance.bind(0);
    meter_->set("pixels", glm::vec2(kMeter));
    gl::drawFullScreen(noAttributes_);
  }
  double sum = 0.0, count = 0.0;
  for (const glm::vec4& texel : meterPicture_.readRgba()) {
    sum += texel.x;
    count += texel.y;
  }
  if (!(count > 0.0)) return {};
  return static_cast<float>(std::clamp(0.3 / std::exp2(sum / count), 1e-9, 1e9));
}

bool Compare::isRight(const Inputs& in, glm::ivec2 target, glm::vec2 cursor) {
  const float edge = in.layout == Layout::sideBySide ? 0.5f : in.split;
  return in.layout != Layout::one && middleOfPixel(cursor).x >= edge * static_cast<float>(target.x);
}

// Matches shaders/walk/compose.frag.
gl::Lines::Placement Compare::placementOf(const Inputs& in, glm::ivec2 target, bool right) {
  const glm::vec2 pixels(target), size(in.left.radiance ? in.left.radiance->size2d() : target);
  const bool halves = in.layout == Layout::sideBySide;
  const int edge = in.layout == Layout::one ? target.x
                   : halves                 ? target.x / 2
                                            : static_cast<int>(std::lround(in.split * pixels.x));
  const glm::vec2 region = halves ? glm::vec2(0.5f * pixels.x, pixels.y) : pixels;
  const glm::vec2 middle = halves ? glm::vec2(right ? 0.75f : 0.25f, 0.5f) * pixels : 0.5f * pixels;
  const float pixelsOfTexel = in.zoom * std::min(region.x / size.x, region.y / size.y);
  return {{right ? edge : 0, 0}, {right ? target.x - edge : edge, target.y}, middle, in.centre, pixelsOfTexel * size};
}

std::optional<glm::ivec2> Compare::pictureAt(const Inputs& in, glm::ivec2 target, glm::vec2 cursor) {
  if (!in.left.radiance) return {};
  const glm::vec2 pixels(target), size(in.left.radiance->size2d());
  const glm::vec2 pixel = middleOfPixel(cursor), fromBelow(pixel.x, pixels.y - pixel.y);
  const bool halves = in.layout == Layout::sideBySide;
  const glm::vec2 region = halves ? glm::vec2(0.5f * pixels.x, pixels.y) : pixels;
  const glm::vec2 middle =
      halves ? glm::vec2(fromBelow.x >= 0.5f * pixels.x ? 0.75f : 0.25f, 0.5f) * pixels : 0.5f * pixels;
  const float pixelsOfTexel = in.zoom * std::min(region.x / size.x, region.y / size.y);
  const glm::vec2 place = (fromBelow - middle) / pixelsOfTexel + in.centre * size;
  if (place.x < 0.0f || place.y < 0.0f || place.x >= size.x || place.y >= size.y) return {};
  return glm::ivec2(static_cast<int>(place.x), static_cast<int>(size.y) - 1 - static_cast<int>(place.y));
}

}  // namespace lucerna::demo
