// The light tree's nodes against sums in double precision over the texels below them
// (shaders/irradiance_cache/gather/tree.glsl).
#include "irradiance_cache/light_tree.hpp"
#include "support/gl_fixture.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <random>

namespace lucerna {
namespace {

constexpr int kSize = 70, kLayers = 2, kDepth = 7;  // not a power of two: 128 texels a side, of which 70 are the map's

struct Texel {
  glm::dvec3 position, normal, flux;
  double area;
  bool lit;
};

class LightTreeTest : public test::SharedProgramsTest {
 protected:
  void SetUp() override {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    std::normal_distribution<double> any;
    texels_.resize(kSize * kSize * kLayers);
    for (Texel& t : texels_) {
      t.position = 100.0 * glm::dvec3(unit(random), unit(random), unit(random));
      t.normal = glm::normalize(glm::dvec3(any(random), any(random), any(random)));
      t.flux = 1e3 * glm::dvec3(unit(random), 0.1 * unit(random), unit(random));
      t.area = unit(random);
      t.lit = unit(random) < 0.6;
    }
    // A flat quarter, and nothing lit in another.
    for (int y = 0; y < 16; ++y)
      for (int x = 0; x < 16; ++x) {
        at(x, y, 0).normal = {0.6, 0.0, 0.8};
        at(x + 16, y, 0).lit = false;
      }
  }
  Texel& at(int x, int y, int layer) { return texels_[static_cast<std::size_t>((layer * kSize + y) * kSize + x)]; }
  gl::Texture textureOf(const char* name, const std::function<glm::vec4(const Texel&)>& of) const {
    std::vector<glm::vec4> data;
    for (const Texel& t : texels_) data.push_back(of(t));
    gl::Texture texture(name, gl::Format::rgba32f, {kSize, kSize, kLayers}, {}, 1, gl::TextureKind::array);
    texture.upload(gl::Texels::rgbaFloat, data.data());
    return texture;
  }

  /// Sums over the lit texels below a node; the radius as the tree bounds it, child by child.
  struct Sums {
    glm::dvec3 position{0.0}, normal{0.0}, flux{0.0};
    glm::dmat3 moments{0.0};
    double area = 0.0, weight = 0.0, radius = -1.0;
    glm::dvec3 centre() const { return position / weight; }
  };
  Sums sums(int layer, int x, int y, int texelsAcross) {
    Sums sum;
    if (texelsAcross == 1) {
      if (x >= kSize || y >= kSize || !at(x, y, layer).lit) return sum;
      const Texel& t = at(x, y, layer);
      sum.weight = t.flux.x + t.flux.y + t.flux.z;
      sum.position = sum.weight * t.position;
      sum.normal = sum.weight * t.normal;
      sum.moments = sum.weight * glm::outerProduct(t.normal, t.normal);
      sum.flux = t.flux;
      sum.area = t.area;
      sum.radius = 0.0;
      return sum;
    }
    Sums children[4];
    for (int i = 0; i < 4; ++i) {
      const int half = texelsAcross / 2;
      const Sums& child = children[i] = sums(layer, x + (i & 1) * half, y + (i >> 1) * half, half);
      sum.weight += child.weight;
      sum.position += child.position;
      sum.normal += child.normal;
      sum.moments += child.moments;
      sum.flux += child.flux;
      sum.area += child.area;
    }
    for (const Sums& child : children)
      if (child.radius >= 0.0)
        sum.radius = std::max(sum.radius, glm::distance(child.centre(), sum.centre()) + child.radius);
    return sum;
  }

  std::vector<Texel> texels_;
};

float asFloat(GLuint word) { return std::bit_cast<float>(word); }
/// One of a word's two signed 16-bit numbers.
double snorm(GLuint word, int half) { return static_cast<std::int16_t>(word >> (16 * half)) / 32767.0; }

TEST_F(LightTreeTest, NodesAreTheSumsOfTheirTexels) {
  const gl::Texture position = textureOf("position", [](const Texel&t) { return glm::vec4(t.position, t.lit); }),
                    normal = textureOf("normal", [](const Texel&t) { return glm::vec4(t.normal, 1.0); }),
                    flux = textureOf("flux", [](const Texel&t) { return glm::vec4(t.flux, t.area); });
  LightTree tree(library(), context().capabilities(), kSize, kLayers);
  tree.build({position, normal, flux});
  const std::vector<GLuint> words = tree.readNodes();
  const std::size_t ofLayer = ((std::size_t{1} << (2 * kDepth + 2)) - 1) / 3;
  ASSERT_EQ(words.size(), 12 * ofLayer * kLayers);
  int lit = 0, unlit = 0;
  for (int layer = 0; layer < kLayers; ++layer)
    for (int depth = LightTree::kTop; depth <= kDepth; ++depth)
      for (int y = 0; y < 1 << depth; ++y)
        for (int x = 0; x < 1 << depth; ++x) {
          std::size_t node = ((std::size_t{1} << (2 * depth)) - 1) / 3;
          for (int bit = 0; bit < depth; ++bit)
            node += static_cast<std::size_t>((x >> bit & 1) | (y >> bit & 1) << 1) << (2 * bit);
          const GLuint* const w = &words[12 * (static_cast<std::size_t>(layer) * ofLayer + node)];
          const int across = 1 << (kDepth - depth);
          const Sums sum = sums(layer, x * across, y * across, across);
          SCOPED_TRACE(fmt::format("layer {}, depth {}, {} {}", layer, depth, x, y));
          if (sum.radius < 0.0) {
            ++unlit;
            ASSERT_LT(asFloat(w[3]), 0.0f);
            continue;
          }
          ++lit;
          const glm::dvec3 n = sum.normal / sum.weight;
          const glm::dmat3 covariance = sum.moments / sum.weight - glm::outerProduct(n, n);
          for (int k = 0; k < 3; ++k) ASSERT_NEAR(asFloat(w[k]), sum.centre()[k], 1e-3) << k;
          ASSERT_NEAR(asFloat(w[3]), sum.radius, 1e-3);
          const double error = 3e-5 * (1 + kDepth - depth);  // 16 bits, at each depth again
          ASSERT_NEAR(snorm(w[4], 0), n.x, error);
          ASSERT_NEAR(snorm(w[4], 1), n.y, error);
          ASSERT_NEAR(snorm(w[5], 0), n.z, error);
          ASSERT_NEAR(snorm(w[5], 1), covariance[0][0], 4 * error);
          ASSERT_NEAR(snorm(w[6], 0), covariance[1][1], 4 * error);
          ASSERT_NEAR(snorm(w[6], 1), covariance[0][1], 4 * error);
          ASSERT_NEAR(snorm(w[7], 0), covariance[0][2], 4 * error);
          ASSERT_NEAR(snorm(w[7], 1), covariance[1][2], 4 * error);
          ASSERT_NEAR(asFloat(w[8]) / sum.area, 1.0, 1e-5);
          ASSERT_NEAR(asFloat(w[9]) / sum.weight, 1.0, 1e-4);
          ASSERT_NEAR((w[10] & 0xffffu) / 65535.0, sum.flux.x / sum.weight, 1e-4);
          ASSERT_NEAR((w[10] >> 16) / 65535.0, sum.flux.y / sum.weight, 1e-4);
        }
  EXPECT_GT(lit, 5000);
  EXPECT_GT(unlit, 5000);
}

}  // namespace
}  // namespace lucerna
