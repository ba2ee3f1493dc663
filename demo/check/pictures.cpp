// lucerna check, part pictures: each technique at 160x90 against values stored with the program
// (assets/check/reference.json, from Mesa's software renderer).
//
// A picture is summarised by the mean of each block of 10x10 pixels, the range of values in and around it, and
// quantiles of all pixels. What OpenGL leaves open (docs/drivers.md) bounds the differences:
// - An edge within 1/256 pixel of a pixel's centre covers it on one driver alone. Where an edge follows a row of
//   centres, a whole row of the block changes: a tenth of the block's range.
// - Linear filters have weights of 8 bits: 1/256 of what is filtered. Levels of detail are approximated.
// - Over the whole picture edges are few and change either way: the mean keeps to 1/200, the blocks to 2 % rms.
// The path tracer has no rasteriser and no filters: its blocks agree to the rounding of 32-bit floats, 1e-6 rms, but
// for a few in which rounding sends a path elsewhere.
#include "check/check.hpp"

#include "base/clock.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/json.hpp"
#include "base/provenance.hpp"
#include "base/statistics.hpp"
#include "bench/bench.hpp"
#include "gl/draw.hpp"
#include "measure/image_errors.hpp"
#include "radiosity/radiosity_view.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace lucerna::demo::check {

namespace {

constexpr glm::ivec2 kSize{160, 90};
constexpr int kSide = 10, kQuantiles = 20;

constexpr double kEdge = 1.0 / kSide;  ///< of a block's range: a row of its pixels
constexpr double kFilter = 1.0 / 256.0;  ///< of a block's mean: a weight of 8 bits
constexpr double kNothing = 1e-3;  ///< of the picture's mean: blocks that are nearly black
constexpr double kMean = 1.0 / 200.0, kBlocks = 0.02;
constexpr double kRank = 0.01, kLevel = 1.0 / 128.0;  ///< of quantiles: share of the pixels, share of the value
constexpr double kPaths = 1e-6;
constexpr std::size_t kStray = 3;  ///< blocks in which a path went elsewhere

struct Summary {
  struct Block {
    glm::dvec3 mean;
    double range;
  };
  std::vector<Block> blocks;  ///< row by row, from the top
  std::vector<double> values;  ///< mean over the channels of each pixel, ascending
  glm::dvec3 mean{0.0};
  std::size_t notFinite = 0;
};

double valueOf(const glm::vec3& pixel) {
  return (static_cast<double>(pixel.x) + static_cast<double>(pixel.y) + static_cast<double>(pixel.z)) / 3.0;
}

Summary summaryOf(const Image& image) {
  Summary summary;
  for (int top = 0; top < image.height; top += kSide)
    for (int left = 0; left < image.width; left += kSide) {
      Summary::Block block{glm::dvec3(0.0), 0.0};
      glm::vec3 least(INFINITY), most(-INFINITY);
      // A pixel more on each side: edges move in from there.
      for (int y = std::max(top - 1, 0); y < std::min(top + kSide + 1, image.height); ++y)
        for (int x = std::max(left - 1, 0); x < std::min(left + kSide + 1, image.width); ++x) {
          const glm::vec3& pixel = image.at(x, y);
          least = glm::min(least, pixel), most = glm::max(most, pixel);
          if (x >= left && x < left + kSide && y >= top && y < top + kSide) block.mean += glm::dvec3(pixel);
        }
      block.mean /= kSide * kSide;
      block.range = std::max({most.x - least.x, most.y - least.y, most.z - least.z});
      summary.mean += block.mean;
      summary.blocks.push_back(block);
    }
  summary.mean /= static_cast<double>(summary.blocks.size());
  for (const glm::vec3& pixel : image.pixels) {
    const double value = valueOf(pixel);
    summary.notFinite += !std::isfinite(value);
    summary.values.push_back(value);
  }
  std::sort(summary.values.begin(), summary.values.end());
  return summary;
}

nlohmann::ordered_json summaryJson(const Summary& summary) {
  const auto rounded = [](double value) { return std::stod(fmt::format("{:.9g}", value)); };
  nlohmann::ordered_json json{{"quantiles", nlohmann::ordered_json::array()},
                              {"blocks", nlohmann::ordered_json::array()}};
  for (int i = 0; i <= kQuantiles; ++i)
    json["quantiles"].push_back(rounded(percentile(summary.values, static_cast<double>(i) / kQuantiles)));
  for (const Summary::Block& block : summary.blocks)
    json["blocks"].push_back(
        {rounded(block.mean.x), rounded(block.mean.y), rounded(block.mean.z), rounded(block.range)});
  return json;
}

/// The stored values of a picture.
struct Stored {
  std::vector<double> quantiles;
  std::vector<Summary::Block> blocks;
  glm::dvec3 mean{0.0};
};

Stored storedOf(const std::string& file, const std::string& name) {
  const auto json = parseJson(readFileText(file), file);
  Stored stored;
  try {
    const auto& picture = json.at("pictures").at(name);
    stored.quantiles = picture.at("quantiles").get<std::vector<double>>();
    for (const auto& block : picture.at("blocks")) {
      const auto v = block.get<std::array<double, 4>>();
      stored.blocks.push_back({{v[0], v[1], v[2]}, v[3]});
      stored.mean += stored.blocks.back().mean;
    }
  } catch (const nlohmann::json::exception& error) { throwBadInput("{}: picture {}: {}", file, name, error.what()); }
  if (stored.quantiles.size() != kQuantiles + 1 || stored.blocks.size() != (kSize.x / kSide) * (kSize.y / kSide))
    throwBadInput("{}: picture {}: {} quantiles and {} blocks", file, name, stored.quantiles.size(),
                  stored.blocks.size());
  stored.mean /= static_cast<double>(stored.blocks.size());
  return stored;
}

struct Comparison {
  double mean = 0.0;  ///< largest difference of a channel's mean, over the mean
  double blocks = 0.0;  ///< root mean square difference of blocks, over the mean
  double rest = 0.0;  ///< the same without the kStray blocks that differ most
  double worst = 0.0;  ///< largest difference of a block, over its bound for raster techniques
  glm::ivec2 place{0};  ///< of that block's middle, in pixels from the top left
  double ranks = 0.0;  ///< largest share of pixels on the wrong side of a quantile
  std::size_t notFinite = 0;

