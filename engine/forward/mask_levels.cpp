#include "forward/mask_levels.hpp"

#include "base/error.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>

namespace lucerna {

namespace {

/// A level before it is rounded, in units of 8 bits.
struct Level {
  glm::ivec2 size;
  std::vector<float> values;

  float at(int x, int y) const {  // repeated
    return values[static_cast<std::size_t>((y + size.y) % size.y) * static_cast<std::size_t>(size.x) +
                  static_cast<std::size_t>((x + size.x) % size.x)];
  }
};

Level levelOf(const std::vector<std::uint8_t>& texels, glm::ivec2 size) {
  CHECK(texels.size() == static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y), "{} texels, {} x {}",
        texels.size(), size.x, size.y);
  return {size, {texels.begin(), texels.end()}};
}

/// Means over the texels that each covers; of odd sizes some are shared by two.
Level halved(const Level& from) {
  Level to{glm::max(from.size / 2, glm::ivec2(1)), {}};
  const glm::dvec2 ratio = glm::dvec2(from.size) / glm::dvec2(to.size);
  const auto share = [](int i, double low, double high) {
    return std::max(std::min(i + 1.0, high) - std::max(static_cast<double>(i), low), 0.0);
  };
  for (int y = 0; y < to.size.y; ++y)
    for (int x = 0; x < to.size.x; ++x) {
      const glm::dvec2 low = glm::dvec2(x, y) * ratio, high = low + ratio;
      double sum = 0.0;
      for (int v = static_cast<int>(low.y); v < std::min(static_cast<int>(std::ceil(high.y)), from.size.y); ++v)
        for (int u = static_cast<int>(low.x); u < std::min(static_cast<int>(std::ceil(high.x)), from.size.x); ++u)
          sum += share(u, low.x, high.x) * share(v, low.y, high.y) * static_cast<double>(from.at(u, v));
      to.values.push_back(static_cast<float>(sum / (ratio.x * ratio.y)));
    }
  return to;
}

/// The bilinear interpolation at points that are spread evenly; more of them where texels are few.
std::vector<float> samplesOf(const Level& level) {
  constexpr int kLeast = 256;  // along a side
  const glm::ivec2 each = glm::max(glm::ivec2(kLeast) / level.size, glm::ivec2(1));
  std::vector<float> samples;
  samples.reserve(level.values.size() * static_cast<std::size_t>(each.x * each.y));
  for (int y = 0; y < level.size.y; ++y)
    for (int x = 0; x < level.size.x; ++x) {
      const float a = level.at(x, y), b = level.at(x + 1, y), c = level.at(x, y + 1), d = level.at(x + 1, y + 1);
      for (int j = 0; j < each.y; ++j)
        for (int i = 0; i < each.x; ++i) {
          const float u = (static_cast<float>(i) + 0.5f) / static_cast<float>(each.x),
                      v = (static_cast<float>(j) + 0.5f) / static_cast<float>(each.y);
          samples.push_back(glm::mix(glm::mix(a, b, u), glm::mix(c, d, u), v));
        }
    }
  return samples;
}

constexpr float kCut = 127.5f, kAbove = 128.0f;

double coverageOf(const Level& level) {
  const std::vector<float> samples = samplesOf(level);
  return static_cast<double>(std::ranges::count_if(samples, [](float v) { return v >= kCut; })) /
         static_cast<double>(samples.size());
}

}  // namespace

double maskCoverage(const std::vector<std::uint8_t>& texels, glm::ivec2 size) {
  return coverageOf(levelOf(texels, size));
}

std::vector<std::vector<std::uint8_t>> maskLevels(const std::vector<std::uint8_t>& texels, glm::ivec2 size) {
  std::vector<std::vector<std::uint8_t>> levels;
  Level level = levelOf(texels, size);
  const double coverage = coverageOf(level);
  while (level.size != glm::ivec2(1)) {
    level = halved(level);
    std::vector<float> samples = samplesOf(level);
    // The value that as many samples reach as shall be covered is brought to the cut. Of equal samples all count or
    // none, whichever is nearer.
    const double covered = coverage * static_cast<double>(samples.size());
    float scale = 1.0f;
    if (covered > 0.0 && covered < static_cast<double>(samples.size())) {
      std::ranges::sort(samples, std::greater<>{});
      const float value = samples[static_cast<std::size_t>(covered)];
      const auto first = std::lower_bound(samples.begin(), samples.end(), value, std::greater<>{}),
                 last = std::upper_bound(samples.begin(), samples.end(), value, std::greater<>{});
      const bool counts = static_cast<double>(last - samples.begin()) - covered <
                          covered - static_cast<double>(first - samples.begin());
      const float least = counts || first == samples.begin() ? value : *(first - 1);
      if (least > 0.0f) scale = (counts || first != samples.begin() ? kAbove : kCut - 1.0f) / least;
    }
    std::vector<std::uint8_t>& stored = levels.emplace_back();
    for (const float value : level.values)
      stored.push_back(static_cast<std::uint8_t>(std::clamp(std::lround(scale * value), 0L, 255L)));
  }
  return levels;
}

}  // namespace lucerna
