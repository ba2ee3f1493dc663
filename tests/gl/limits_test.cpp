// What is over a limit of the driver is refused with the limit's name, before the driver is asked to do it.
#include "base/error.hpp"
#include "gl/limits.hpp"
#include "gl/objects.hpp"
#include "support/gl_fixture.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

namespace lucerna {
namespace {

using namespace test;

class LimitsTest : public SharedProgramsTest {
 protected:
  void SetUp() override {
    SharedProgramsTest::SetUp();
    setenv("LUCERNA_GL_MINIMA", "1", 1);
  }
  void TearDown() override {
    unsetenv("LUCERNA_GL_MINIMA");
    SharedProgramsTest::TearDown();
  }
  template <class F>
  void expectRefused(F&& make, const std::string& name, const std::string& limit) {
    try {
      make();
      FAIL() << name << " was made";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::missingCapability);
      EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find(limit), std::string::npos) << error.what();
    }
  }
};

TEST_F(LimitsTest, WhatIsGuaranteedIsMadeAndNoMore) {
  gl::BufferTexture("most texels", gl::Format::r32f, 4u << 16, nullptr);
  expectRefused([] { gl::BufferTexture("texels", gl::Format::r32f, (4u << 16) + 4, nullptr); }, "texels",
                "GL_MAX_TEXTURE_BUFFER_SIZE is 65536");
  gl::Buffer("most bytes", 1u << 24, nullptr, gl::Usage::staticDraw).bindStorage(0);
  const gl::Buffer bytes("bytes", (1u << 24) + 4, nullptr, gl::Usage::staticDraw);
  expectRefused([&] { bytes.bindStorage(0); }, "bytes", "GL_MAX_SHADER_STORAGE_BLOCK_SIZE is 16777216");
  gl::Buffer("most constants", 1u << 14, nullptr, gl::Usage::staticDraw).bindUniform(0);
  const gl::Buffer constants("constants", (1u << 14) + 16, nullptr, gl::Usage::staticDraw);
  expectRefused([&] { constants.bindUniform(0); }, "constants", "GL_MAX_UNIFORM_BLOCK_SIZE is 16384");
  gl::Texture("widest", gl::Format::r8, glm::ivec2(16384, 1));
  expectRefused([] { gl::Texture("wide", gl::Format::r8, glm::ivec2(16385, 1)); }, "wide",
                "GL_MAX_TEXTURE_SIZE is 16384");
  gl::Texture("deepest", gl::Format::r8, glm::ivec3(1, 1, 2048));
  expectRefused([] { gl::Texture("deep", gl::Format::r8, glm::ivec3(1, 1, 2049)); }, "deep",
                "GL_MAX_3D_TEXTURE_SIZE is 2048");
  expectRefused([] { gl::Texture("layers", gl::Format::r8, glm::ivec3(1, 1, 2049), {}, 1, gl::TextureKind::array); },
                "layers", "GL_MAX_ARRAY_TEXTURE_LAYERS is 2048");
  EXPECT_EQ(gl::mostWorkGroups(), glm::uvec3(65535u));
  expectRefused([] { gl::requireWithin(GL_MAX_VERTEX_SHADER_STORAGE_BLOCKS, 1, "vertices"); }, "vertices",
                "GL_MAX_VERTEX_SHADER_STORAGE_BLOCKS is 0");
}

}  // namespace
}  // namespace lucerna