  bool isRight(bool isPath) const {
    if (notFinite > 0) return false;
    if (isPath) return rest <= kPaths && worst <= 1.0;
    return mean <= kMean && blocks <= kBlocks && worst <= 1.0 && ranks <= kRank;
  }
};

Comparison compare(const Summary& measured, const Stored& stored) {
  Comparison result;
  result.notFinite = measured.notFinite;
  const double level = (stored.mean.x + stored.mean.y + stored.mean.z) / 3.0;
  for (int c = 0; c < 3; ++c) result.mean = std::max(result.mean, std::abs(measured.mean[c] - stored.mean[c]) / level);
  std::vector<double> squares;  // of each block, summed over the channels
  for (std::size_t i = 0; i < stored.blocks.size(); ++i) {
    squares.push_back(0.0);
    const Summary::Block &a = measured.blocks[i], &b = stored.blocks[i];
    const double bound = kEdge * b.range + kFilter * (b.mean.x + b.mean.y + b.mean.z) / 3.0 + kNothing * level;
    for (int c = 0; c < 3; ++c) {
      const double difference = std::abs(a.mean[c] - b.mean[c]);
      squares.back() += difference * difference;
      if (difference / bound <= result.worst) continue;
      result.worst = difference / bound;
      const int columns = kSize.x / kSide, at = static_cast<int>(i);
      result.place = kSide * glm::ivec2(at % columns, at / columns) + kSide / 2;
    }
  }
  std::sort(squares.begin(), squares.end());
  const auto rms = [&](std::size_t count) {
    double sum = 0.0;
    for (std::size_t i = 0; i < count; ++i) sum += squares[i];
    return std::sqrt(sum / (3.0 * static_cast<double>(count))) / level;
  };
  result.blocks = rms(squares.size());
  result.rest = rms(squares.size() - kStray);
  // The share p of the pixels lies below quantile p: of many equal values, any share of them.
  const auto shareBelow = [&](double value) {
    const auto below = std::lower_bound(measured.values.begin(), measured.values.end(), value);
    return static_cast<double>(below - measured.values.begin()) / static_cast<double>(measured.values.size());
  };
  for (int i = 0; i <= kQuantiles; ++i) {
    const double p = static_cast<double>(i) / kQuantiles, value = stored.quantiles[static_cast<std::size_t>(i)],
                 slack = kLevel * std::abs(value) + kNothing * level;
    result.ranks = std::max({result.ranks, shareBelow(value - slack) - p, p - shareBelow(value + slack)});
  }
  return result;
}

/// The picture, with the seconds of its first frame: drivers finish compiling there.
Image render(Session& session, const Requested& asked, double& seconds) {
  at("loading " + asked.scene);
  const Scene scene = loadScene(bench::asset(asked.scene));
  const RenderSettings settings = asked.parse(kSize);
  Renderer renderer(session.context, session.programs, scene, settings);
  at("rendering");
  const auto start = Clock::now();
  renderer.renderToTheEnd(scene.cameras.front());
  gl::finish();
  seconds = secondsSince(start);
  return renderer.readRadiance();
}

Finding comparePicture(const Requested& asked, const UnitInput& input) {
  const Stored stored = storedOf(input.reference, asked.name);
  Session session(input);
  double seconds = 0.0;
  const Image image = render(session, asked, seconds);
  writeImage(std::filesystem::path(input.out) / "pictures" / (asked.name + ".exr"), image);
  const Comparison c = compare(summaryOf(image), stored);
  Finding finding;
  finding.right = c.isRight(asked.isPath());
  finding.text = c.notFinite > 0 ? fmt::format("{} pixels are not finite", c.notFinite)
                                 : fmt::format("mean {:.1e}, blocks {:.1e} rms off", c.mean, c.blocks);
  if (!finding.right && c.notFinite == 0)
    finding.text += fmt::format("; worst at {},{}: {:.3g} of its bound; {:.1f} % of pixels displaced", c.place.x,
                                c.place.y, c.worst, 100.0 * c.ranks);
  finding.text += fmt::format(" ({:.2f} s)", seconds);
  finding.figures = {{"mean", c.mean},
                     {"blocks_rms", c.blocks},
                     {"rest_rms", c.rest},
                     {"worst_of_bound", c.worst},
                     {"ranks", c.ranks},
                     {"not_finite", c.notFinite},
                     {"place", {c.place.x, c.place.y}},
                     {"seconds", seconds}};
  return finding;
}

}  // namespace

