// The pictures of the VPT original [VPT2024, 5.8 to 5.20] made again on scenes of ours, on one labelled sheet.
#include "bench/contact_sheet.hpp"
#include "bench/vpt_series.hpp"

#include <fmt/core.h>

namespace lucerna::demo::bench {

namespace {
/// That a picture with fewer than the published samples may take: what a slow machine does not get done is noisier, not left out.
constexpr double kMostSeconds = 20.0;
}  // namespace

VptSheet drawVptPictures(const VptTablesInput& input, glm::ivec2 size, std::optional<double> exposure) {
  const auto& pictures = vptPictures();
  std::vector<Tile> tiles;
  VptSheet result;
  Progress progress("bench pictures", static_cast<int>(pictures.size()), input.quiet);
  for (const VptPicture& picture : pictures) {
    if (interrupted()) break;
    const Scene scene = loadVptScene(picture);
    const std::uint32_t samples = vptSamples(picture, input.scale);
    const VptResult drawn = renderVpt(input.context, input.programs, picture, scene, size, samples, input.scale < 1.0 ? kMostSeconds : 0.0);
    const glm::dvec3 mean = drawn.statistics.mean;
    tiles.push_back({fmt::format("{}  {} ({:.3g} spp, mean {:.3g})", picture.figure, picture.label, drawn.statistics.samples, 0.2126 * mean.x + 0.7152 * mean.y + 0.0722 * mean.z),
                     toneMapped(drawn.image, exposure ? static_cast<float>(*exposure) : scene.exposure)});
    result.json.push_back({{"picture", fmt::format("{} {}", picture.figure, picture.label)}, {"mean", {mean.x, mean.y, mean.z}}, {"spp", drawn.statistics.samples}, {"ms", drawn.ms},
                           {"leaked_paths", drawn.statistics.leakedPaths}, {"wrong_crossings", drawn.statistics.wrongCrossings}});
    progress.update(static_cast<int>(tiles.size()));
  }
  result.tiles = tiles.size();
  if (tiles.empty()) return result;
  const std::string title = fmt::format("VPT original, pictures 5.8 to 5.20, on scenes of our own, corrected estimator; samples: the published ones times {}, as far as {:.0f} s a picture go", input.scale, kMostSeconds);
  result.sheet = contactSheet(title, tiles, 4);
  return result;
}

}  // namespace lucerna::demo::bench
