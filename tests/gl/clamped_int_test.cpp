// Floats that no integer holds, and NaN, have defined integers in all shaders (shaders/lib/clamped_int.glsl).
#include "gl/pass.hpp"
#include "support/gl_fixture.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace lucerna {
namespace {

struct ClampedInt : test::SharedProgramsTest {};

TEST_F(ClampedInt, EveryFloatHasADefinedInteger) {
  struct Probe {
    glm::vec4 value;
    glm::ivec4 low, high;
  };
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  std::vector<float> numbers{0.0f, -0.0f, 0.49f, -0.51f, 6.99f, 7.0f, 8.5f, -3.0f, -3.5f, 1e-40f, 16777216.0f};
  for (const float huge : {2147483648.0f, 4294967296.0f, 1e30f, kInfinity})
    numbers.insert(numbers.end(), {huge, -huge});
  for (const std::uint32_t nan : {0x7fc00000u, 0xffc00000u, 0x7f800001u, 0x7fc12345u})
    numbers.push_back(std::bit_cast<float>(nan));
  while (numbers.size() % 4) numbers.push_back(1.0f);
  std::vector<Probe> probes;
  for (std::size_t i = 0; i < numbers.size(); i += 4)
    for (const auto& [low, high] : {std::pair(-3, 7), {0, 1 << 24}, {-(1 << 30), 1 << 30}, {5, 5}})
      probes.push_back({{numbers[i], numbers[i + 1], numbers[i + 2], numbers[i + 3]},
                        glm::ivec4(low, low / 2, low, low),
                        glm::ivec4(high)});
  const gl::Buffer in("probes", probes.size() * sizeof(Probe), probes.data(), gl::Usage::staticDraw),
      out("answers", 4 * probes.size() * sizeof(glm::ivec4), nullptr, gl::Usage::dynamicRead);
  const gl::Program& program = library().loadCompute("clamped int probe", "lib/clamped_int_probe.comp", {});
  in.bindStorage(0);
  out.bindStorage(1);
  {
    const gl::ComputePass pass("probe");
    program.use();
    pass.dispatch({static_cast<int>(probes.size()), 1, 1}, {64, 1, 1});
  }
  const std::vector<glm::ivec4> answers = out.read<glm::ivec4>();
  for (std::size_t i = 0; i < probes.size(); ++i)
    for (int c = 0; c < 4; ++c) {
      const double value = probes[i].value[c], low = probes[i].low[c], high = probes[i].high[c];
      const double expected = std::isnan(value) ? low : std::trunc(std::clamp(value, low, high));
      for (std::size_t width = 4; width > static_cast<std::size_t>(c); --width)
        EXPECT_EQ(answers[4 * i + 4 - width][c], static_cast<int>(expected)) << value << " in " << low << ", " << high;
    }
}

}  // namespace
}  // namespace lucerna
