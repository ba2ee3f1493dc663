// The pictures of the VPT original [VPT2024, 5.7 to 5.20] reproduced with our scenes, on one labelled sheet.
#include "shared/contact_sheet.hpp"
#include "originals/vpt_series.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>

namespace lucerna::demo::bench {

namespace {

/// Time limit for a picture with fewer than the published samples: on a slow machine pictures become noisier rather
/// than missing.
constexpr double kMostSecondsAPicture = 20.0;
constexpr int kZoom = 6;  // for figure 5.11

float luminance(const glm::vec3& c) { return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z; }

/// The middle, each pixel enlarged to a square of kZoom.
Bitmap zoomed(const Bitmap& picture) {
  Bitmap result = picture;
  const int left = (picture.width - picture.width / kZoom) / 2, top = (picture.height - picture.height / kZoom) / 2;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const auto from = 4 * (static_cast<std::size_t>(top + y / kZoom) * static_cast<std::size_t>(picture.width) +
                             static_cast<std::size_t>(left + x / kZoom));
      const auto to =
          4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) + static_cast<std::size_t>(x));
      std::copy_n(picture.rgba.begin() + static_cast<std::ptrdiff_t>(from), 4,
                  result.rgba.begin() + static_cast<std::ptrdiff_t>(to));
    }
  return result;
}

/// Counts pixels below a twentieth of the median of their eight neighbours: the published black fragments.
int blackPixels(const Image& image) {
  int count = 0;
  for (int y = 1; y + 1 < image.height; ++y)
    for (int x = 1; x + 1 < image.width; ++x) {
      std::array<float, 8> around{};
      std::size_t k = 0;
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx)
          if (dx != 0 || dy != 0) around[k++] = luminance(image.at(x + dx, y + dy));
      std::nth_element(around.begin(), around.begin() + 4, around.end());
      count += luminance(image.at(x, y)) < 0.05f * around[4];
    }
  return count;
}

class Drawing {
 public:
  Drawing(const VptTablesInput& input, glm::ivec2 size, std::optional<double> exposure)
      : input_(input),
        size_(size),
        exposure_(exposure),
        published_(input.fidelity != Fidelity::corrected),
        progress_("bench pictures",
                  static_cast<int>((vptPictures().size() + (published_ ? vptUntimedPictures().size() + 1 : 0)) *
                                   (published_ ? 2 : 1)),
                  input.quiet) {}

  /// Adds a tile of a picture by an estimator, on the scene lit for that estimator.
  VptResult add(const VptPicture& picture, Fidelity fidelity, const PathDeviations& deviations,
                const std::string& note) {
    const Scene scene = loadVptScene(picture, fidelity);
    VptResult drawn =
        renderVpt(input_.context, input_.programs, picture, scene, size_, vptSamples(picture, input_.scale),
                  input_.scale < 1.0 ? kMostSecondsAPicture : 0.0, deviations);
    const glm::dvec3 mean = drawn.statistics.mean;
    const std::string label = fmt::format("{}  {}{}", picture.figure, picture.label, note);
    tiles.push_back({fmt::format("{} ({:.3g} spp, mean {:.3g}, noise {:.2g})", label, drawn.statistics.samples,
                                 luminance(glm::vec3(mean)), drawn.statistics.relativeError),
                     toneMapped(drawn.image, exposure_ ? static_cast<float>(*exposure_) : scene.exposure)});
    json.push_back({{"picture", label},
                    {"mean", {mean.x, mean.y, mean.z}},
                    {"spp", drawn.statistics.samples},
                    {"ms", drawn.ms},
                    {"relative_error", drawn.statistics.relativeError},
                    {"black_pixels", blackPixels(drawn.image)},
                    {"iterations", drawn.statistics.iterations},
                    {"leaked_paths", drawn.statistics.leakedPaths},
                    {"wrong_crossings", drawn.statistics.wrongCrossings}});
    progress_.update(static_cast<int>(json.size()));
    return drawn;
  }

  /// A picture by the requested estimator; next to the published one, the corrected one.
  void addBoth(const VptPicture& picture) {
    add(picture, input_.fidelity, vptDeviations(picture, input_.fidelity), "");
    if (published_ && !interrupted()) add(picture, Fidelity::corrected, {}, ", corrected, lit by an area");
  }

  /// Figure 5.11: the last two tiles of figure 5.10, enlarged.
  void addZoom(const std::string& label, std::size_t tile) { tiles.push_back({label, zoomed(tiles.at(tile).picture)}); }

  bool published() const { return published_; }

  std::vector<Tile> tiles;
  nlohmann::ordered_json json = nlohmann::ordered_json::array();

 private:
  const VptTablesInput& input_;
  glm::ivec2 size_;
  std::optional<double> exposure_;
  bool published_;
  Progress progress_;
};

}  // namespace

VptSheet drawVptPictures(const VptTablesInput& input, glm::ivec2 size, std::optional<double> exposure) {
  Drawing drawing(input, size, exposure);
  if (drawing.published())
    for (const VptPicture& picture : vptUntimedPictures())
      if (!interrupted()) drawing.add(picture, input.fidelity, vptDeviations(picture, input.fidelity), "");
  std::vector<std::pair<std::string, std::size_t>> enlarged;
  for (const VptPicture& picture : vptPictures()) {
    if (interrupted()) break;
    if (std::string_view(picture.figure).starts_with("5.10"))
      enlarged.emplace_back(picture.label, drawing.tiles.size());
    drawing.addBoth(picture);
    if (std::string_view(picture.figure) != "5.10 b") continue;
    for (const auto& [label, tile] : enlarged)
      drawing.addZoom(fmt::format("5.11  {}, the middle {} times", label, kZoom), tile);
    if (!drawing.published() || interrupted()) continue;
    // The black fragments that the text attributes to the offsets of its rays, and their cure.
    PathDeviations cured = vptDeviations(picture, input.fidelity);
    cured.fixedEpsilon = false;
    drawing.add(picture, input.fidelity, cured, ", without path.fixed-epsilon");
  }
  VptSheet result;
  result.tiles = drawing.tiles.size();
  result.json = drawing.json;
  if (drawing.tiles.empty()) return result;
  const std::string title = fmt::format(
      "VPT original, pictures {} to 5.20, on scenes of our own, {}; samples: the published ones times {}, as far as "
      "{:.0f} s a picture go",
      drawing.published() ? "5.7" : "5.8",
      drawing.published() ? "published estimator lit by points, corrected beside it" : "corrected estimator",
      input.scale, kMostSecondsAPicture);
  result.sheet = contactSheet(title, drawing.tiles, 4);
  return result;
}

}  // namespace lucerna::demo::bench
