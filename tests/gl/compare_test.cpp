// The window's picture (shaders/walk/compose.frag) by double precision.
#include "walk/compare.hpp"

#include "base/image.hpp"
#include "gl/read_pictures.hpp"
#include "support/gl_fixture.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

namespace lucerna::test {
namespace {

using demo::Compare;
using demo::Layout;

class CompareGl : public SharedProgramsTest {
 protected:
  /// Rows of texels from the bottom, radiance 0 to 2.
  static std::vector<glm::vec4> texels(glm::ivec2 size) {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> in(0.0f, 2.0f);
    std::vector<glm::vec4> all(static_cast<std::size_t>(size.x * size.y));
    for (glm::vec4& texel : all) texel = {in(random), in(random), in(random), 1.0f};
    return all;
  }
  /// What the window shows of them, 0 to 1, rows from the bottom.
  std::vector<glm::dvec3> shown(const std::vector<glm::vec4>& all, glm::ivec2 size, glm::ivec2 target,
                                const Compare::Inputs& inputs) {
    gl::Texture radiance("radiance", gl::Format::rgba32f, size), picture("picture", gl::Format::rgba8, target);
    radiance.upload(gl::Texels::rgbaFloat, all.data());
    const std::array<const gl::Texture*, 1> colors{&picture};
    const gl::Framebuffer framebuffer("picture", colors);
    Compare::Inputs both = inputs;
    both.left.radiance = both.right.radiance = &radiance;
    Compare(library()).record(framebuffer, target, both);
    const Bitmap bitmap = gl::readBitmap(picture, target);
    std::vector<glm::dvec3> result;
    for (int y = target.y - 1; y >= 0; --y)
      for (int x = 0; x < target.x; ++x) {
        const std::uint8_t* c = &bitmap.rgba[static_cast<std::size_t>(4 * (y * target.x + x))];
        result.push_back(glm::dvec3(c[0], c[1], c[2]) / 255.0);
      }
    return result;
  }
  /// A texel as it is shown; those beyond the edge are the edge's.
  static glm::dvec3 texelShown(const std::vector<glm::vec4>& all, glm::ivec2 size, glm::ivec2 at) {
    at = glm::clamp(at, glm::ivec2(0), size - 1);
    const Image one(1, 1, glm::vec3(all[static_cast<std::size_t>(at.y * size.x + at.x)]));
    const Bitmap bitmap = toneMapped(one, 0.5f);
    return glm::dvec3(bitmap.rgba[0], bitmap.rgba[1], bitmap.rgba[2]) / 255.0;
  }
  static double worst(const std::vector<glm::dvec3>& a, const std::vector<glm::dvec3>& b) {
    double largest = 0.0;
    for (std::size_t k = 0; k < a.size(); ++k)
      for (int c = 0; c < 3; ++c) largest = std::max(largest, std::abs(a[k][c] - b[k][c]));
    return largest;
  }
};

TEST_F(CompareGl, ACoarsePictureIsInterpolatedAsItIsShownAndFillsTheTarget) {
  const glm::ivec2 size(25, 14), target(99, 56);  // 3.96 pixels a texel across, 4 upwards
  const std::vector<glm::vec4> all = texels(size);
  Compare::Inputs inputs;
  inputs.exposure = 0.5f;
  inputs.interpolates = true;
  std::vector<glm::dvec3> smooth, whole;
  for (int y = 0; y < target.y; ++y)
    for (int x = 0; x < target.x; ++x) {
      const glm::dvec2 place = (glm::dvec2(x, y) + 0.5) * glm::dvec2(size) / glm::dvec2(target);
      const glm::dvec2 corner = glm::floor(place - 0.5), share = place - 0.5 - corner;
      const auto at = [&](int i, int j) { return texelShown(all, size, glm::ivec2(corner) + glm::ivec2(i, j)); };
      smooth.push_back(glm::mix(glm::mix(at(0, 0), at(1, 0), share.x), glm::mix(at(0, 1), at(1, 1), share.x), share.y));
      whole.push_back(texelShown(all, size, glm::ivec2(place)));
    }
  EXPECT_LT(worst(shown(all, size, target, inputs), smooth), 1.6 / 255.0);  // two roundings to a byte
  EXPECT_GT(worst(smooth, whole), 0.2);
  // Otherwise texels are squares, here of exactly four pixels.
  inputs.interpolates = false;
  const std::vector<glm::dvec3> squares = shown(all, size, {100, 56}, inputs);
  for (int y = 0; y < 56; ++y)
    for (int x = 0; x < 100; ++x) {
      const glm::dvec3 expected = texelShown(all, size, {x / 4, y / 4});
      EXPECT_LT(glm::length(squares[static_cast<std::size_t>(y * 100 + x)] - expected), 1.6 / 255.0) << x << " " << y;
    }
}

TEST_F(CompareGl, SideBySideACoarsePictureKeepsItsProportions) {
  const glm::ivec2 size(16, 9), target(64, 36);  // each half as wide as the picture would be: bars above and below
  Compare::Inputs inputs;
  inputs.layout = Layout::sideBySide;
  inputs.interpolates = true;
  const std::vector<glm::dvec3> halves = shown(texels(size), size, target, inputs);
  const glm::dvec3 grey(0.08);
  for (const int x : {4, 20, 40, 60}) {
    for (const int y : {0, 8, 27, 35})
      EXPECT_LT(glm::length(halves[static_cast<std::size_t>(y * 64 + x)] - grey), 0.01) << x << " " << y;
    for (const int y : {10, 18, 25})
      EXPECT_GT(glm::length(halves[static_cast<std::size_t>(y * 64 + x)] - grey), 0.01) << x << " " << y;
  }
}

}  // namespace
}  // namespace lucerna::test
