// The three hosts. One process holds one context at a time, so EGL and the window run in the built program.
#include "host/host.hpp"

#include "base/error.hpp"
#include "base/files.hpp"
#include "base/image.hpp"
#include "support/subprocess.hpp"
#include "support/temp_folder.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <iostream>

namespace lucerna {
namespace {

using test::RunResult;
using test::TempFolder;

TEST(HostNames, ParseAndRefuse) {
  for (const HostKind kind : {HostKind::window, HostKind::egl, HostKind::osmesa}) EXPECT_EQ(parseHostKind(nameOf(kind)), kind);
  for (const char* wrong : {"", "EGL", "glx", "osmesa "}) {
    const std::string message = test::badInputMessage([&] { parseHostKind(wrong); });
    for (const char* known : {"window", "egl", "osmesa"}) EXPECT_NE(message.find(known), std::string::npos) << message;
  }
}

TEST(HostNames, SoftwareRenderersAreKnown) {
  EXPECT_TRUE(Host::isSoftwareRenderer("llvmpipe (LLVM 15.0.6, 256 bits)"));
  EXPECT_TRUE(Host::isSoftwareRenderer("softpipe"));
  EXPECT_FALSE(Host::isSoftwareRenderer("NVIDIA GeForce RTX 4090/PCIe/SSE2"));
  EXPECT_FALSE(Host::isSoftwareRenderer("AMD Radeon RX 6800 (radeonsi, navi21, LLVM 15.0.6)"));
  EXPECT_FALSE(Host::isSoftwareRenderer(""));
}

class HostPictures : public ::testing::Test {
 protected:
  HostPictures() {
    folder_.write("room.obj",
                  "mtllib room.mtl\nv -2 0 -2\nv 2 0 -2\nv 2 0 2\nv -2 0 2\nv -2 2 -2\nv 2 2 -2\nv -0.5 1 -0.5\nv 0.5 1 -0.5\nv 0 1 0.5\n"
                  "usemtl grey\nf 1 4 3 2\nusemtl red\nf 1 2 6 5\nusemtl grey\nf 7 9 8\n");
    folder_.write("room.mtl", "newmtl grey\nKd 0.7 0.7 0.7\nnewmtl red\nKd 0.6 0.1 0.1\n");
    folder_.write("room.json",
                  "{\"model\": \"room.obj\", \"camera\": {\"position\": [0, 1.5, 4], \"target\": [0, 0.5, 0], \"fov\": 50},\n"
                  " \"sun\": {\"direction\": [0.2, -1, -0.6], \"irradiance\": [3, 3, 3]}}\n");
  }
  /// The program's picture of the room; empty where the host cannot run here, with the reason printed.
  Image picture(const std::string& host, const std::string& prefix = {}) {
    const std::string file = (folder_ / (host + ".pfm")).string();
    const RunResult result = test::run(prefix + "'" LUCERNA_BINARY "' render '" + (folder_ / "room.json").string() + "' --host " + host + " -o '" +
                                       file + "' --size 64x64 --set lpv.cells=16");
    if (result.exitCode == 3) {
      std::cout << "[ skipped  ] host " << host << ": " << result.err;
      return {};
    }
    EXPECT_EQ(result.exitCode, 0) << result.err;
    return result.exitCode == 0 ? readImage(file) : Image();
  }
  /// Mesa's software hosts differ in nothing but who holds the context; a GPU may round otherwise and move an edge by a pixel.
  void expectSamePicture(const std::string& host, const std::string& prefix = {}) {
    const Image reference = picture("osmesa");
    ASSERT_EQ(reference.pixels.size(), 64u * 64);
    const glm::dvec3 mean = meanOf(reference);
    EXPECT_GT(mean.x, 0.05);
    const Image other = picture(host, prefix);
    if (other.pixels.empty()) GTEST_SKIP();
    ASSERT_EQ(other.pixels.size(), reference.pixels.size());
    std::size_t different = 0, off = 0;
    for (std::size_t i = 0; i < reference.pixels.size(); ++i) {
      const glm::vec3 apart = glm::abs(reference.pixels[i] - other.pixels[i]);
      const float largest = std::max({apart.x, apart.y, apart.z});
      if (largest > 0.0f) ++different;
      if (!(largest <= 1e-6f + 1.0f / 255.0f)) ++off;
    }
    std::cout << "[ measured ] host " << host << ": " << different << " of " << reference.pixels.size() << " pixels differ, " << off
              << " by more than 1/255\n";
    EXPECT_LE(off, reference.pixels.size() / 1000);
  }

  std::string scene() const { return (folder_ / "room.json").string(); }
  std::string json() const { return (folder_ / "walk.json").string(); }

 private:
  TempFolder folder_;
};

TEST_F(HostPictures, EglDrawsWhatOsmesaDraws) { expectSamePicture("egl"); }

TEST_F(HostPictures, AWindowDrawsWhatOsmesaDraws) {
  std::string prefix;
  if (!displayAvailable()) {
    if (test::run("command -v xvfb-run").exitCode != 0) GTEST_SKIP() << "no display, and xvfb-run is missing (Debian package xvfb)";
    prefix = "xvfb-run -a ";
  }
  expectSamePicture("window", prefix);
}

TEST_F(HostPictures, AWindowDoesNotWaitForTheDisplayWhereFramesAreMeasured) {
  std::string prefix;
  if (!displayAvailable()) {
    if (test::run("command -v xvfb-run").exitCode != 0) GTEST_SKIP() << "no display, and xvfb-run is missing (Debian package xvfb)";
    prefix = "xvfb-run -a ";
  }
  const RunResult result = test::run(prefix + "'" LUCERNA_BINARY "' walk '" + scene() + "' --host window --technique direct --size 64x64 --frames 2 --json '" + json() + "'");
  if (result.exitCode == 3) GTEST_SKIP() << result.err;
  ASSERT_EQ(result.exitCode, 0) << result.err;
  EXPECT_EQ(nlohmann::json::parse(readFileText(json())).at("swap_interval"), 0);
}

TEST_F(HostPictures, OsmesaRepeatsToTheBit) {
  const Image first = picture("osmesa"), second = picture("osmesa");
  ASSERT_FALSE(first.pixels.empty());
  EXPECT_TRUE(first.pixels == second.pixels);
}

TEST_F(HostPictures, WithoutADisplayAWindowIsAMissingCapability) {
  const RunResult result = test::run("env -u DISPLAY -u WAYLAND_DISPLAY '" LUCERNA_BINARY "' info --host window");
  EXPECT_EQ(result.exitCode, 3);
  EXPECT_NE(result.err.find("no display"), std::string::npos) << result.err;
}

}  // namespace
}  // namespace lucerna
