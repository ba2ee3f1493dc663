// lucerna compare A B: errors of A, taking B for the truth, with heat maps where asked.
#include "base/error.hpp"
#include "base/files.hpp"
#include "bench/contact_sheet.hpp"
#include "commands.hpp"
#include "measure/flip.hpp"
#include "measure/heat_map.hpp"
#include "measure/image_errors.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace lucerna::demo {

namespace {

struct Options {
  CommonOptions common;
  std::string image, reference, heatMap;
};

void writeHeatMaps(const std::string& file, const Image& image, const Image& reference, double scale) {
  using measure::HeatMap;
  if (!(scale > 0.0)) scale = 1.0;  // equal pictures: any scale shows that
  const auto tile = [&](HeatMap kind) {
    const Bitmap picture = measure::heatMap(image, reference, kind, scale), legend = measure::heatMapLegend(kind, picture.width, std::max(4, picture.height / 16));
    Bitmap both = picture;
    both.height += legend.height;
    both.rgba.insert(both.rgba.end(), legend.rgba.begin(), legend.rgba.end());
    return both;
  };
  writePng(file, bench::contactSheet("A less B, radiance", {{fmt::format("absolute: 0 (black) to {:.3g} and more (white)", scale), tile(HeatMap::absolute)},
                                                            {fmt::format("signed luminance: -{0:.3g} (blue) to {0:.3g} (red)", scale), tile(HeatMap::signedLuminance)}},
                                     2));
}

int run(const Options& options) {
  options.common.apply();
  if (!options.heatMap.empty() && lowerExtension(options.heatMap) != ".png") throwBadInput("--heatmap {}: the extension must be png", options.heatMap);
  const Image image = readImage(options.image), reference = readImage(options.reference);
  const measure::ImageErrors e = measure::errorsOf(image, reference);
  const int side = measure::blockSide(reference.width);
  const measure::ImageErrors blocks =
      measure::errorsOf(measure::blockMeans(image, side), measure::blockMeans(reference, side));
  const double blackNrmse = std::sqrt(e.referenceSquare) / e.referenceMean;
  const double flip = e.notFinite > 0 ? NAN : measure::flipHdr(image, reference).mean;
  if (!options.heatMap.empty()) writeHeatMaps(options.heatMap, image, reference, measure::heatMapScale(image, reference));
  if (!options.common.quiet) {
    fmt::print("{} against {}, {}x{}, linear radiance, mean of the reference {:.6g}\n", options.image, options.reference, image.width, image.height, e.referenceMean);
    fmt::print("relative L2 {:.4f} % (a black picture has 100 %), averaged over blocks of {}x{} pixels {:.4f} %\n",
               100.0 * e.l2, side, side, 100.0 * blocks.l2);
    fmt::print(
        "RMSE {:.6g}   NRMSE {:.4f} % (a black picture has {:.4f} %)   relative MSE {:.6g} (epsilon {} mean^2)\n",
        e.rmse, 100.0 * e.nrmse, 100.0 * blackNrmse, e.relmse, measure::kRelativeEpsilon);
    fmt::print("bias {:+.6g} ({:+.4f} %)   99th percentile {:.6g}   largest {:.6g}   HDR-FLIP {:.4f}\n", e.bias, 100.0 * e.relativeBias, e.p99, e.max, flip);
    if (e.notFinite > 0) fmt::print("{} pixels are not finite, so no figure is\n", e.notFinite);
  }
  options.common.writeJson({{"a", options.image},
                            {"b", options.reference},
                            {"size", {image.width, image.height}},
                            {"rmse", e.rmse},
                            {"nrmse", e.nrmse},
                            {"nrmse_black", blackNrmse},
                            {"nrmse_blocks", blocks.nrmse},
                            {"l2", e.l2},
                            {"l2_blocks", blocks.l2},
                            {"block_side", side},
                            {"relmse", e.relmse},
                            {"relmse_epsilon", measure::kRelativeEpsilon},
                            {"bias", e.bias},
                            {"relative_bias", e.relativeBias},
                            {"channel_bias", {e.channelBias.x, e.channelBias.y, e.channelBias.z}},
                            {"p99", e.p99},
                            {"max", e.max},
                            {"flip", flip},
                            {"reference_mean", e.referenceMean},
                            {"not_finite", e.notFinite}});
  return 0;
}

}  // namespace

Work addCompare(CLI::App& app) {
  auto options = std::make_shared<Options>();
  app.add_option("A", options->image, "a picture: hdr, exr, pfm, or png, jpg, tga, bmp taken as sRGB")->required();
  app.add_option("B", options->reference, "the reference, of the same size")->required();
  app.add_option("--heatmap", options->heatMap, "OUT.png: absolute and signed differences side by side");
  options->common.declare(app);
  return [options] { return run(*options); };
}

}  // namespace lucerna::demo
