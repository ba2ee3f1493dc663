// What goes wrong in OpenGL is one line and an exit code, never a black picture.
#include "support/subprocess.hpp"
#include "support/temp_folder.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace lucerna::test {
namespace {

class GlErrors : public ::testing::Test {
 protected:
  void SetUp() override {
    std::ofstream(path("plate.obj")) << "mtllib plate.mtl\nv -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nvt 0 0\nvt 1 0\nvt "
                                        "1 1\nvt 0 1\nusemtl m\nf 1/1 4/4 3/3 2/2\n";
    std::ofstream(path("plate.mtl")) << "newmtl m\nKd 0.5 0.5 0.5\n";
  }
  std::string path(const char* name) const { return (folder_ / name).string(); }
  void expectMissing(const std::string& command, std::initializer_list<const char*> words) {
    const RunResult result = run(command);
    EXPECT_EQ(result.exitCode, 3) << command << "\n" << result.err;
    for (const char* word : words) EXPECT_NE(result.err.find(word), std::string::npos) << word << " in " << result.err;
    EXPECT_FALSE(std::filesystem::exists(path("o.pfm"))) << "a picture of nothing";
  }

 private:
  TempFolder folder_;
};

TEST_F(GlErrors, WhatDoesNotFitIntoMemoryIsSaid) {
  // The driver's own memory counts to the process's: 2.5 GB of address space hold the program and its compiler, no film
  // of 6.9 GB.
  const std::string limited =
      "ulimit -v 2500000; '" LUCERNA_BINARY "' render '" + path("plate.obj") + "' --quiet -o '" + path("o.pfm") + "' ";
  expectMissing(limited + "--technique path --size 12000x12000 --spp 1", {"cannot allocate"});
  expectMissing(
      limited + "--technique lpv --set lpv.cells=128 --set lpv.cascades=4 --set lpv.blocking=both --size 8192x8192",
      {"cannot allocate"});
}

TEST_F(GlErrors, LargeHemicubesSeeWhatSmallOnesSee) {
  // From 1,184 pixels on an axis would need more groups than a dispatch has.
  const auto fronts = [&](int resolution, const char* way) {
    std::ofstream(path("room.obj")) << "mtllib plate.mtl\nv -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nv -1 2 -1\nv 1 2 "
                                       "-1\nv 1 2 1\nv -1 2 1\nusemtl lamp\nf 1 4 3 2\nusemtl m\nf 5 6 7 8\n"
                                       "f 1 2 6 5\nf 4 8 7 3\nf 1 5 8 4\nf 2 3 7 6\n";
    std::ofstream(path("plate.mtl")) << "newmtl m\nKd 0.5 0.5 0.5\nnewmtl lamp\nKd 0 0 0\nKe 1 1 1\n";
    const RunResult result = run("'" LUCERNA_BINARY "' render '" + path("room.obj") +
                                 "' --technique radiosity --camera 0,1,0.9,0,1,-1,70 --size 16x16 --quiet --set "
                                 "radiosity.edge=4 --set radiosity.direct=patches --set radiosity.exact-pixels=0 " +
                                 "--set radiosity.repair=off --set radiosity.visibility=" + way +
                                 " --set radiosity.resolution=" + std::to_string(resolution) + " -o '" + path("o.pfm") +
                                 "' --json '" + path("o.json") + "'");
    EXPECT_EQ(result.exitCode, 0) << result.err;
    std::ifstream stream(path("o.json"));
    const std::string json((std::istreambuf_iterator<char>(stream)), {});
    const auto at = json.find("\"mean\"");
    return std::stod(json.substr(json.find('[', at) + 1));
  };
  for (const char* way : {"rays", "item-buffer"}) {
    const double coarse = fronts(256, way);
    EXPECT_GT(coarse, 0.01);
    EXPECT_NEAR(fronts(1216, way) / coarse, 1.0, 5e-3) << way;
  }
}

}  // namespace
}  // namespace lucerna::test
