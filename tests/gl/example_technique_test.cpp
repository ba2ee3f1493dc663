// An example of a technique and its test, compiled and run: CONTRIBUTING.md walks through it.
//
// Absorption dims what the camera sees by the medium in between: L = L_surface exp(-sigma d), d the distance to the
// surface [Chandrasekhar1960, Beer-Lambert law]. In: radiance and depth of a frame. Out: radiance.
#include "gl/pass.hpp"
#include "gl/time_query.hpp"
#include "scene/features.hpp"
#include "support/gl_fixture.hpp"

#include <glm/gtc/matrix_transform.hpp>

#include <cmath>

namespace lucerna::test {
namespace {

class Absorption {
 public:
  struct Settings {
    glm::vec3 coefficient{0.0f};  ///< sigma_a, 1 / scene unit
  };
  struct Inputs {
    const gl::Texture& radiance;  ///< RGBA, scene units
    const gl::Texture& depth;  ///< of the same size, 0 to 1
    glm::mat4 clipFromView;  ///< perspective
  };
  struct Outputs {
    const gl::Texture& radiance;  ///< RGBA32F
  };

  /// What is not needed is not built: the frame keeps a std::optional<Absorption>.
  static bool isNeeded(const SceneFeatures&, const Settings& settings) {
    return settings.coefficient != glm::vec3(0.0f);
  }

  /// Compiles and allocates. Throws Error(missingCapability) where `size` is above the driver's limits.
  Absorption(gl::ProgramLibrary& programs, glm::ivec2 size, const Settings& settings)
      : settings_(settings),
        program_(&programs.loadRaster("absorption", "fullscreen.vert", "example_technique.frag")),
        radiance_("absorption radiance", gl::Format::rgba32f, size) {
    const gl::Texture* targets[] = {&radiance_};
    target_ = gl::Framebuffer("absorption", targets);
  }

  /// One pass: compiles and allocates nothing.
  void record(const Inputs& inputs, gl::TimeQuery& timer) {
    const gl::TimeQuery::Scope stage(timer, "absorption");
    const gl::RasterPass pass("absorption", target_, {});
    program_->use();
    program_->set("viewFromClip", glm::inverse(inputs.clipFromView));
    program_->set("coefficient", settings_.coefficient);
    inputs.radiance.bind(0);
    inputs.depth.bind(1);
    gl::drawFullScreen(noAttributes_);
  }

  Outputs outputs() const { return {radiance_}; }
  std::size_t gpuBytes() const { return radiance_.bytes(); }

 private:
  Settings settings_;
  const gl::Program* program_;
  gl::Texture radiance_;
  gl::Framebuffer target_;
  gl::VertexArray noAttributes_{"absorption"};
};

class ExampleTechnique : public GlTest {};

// The known answer: each pixel's distance from its depth, in double precision.
TEST_F(ExampleTechnique, DimsByTheDistanceToTheSurface) {
  constexpr int kSize = 8;
  constexpr double kFar = 20.0, kNear = 0.5, kDistance = 4.0;  // a wall at this depth in front of the camera
  const glm::dmat4 clipFromView = glm::perspective(1.0, 1.0, kNear, kFar);
  const glm::dvec4 wall = clipFromView * glm::dvec4(0.0, 0.0, -kDistance, 1.0);
  const std::vector<float> depths(kSize * kSize, static_cast<float>(0.5 + 0.5 * wall.z / wall.w));
  const std::vector<glm::vec4> light(kSize * kSize, glm::vec4(3.0f, 2.0f, 1.0f, 1.0f));

  gl::Texture radiance("radiance", gl::Format::rgba32f, glm::ivec2(kSize)),
      depth("depth", gl::Format::r32f, glm::ivec2(kSize));
  radiance.upload(gl::Texels::rgbaFloat, light.data());
  depth.upload(gl::Texels::redFloat, depths.data());

  gl::ProgramLibrary examples(std::filesystem::path(LUCERNA_SOURCE_DIR) / "tests/gl/example_technique");
  gl::TimeQuery timer(false);
  const glm::dvec3 coefficient(0.1, 0.2, 0.4);
  Absorption absorption(examples, glm::ivec2(kSize), {glm::vec3(coefficient)});
  absorption.record({radiance, depth, glm::mat4(clipFromView)}, timer);

  const std::vector<glm::vec4> result = absorption.outputs().radiance.readRgba();
  for (int i = 0; i < kSize * kSize; ++i) {
    const glm::dvec2 ndc = (glm::dvec2(i % kSize, i / kSize) + 0.5) / (0.5 * kSize) - 1.0;
    const double distance = kDistance * std::sqrt(1.0 + std::pow(std::tan(0.5), 2) * glm::dot(ndc, ndc));
    for (int c = 0; c < 3; ++c) {
      const double expected = light[0][c] * std::exp(-coefficient[c] * distance);
      EXPECT_NEAR(result[static_cast<std::size_t>(i)][c], expected, 1e-4 * expected) << i << ", channel " << c;
    }
  }
  EXPECT_EQ(absorption.gpuBytes(), kSize * kSize * sizeof(glm::vec4));
}

TEST_F(ExampleTechnique, IsNotNeededWithoutAMedium) {
  EXPECT_FALSE(Absorption::isNeeded(SceneFeatures{}, {}));
  EXPECT_TRUE(Absorption::isNeeded(SceneFeatures{}, {glm::vec3(0.1f)}));
}

}  // namespace
}  // namespace lucerna::test