RenderSettings Requested::parse(glm::ivec2 size, const std::vector<std::string>& more) const {
  PictureOptions options;
  options.technique = technique;
  options.settings = settings;
  options.settings.insert(options.settings.end(), more.begin(), more.end());
  options.size = fmt::format("{}x{}", size.x, size.y);
  RenderSettings result = options.parse();
  result.pixelSamples = 1;
  result.fullFloatTarget = true;
  result.textures.anisotropy = 1.0f;  // how textures are filtered anisotropically is each driver's own
  if (result.of<RadiosityView::Settings>().direct == RadiosityView::Direct::automatic)
    result.of<RadiosityView::Settings>().direct = RadiosityView::Direct::pixels;
  return result;
}

const std::vector<Requested>& requestedPictures() {
  static const std::vector<Requested> pictures{
      {"path-cornell", "cornell/cornell.json", "path", {"path.samples=4"}},
      {"direct-atrium", "atrium/atrium.json", "direct", {}},
      {"cache-cornell", "cornell/cornell.json", "irradiance-cache", {}},
      {"cache-atrium", "atrium/atrium.json", "irradiance-cache", {"cache.samples=64"}},
      {"lpv-cornell", "cornell/cornell.json", "lpv", {}},
      {"lpv-atrium", "atrium/atrium.json", "lpv", {"lpv.bounces=4"}},
      {"gather-cornell", "cornell/cornell.json", "irradiance-cache", {"cache.transport=gather"}},
      {"rsm-cornell", "cornell/cornell.json", "rsm", {}},
      {"rsm-atrium", "atrium/atrium.json", "rsm", {}},
      {"radiosity-cornell", "cornell/cornell.json", "radiosity", {"radiosity.edge=0.1"}},
      {"path-gems", "media/gems/gems.json", "path", {"path.samples=1"}},
      {"path-smoke", "media/smoke/smoke.json", "path", {"path.samples=1"}}};
  return pictures;
}

std::vector<Unit> pictureUnits() {
  std::vector<Unit> units;
  for (const Requested& asked : requestedPictures())
    units.push_back(
        {"pictures", asked.name, 60.0, [&](const UnitInput& input) { return comparePicture(asked, input); }});
  return units;
}

void writeReference(const CommonOptions& common, const std::string& file) {
  UnitInput input;
  input.common = common;
  Session session(input);
  nlohmann::ordered_json json{{"renderer", session.context.capabilities().renderer},
                              {"driver", session.context.capabilities().version},
                              {"cpu", cpuName()}};
  for (const Requested& asked : requestedPictures()) {
    double seconds = 0.0;
    json["pictures"][asked.name] = summaryJson(summaryOf(render(session, asked, seconds)));
  }
  // A line a block, so that changes can be read.
  std::string text = json.dump();
  for (const std::string& from : {std::string("[["), std::string("],[")})
    for (std::size_t place = 0; (place = text.find(from, place)) != std::string::npos; place += from.size() + 1)
      text.insert(place + from.size() - 1, "\n");
  writeFileAtomically(file, text + "\n");
}

}  // namespace lucerna::demo::check
