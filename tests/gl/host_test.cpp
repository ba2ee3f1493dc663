// The three hosts. One process holds one context at a time, so EGL and the window run in the built program.
#include "host/egl_device.hpp"
#include "host/host.hpp"

#include "base/error.hpp"
#include "base/files.hpp"
#include "base/image.hpp"
#include "support/subprocess.hpp"
#include "support/temp_folder.hpp"
#include "support/test_host.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iostream>

namespace lucerna {
namespace {

using test::RunResult;
using test::TempFolder;

TEST(HostNames, ParseAndRefuse) {
  for (const HostKind kind : {HostKind::window, HostKind::egl, HostKind::osmesa})
    EXPECT_EQ(parseHostKind(nameOf(kind)), kind);
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
                  "mtllib room.mtl\nv -2 0 -2\nv 2 0 -2\nv 2 0 2\nv -2 0 2\nv -2 2 -2\nv 2 2 -2\nv -0.5 1 -0.5\nv 0.5 "
                  "1 -0.5\nv 0 1 0.5\n"
                  "usemtl grey\nf 1 4 3 2\nusemtl red\nf 1 2 6 5\nusemtl grey\nf 7 9 8\n");
    folder_.write("room.mtl", "newmtl grey\nKd 0.7 0.7 0.7\nnewmtl red\nKd 0.6 0.1 0.1\n");
    folder_.write(
        "room.json",
        "{\"model\": \"room.obj\", \"camera\": {\"position\": [0, 1.5, 4], \"target\": [0, 0.5, 0], \"fov\": 50},\n"
        " \"sun\": {\"direction\": [0.2, -1, -0.6], \"irradiance\": [3, 3, 3]}}\n");
  }
  /// The program's picture of the room; empty where the host cannot run here, with the reason printed.
  Image picture(const std::string& host, const std::string& prefix = {}) {
    const std::string file = (folder_ / (host + ".pfm")).string();
    const RunResult result = test::run(prefix + "'" LUCERNA_BINARY "' render '" + (folder_ / "room.json").string() +
                                       "' --host " + host + " -o '" + file + "' --size 64x64 --set cache.cells=16");
    if (result.exitCode == 3) {
      std::cout << "[ skipped  ] host " << host << ": " << result.err;
      return {};
    }
    EXPECT_EQ(result.exitCode, 0) << result.err;
    return result.exitCode == 0 ? readImage(file) : Image();
  }
  /// Mesa's software hosts differ in nothing but who holds the context; a GPU may round otherwise and move an edge by a
  /// pixel.
  void expectSamePicture(const std::string& host, const std::string& prefix = {}) {
    const Image reference = picture("osmesa");
    if (reference.pixels.empty()) GTEST_SKIP() << "no OSMesa to compare with";
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
    std::cout << "[ measured ] host " << host << ": " << different << " of " << reference.pixels.size()
              << " pixels differ, " << off << " by more than 1/255\n";
    EXPECT_LE(off, reference.pixels.size() / 1000);
  }

  std::string scene() const { return (folder_ / "room.json").string(); }
  std::string json() const { return (folder_ / "walk.json").string(); }

  TempFolder folder_;
};

TEST_F(HostPictures, EglDrawsWhatOsmesaDraws) { expectSamePicture("egl"); }

TEST_F(HostPictures, AWindowDrawsWhatOsmesaDraws) {
  std::string prefix;
  if (!displayAvailable()) {
    if (test::run("command -v xvfb-run").exitCode != 0)
      GTEST_SKIP() << "no display, and xvfb-run is missing (Debian package xvfb)";
    prefix = "xvfb-run -a ";
  }
  expectSamePicture("window", prefix);
}

TEST_F(HostPictures, AWindowDoesNotWaitForTheDisplayWhereFramesAreMeasured) {
  std::string prefix;
  if (!displayAvailable()) {
    if (test::run("command -v xvfb-run").exitCode != 0)
      GTEST_SKIP() << "no display, and xvfb-run is missing (Debian package xvfb)";
    prefix = "xvfb-run -a ";
  }
  const RunResult result =
      test::run(prefix + "'" LUCERNA_BINARY "' walk '" + scene() +
                "' --host window --technique direct --size 64x64 --frames 2 --json '" + json() + "'");
  if (result.exitCode == 3) GTEST_SKIP() << result.err;
  ASSERT_EQ(result.exitCode, 0) << result.err;
  EXPECT_EQ(nlohmann::json::parse(readFileText(json())).at("swap_interval"), 0);
}

TEST_F(HostPictures, RepeatsToTheBit) {
  const std::string host(nameOf(test::testHost()));
  const Image first = picture(host), second = picture(host);
  ASSERT_FALSE(first.pixels.empty());
  EXPECT_TRUE(first.pixels == second.pixels);
}

TEST_F(HostPictures, WithoutADisplayAWindowIsAMissingCapability) {
  const RunResult result = test::run("env -u DISPLAY -u WAYLAND_DISPLAY '" LUCERNA_BINARY "' info --host window");
  EXPECT_EQ(result.exitCode, 3);
  EXPECT_NE(result.err.find("no display"), std::string::npos) << result.err;
}

