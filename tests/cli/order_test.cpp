// No picture depends on the order in which a GPU runs groups and lanes, nor on how many lanes it has: with groups and
// lanes reversed, and with 4 lanes instead of 8, each technique gives the same bits.
#include "base/files.hpp"
#include "support/faulty_shaders.hpp"
#include "support/subprocess.hpp"

#include <gtest/gtest.h>

#include <fmt/core.h>

#include <set>
#include <utility>

namespace lucerna {
namespace {

/// A copy of the shaders in which the last group and lane come first.
class ReversedShaders : public test::FaultyShaders {
 public:
  ReversedShaders() {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(path())) {
      const std::string suffix = entry.path().extension();
      if (suffix != ".comp" && suffix != ".glsl") continue;
      std::string text = readFileText(entry.path());
      // In two steps, since replacements contain the names.
      for (const auto& [name, step, reversed] : kNames) replaceAll(text, name, step);
      for (const auto& [name, step, reversed] : kNames) count_ += replaceAll(text, step, reversed);
      writeFileAtomically(entry.path(), text);
    }
  }
  int count() const { return count_; }

 private:
  struct Name {
    const char *name, *step, *reversed;
  };
  static constexpr Name kNames[] = {
      {"gl_GlobalInvocationID", "@GLOBAL@",
       "((gl_NumWorkGroups - 1u - gl_WorkGroupID) * gl_WorkGroupSize + (gl_WorkGroupSize - 1u - "
       "gl_LocalInvocationID))"},
      {"gl_WorkGroupID", "@GROUP@", "(gl_NumWorkGroups - 1u - gl_WorkGroupID)"},
      {"gl_LocalInvocationIndex", "@INDEX@",
       "(gl_WorkGroupSize.x * gl_WorkGroupSize.y * gl_WorkGroupSize.z - 1u - gl_LocalInvocationIndex)"},
      {"gl_LocalInvocationID", "@LOCAL@", "(gl_WorkGroupSize - 1u - gl_LocalInvocationID)"}};
  static int replaceAll(std::string& text, const std::string& from, const std::string& to) {
    int count = 0;
    for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()), ++count)
      text.replace(at, from.size(), to);
    return count;
  }
  int count_ = 0;
};

class Order : public ::testing::TestWithParam<std::pair<const char*, const char*>> {};

TEST_P(Order, OfGroupsAndLanesChangesNoBit) {
  const test::TempFolder folder;
  const auto render = [&](const char* name, const std::string& environment) {
    const std::filesystem::path file = folder / name;
    const test::RunResult result = test::run(fmt::format("{} '" LUCERNA_BINARY "' render '" LUCERNA_SOURCE_DIR
                                                         "'/{} --size 32x32 --quiet --check-barriers -o '{}'",
                                                         environment, GetParam().second, file.string()));
    EXPECT_EQ(result.exitCode, 0) << result.err;
    return result.exitCode == 0 ? readFileText(file) : std::string(name);
  };
  static const ReversedShaders reversed;
  ASSERT_GT(reversed.count(), 50);
  const std::string picture = render("plain.pfm", "");
  EXPECT_EQ(render("reversed.pfm", fmt::format("LUCERNA_SHADERS='{}'", reversed.path().string())), picture);
  EXPECT_EQ(render("four_lanes.pfm", "LP_NATIVE_VECTOR_WIDTH=128"), picture);
  EXPECT_GT(std::set<char>(picture.begin(), picture.end()).size(), 64u) << "the picture is plain";
}

INSTANTIATE_TEST_SUITE_P(
    Techniques, Order,
    ::testing::Values(std::pair("Direct", "assets/cornell/cornell.json --technique direct"),
                      std::pair("Rsm",
                                "assets/cornell/cornell.json --technique rsm --set rsm.size=64 --set rsm.samples=32"),
                      std::pair("RsmOfEachPixel",
                                "assets/cornell/cornell.json --technique rsm --set rsm.size=64 "
                                "--set rsm.samples=32 --set rsm.interpolate=off"),
                      std::pair("LpvRays",
                                "assets/cornell/cornell.json --technique irradiance-cache --set cache.cells=8 "
                                "--set cache.samples=16"),
                      std::pair("CacheGather",
                                "assets/cornell/cornell.json --set cache.transport=gather --set cache.cells=8 "
                                "--set rsm.size=32"),
                      std::pair("LpvPropagate",
                                "assets/cornell/cornell.json --technique lpv --set lpv.cells=8 "
                                "--set rsm.size=64 --set lpv.bounces=2"),
                      std::pair("LpvFixedPoint",
                                "assets/cornell/cornell.json --technique lpv --set lpv.cells=8 "
                                "--set rsm.size=64 --set lpv.fill=fixed"),
                      std::pair("RadiosityItemBuffer",
                                "assets/cornell/cornell.json --technique radiosity "
                                "--set radiosity.visibility=item-buffer --set radiosity.edge=0.5 "
                                "--set radiosity.resolution=16"),
                      std::pair("RadiosityRaster",
                                "assets/cornell/cornell.json --technique radiosity "
                                "--set radiosity.visibility=raster --set radiosity.edge=0.5 "
                                "--set radiosity.resolution=16"),
                      std::pair("RadiosityRays",
                                "assets/cornell/cornell.json --technique radiosity "
                                "--set radiosity.visibility=rays --set radiosity.edge=0.5 "
                                "--set radiosity.resolution=16"),
                      std::pair("Path", "assets/cornell/cornell.json --technique path --spp 2"),
                      std::pair("Media", "assets/media/smoke/smoke.json --technique path --spp 1")),
    [](const auto& test) { return test.param.first; });

}  // namespace
}  // namespace lucerna
