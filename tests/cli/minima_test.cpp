// On a driver with no more than OpenGL 4.3 guarantees (LUCERNA_GL_MINIMA=1) techniques render, or say in one line which
// limit they need more of.
#include "support/long_tests.hpp"
#include "support/subprocess.hpp"
#include "support/temp_folder.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

namespace {

namespace fs = std::filesystem;
using lucerna::test::RunResult;
using lucerna::test::TempFolder;

class Minima : public ::testing::Test {
 protected:
  RunResult render(const std::string& scene, const std::string& arguments, const std::string& size = "24x24") const {
    return lucerna::test::run("LUCERNA_GL_MINIMA=1 '" LUCERNA_BINARY "' render '" + scene + "' --size " + size +
                              " --quiet -o '" + picture().string() + "' " + arguments);
  }
  void expectRendered(const std::string& arguments, const std::string& size = "24x24") const {
    const RunResult result = render(kCornell, arguments, size);
    EXPECT_EQ(result.exitCode, 0) << arguments << "\n" << result.err;
    EXPECT_TRUE(fs::exists(picture()));
    fs::remove(picture());
  }
  void expectRefused(const std::string& scene, const std::string& arguments, const std::string& limit) const {
    const RunResult result = render(scene, arguments);
    EXPECT_EQ(result.exitCode, 3) << arguments << "\n" << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_NE(result.err.find(limit), std::string::npos) << result.err;
    EXPECT_FALSE(fs::exists(picture()));
  }
  fs::path picture() const { return folder_.path() / "picture.pfm"; }

  const std::string kCornell = LUCERNA_SOURCE_DIR "/assets/cornell/cornell.json";
  TempFolder folder_;
};

TEST_F(Minima, WhatFitsIsRendered) {
  expectRendered("--technique direct");
  expectRendered("--technique rsm");
  expectRendered("--technique lpv --set lpv.cells=16");
  expectRendered("--technique path --spp 1");
  // A number for each pixel is more than a storage block holds.
  if (lucerna::test::longTests()) expectRendered("--technique rsm --set rsm.samples=4 --set rsm.size=64", "2176x2048");
}

TEST_F(Minima, WhatDoesNotFitNamesTheLimit) {
  expectRefused(kCornell, "--technique lpv --set lpv.cells=32", "GL_MAX_TEXTURE_BUFFER_SIZE");  // 3 * 32^3 texels
  expectRefused(kCornell, "--technique radiosity", "GL_MAX_VERTEX_SHADER_STORAGE_BLOCKS");

  // 160 x 160 squares: 51,200 triangles, of more than one texel each.
  const std::string scene = (folder_.path() / "squares.obj").string();
  std::ofstream file(scene);
  constexpr int kSide = 160;
  for (int i = 0; i <= kSide; ++i)
    for (int j = 0; j <= kSide; ++j) file << "v " << i << " 0 " << j << "\n";
  for (int i = 0; i < kSide; ++i)
    for (int j = 0; j < kSide; ++j) {
      const int a = i * (kSide + 1) + j + 1, b = a + kSide + 1;
      file << "f " << a << " " << a + 1 << " " << b + 1 << " " << b << "\n";
    }
  file.close();
  expectRefused(scene, "--technique path --spp 1", "GL_MAX_TEXTURE_BUFFER_SIZE");
}

}  // namespace