TEST_F(HostPictures, ADeviceOfEglIsChosenByItsNumberOrRefusedWithAList) {
  const RunResult list = RUN_LUCERNA("info --devices --json '" + (folder_ / "devices.json").string() + "'");
  ASSERT_EQ(list.exitCode, 0) << list.err;
  std::ifstream file(folder_ / "devices.json");
  const auto devices = nlohmann::json::parse(file).at("devices");
  for (const char* wrong : {"99", "-1", "0x", "first", "1.5"}) {
    const RunResult refused =
        test::run(std::string("LUCERNA_EGL_DEVICE=") + wrong + " '" LUCERNA_BINARY "' info --host egl");
    EXPECT_EQ(refused.exitCode, 2) << wrong << ": " << refused.err;
    EXPECT_NE(refused.err.find(wrong), std::string::npos) << refused.err;
    for (const auto& device : devices)
      EXPECT_NE(refused.err.find(device.at("kind").get<std::string>()), std::string::npos) << refused.err;
  }
  if (devices.empty()) GTEST_SKIP() << "EGL lists no devices";
  std::size_t firsts = 0;
  for (const auto& device : devices) {
    firsts += device.at("first").get<bool>();
    if (!device.at("fault").get<std::string>().empty()) continue;
    const RunResult info = test::run(fmt::format("LUCERNA_EGL_DEVICE={} '{}' info --host egl --quiet",
                                                 device.at("index").get<int>(), LUCERNA_BINARY));
    EXPECT_EQ(info.exitCode, 0) << info.err;
    EXPECT_NE(info.out.find(device.at("renderer").get<std::string>()), std::string::npos) << info.out;
  }
  EXPECT_EQ(firsts, 1u);
}

TEST_F(HostPictures, WithoutItsLibraryOsmesaIsAMissingCapabilityAndEglServes) {
  // An empty file that stands before the library on the loader's path.
  folder_.write("libOSMesa.so.8", "");
  const std::string program = "env -u LUCERNA_HOST -u DISPLAY -u WAYLAND_DISPLAY LD_LIBRARY_PATH='" +
                              folder_.path().string() +
                              "'\"${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}\" '" LUCERNA_BINARY "' info --quiet";
  const RunResult osmesa = test::run(program + " --host osmesa");
  EXPECT_EQ(osmesa.exitCode, 3) << osmesa.err;
  EXPECT_NE(osmesa.err.find("libosmesa6"), std::string::npos) << osmesa.err;
  if (test::run("'" LUCERNA_BINARY "' info --quiet --host egl").exitCode != 0) GTEST_SKIP() << "no EGL here";
  const RunResult any = test::run(program);
  EXPECT_EQ(any.exitCode, 0) << any.err;
  EXPECT_NE(any.out.find("host        egl"), std::string::npos) << any.out;
}

/// A /sys of our own: a render node a device, as Linux shows them.
class RenderNodes : public ::testing::Test {
 protected:
  struct Files {
    const char *slot, *vendor, *device, *driver, *videoBytes;
  };
  EglDevice describe(const std::string& node, const Files& files) {
    namespace fs = std::filesystem;
    const fs::path device = folder_ / "devices" / files.slot;
    fs::create_directories(device);
    fs::create_directories(folder_ / "drivers" / files.driver);
    fs::create_directory_symlink(folder_ / "drivers" / files.driver, device / "driver");
    const auto write = [&](const char* name, const char* text) {
      if (*text) std::ofstream(device / name) << text << "\n";
    };
    write("vendor", files.vendor), write("device", files.device), write("mem_info_vram_total", files.videoBytes);
    fs::create_directories(folder_ / "class/drm" / node);
    fs::create_directory_symlink(device, folder_ / "class/drm" / node / "device");
    return describeRenderNode("/dev/dri/" + node, folder_.path());
  }
  TempFolder folder_;
};

