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

  float at(int x, int y) const {
    return values[static_cast<std::size_t>(y) * static_cast<std::size_t>(size.x) + static_cast<std::size_t>(x)];
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

/// Between the middles of two texels.
struct Between {
  int low, high;
  float share;  ///< of `high`
};

/// Points along one direction, spread evenly over the picture; more of them where texels are few. Beyond the edge lie
/// the texels of the other side or, clamped or mirrored, those of the edge again.
std::vector<Between> pointsAlong(int size, TextureWrap wrap) {
  constexpr int kLeast = 256;
  const int each = std::max(kLeast / size, 1);
  const bool repeats = wrap == TextureWrap::repeat;
  const auto texel = [&](int i) { return repeats ? (i + size) % size : std::clamp(i, 0, size - 1); };
  std::vector<Between> points;
  points.reserve(static_cast<std::size_t>(size * each));
  // From the middle of the first texel or, where the picture does not repeat, half a texel before.
  for (int i = repeats ? 0 : each / 2; i < size * each + (repeats ? 0 : each / 2); ++i) {
    const int low = i / each - (repeats ? 0 : 1);
    points.push_back({texel(low), texel(low + 1), (static_cast<float>(i % each) + 0.5f) / static_cast<float>(each)});
  }
  return points;
}

/// The bilinear interpolation at points that are spread evenly.
std::vector<float> samplesOf(const Level& level, TextureWraps wraps) {
  const std::vector<Between> columns = pointsAlong(level.size.x, wraps.u), rows = pointsAlong(level.size.y, wraps.v);
  std::vector<float> samples;
  samples.reserve(columns.size() * rows.size());
  for (const Between& row : rows)
    for (const Between& column : columns)
      samples.push_back(
          glm::mix(glm::mix(level.at(column.low, row.low), level.at(column.high, row.low), column.share),
                   glm::mix(level.at(column.low, row.high), level.at(column.high, row.high), column.share), row.share));
  return samples;
}

constexpr float kCut = 127.5f, kAbove = 128.0f;

double coverageOf(const Level& level, TextureWraps wraps) {
  const std::vector<float> samples = samplesOf(level, wraps);
  return static_cast<double>(std::ranges::count_if(samples, [](float v) { return v >= kCut; })) /
         static_cast<double>(samples.size());
}

}  // namespace

double maskCoverage(const std::vector<std::uint8_t>& texels, glm::ivec2 size, TextureWraps wraps) {
  return coverageOf(levelOf(texels, size), wraps);
}

std::vector<std::vector<std::uint8_t>> maskLevels(const std::vector<std::uint8_t>& texels, glm::ivec2 size,
                                                  TextureWraps wraps) {
  std::vector<std::vector<std::uint8_t>> levels;
  Level level = levelOf(texels, size);
  const double coverage = coverageOf(level, wraps);
  while (level.size != glm::ivec2(1)) {
    level = halved(level);
    std::vector<float> samples = samplesOf(level, wraps);
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
    if (std::abs(maskCoverage(stored, level.size, wraps) - coverage) > 0.02 + 0.05 * coverage) {
      levels.pop_back();
      break;
    }
  }
  return levels;
}

}  // namespace lucerna