TEST_F(RenderNodes, AreToldApartByVendorBusAndMemory) {
  using Kind = EglDevice::Kind;
  const EglDevice iris = describe("renderD128", {"0000:00:02.0", "0x8086", "0x9a49", "i915", ""});
  const EglDevice arc = describe("renderD129", {"0000:03:00.0", "0x8086", "0x56a0", "i915", ""});
  const EglDevice apu = describe("renderD130", {"0000:04:00.0", "0x1002", "0x1636", "amdgpu", "536870912"});
  const EglDevice small = describe("renderD131", {"0000:05:00.0", "0x1002", "0x67df", "amdgpu", "8589934592"});
  const EglDevice large = describe("renderD132", {"0000:06:00.0", "0x1002", "0x73bf", "amdgpu", "17163091968"});
  const EglDevice geforce = describe("renderD133", {"0000:07:00.0", "0x10de", "0x2204", "nvidia", ""});
  const EglDevice mali = describe("renderD134", {"ff9a0000.gpu", "", "", "panfrost", ""});
  const EglDevice virtual_ = describe("renderD135", {"0000:00:01.0", "0x1af4", "0x1050", "virtio-pci", ""});
  const EglDevice nothing = describeRenderNode("/dev/dri/renderD199", folder_.path());
  EglDevice software;
  software.kind = Kind::software;
  EXPECT_EQ(iris.kind, Kind::integrated);
  EXPECT_EQ(arc.kind, Kind::discrete);
  EXPECT_EQ(apu.kind, Kind::integrated);
  EXPECT_EQ(small.kind, Kind::discrete);
  EXPECT_EQ(large.kind, Kind::discrete);
  EXPECT_EQ(geforce.kind, Kind::discrete);
  EXPECT_EQ(mali.kind, Kind::integrated);
  EXPECT_EQ(virtual_.kind, Kind::unknown);
  EXPECT_EQ(nothing.kind, Kind::unknown);
  EXPECT_EQ(large.driver, "amdgpu");
  EXPECT_EQ(large.pci, "1002:73bf");
  EXPECT_EQ(large.node, "/dev/dri/renderD132");
  EXPECT_EQ(eglPreference({software, iris, nothing, small, large, apu, arc}),
            (std::vector<std::size_t>{4, 3, 6, 2, 5, 1, 0}));
  EXPECT_TRUE(eglPreference({}).empty());
}

// What Slurm writes into CUDA_VISIBLE_DEVICES and ROCR_VISIBLE_DEVICES: numbers in the order of slots, whatever EGL's
// is, and UUIDs, which are no numbers.
TEST_F(RenderNodes, AreNamedByNumberAsSchedulersCountAndByUuid) {
  const EglDevice iris = describe("renderD128", {"0000:00:02.0", "0x8086", "0x9a49", "i915", ""});
  const EglDevice second = describe("renderD129", {"0000:c1:00.0", "0x10de", "0x2204", "nvidia", ""});
  const EglDevice first = describe("renderD130", {"0000:41:00.0", "0x10de", "0x2204", "nvidia", ""});
  const EglDevice amd = describe("renderD131", {"0000:06:00.0", "0x1002", "0x73bf", "amdgpu", "17163091968"});
  EglDevice software;
  software.kind = EglDevice::Kind::software;
  const std::vector<EglDevice> devices{software, iris, second, amd, first};
  for (const auto& [slot, uuid] : {std::pair{"0000:41:00.0", "GPU-1a2b3c4d-0000-1111-2222-333344445555"},
                                   {"0000:c1:00.0", "GPU-1a9f3c4d-0000-1111-2222-333344445555"}}) {
    std::filesystem::create_directories(folder_ / "driver/nvidia/gpus" / slot);
    std::ofstream(folder_ / "driver/nvidia/gpus" / slot / "information")
        << "Model: \t\t NVIDIA A100\nIRQ:   \t\t 123\nGPU UUID: \t " << uuid << "\nBus Location: \t " << slot << "\n";
  }
  const auto named = [&](const std::string& name, const std::vector<EglDevice>& all) {
    return eglDeviceNamed(name, all, folder_.path(), folder_.path());
  };
  EXPECT_EQ(named("3", devices), 3u);
  EXPECT_EQ(named("cuda:0", devices), 4u);
  EXPECT_EQ(named("cuda:1", devices), 2u);
  EXPECT_EQ(named("rocm:0", devices), 3u);
  EXPECT_EQ(named("cuda:GPU-1a9f3c4d-0000-1111-2222-333344445555", devices), 2u);
  EXPECT_EQ(named("cuda:GPU-1a2", devices), 4u);
  const auto refusal = [&](const std::string& name, const std::vector<EglDevice>& all) -> std::string {
    try {
      return "is " + std::to_string(named(name, all));
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::badInput);
      return error.what();
    }
  };
  for (const char* name : {"5", "-1", "1x", "", "cuda:2", "cuda:", "rocm:1", "rocm:GPU-1a2", "cuda:GPU-ffff", "gpu:0",
                           "GPU-1a2b3c4d-0000-1111-2222-333344445555"})
    EXPECT_NE(refusal(name, devices).find("no such device"), std::string::npos) << refusal(name, devices);
  EXPECT_NE(refusal("cuda:GPU-1a", devices).find("more than one"), std::string::npos);
  EXPECT_NE(refusal("cuda:MIG-8b1c", devices).find("a part of a GPU"), std::string::npos);
  EXPECT_NE(refusal("cuda:0", {software}).find("0 software"), std::string::npos) << refusal("cuda:0", {software});
  // Where the kernel shows no render nodes, as in containers: EGL's order, and a UUID where there is but one.
  EglDevice bare;
  bare.kind = EglDevice::Kind::discrete;
  bare.driver = "nvidia";
  EXPECT_EQ(named("cuda:1", {software, bare, bare}), 2u);
  EXPECT_EQ(named("cuda:GPU-1a2", {software, bare}), 1u);
  EXPECT_NE(refusal("cuda:GPU-1a2", {bare, bare}).find("no such device"), std::string::npos);
}

}  // namespace
}  // namespace lucerna
