// lucerna compare A B: errors of A with B as the reference, with heat maps on request.
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/provenance.hpp"
#include "shared/contact_sheet.hpp"
#include "shared/figure.hpp"
#include "shared/html.hpp"
#include "shared/commands.hpp"
#include "measure/flip.hpp"
#include "measure/heat_map.hpp"
#include "measure/image_errors.hpp"
#include "shared/shell.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace lucerna::demo {

namespace {

struct CompareOptions {
  CommonOptions common;
  std::string image, reference, heatMap, page, standardError;
};

/// The pair as one page with the reports' figure: A against B, without times.
void writePage(const CompareOptions& options, const Image& image, const Image& reference, const measure::ImageErrors& e,
               const measure::Flip& flip) {
  std::optional<Image> error;
  measure::ReferenceNoise noise;
  if (!options.standardError.empty()) {
    error = readImage(options.standardError);
    if (error->width != reference.width || error->height != reference.height)
      throwBadInput("--standard-error {}: not the same size as {}", options.standardError, options.reference);
    noise = measure::noiseOf(reference, *error, 0.0);
  }
  const measure::JudgedErrors judged = measure::lessNoise(e, noise);
  nlohmann::ordered_json row{{"label", options.image},
                             {"series", "A"},
                             {"pareto", true},
                             {"front", 1},
                             {"inside_front", true},
                             {"at_noise", error && judged.atNoise},
                             {"bias_at_noise", false},
                             {"l2", judged.l2},
                             {"nrmse", judged.nrmse},
                             {"relmse", judged.relmse},
                             {"bias", e.bias},
                             {"relative_bias", e.relativeBias},
                             {"flip", flip.mean},
                             {"noise_l2", judged.noiseL2},
                             {"noise_nrmse", judged.noiseNrmse},
                             {"noise_relmse", judged.noiseRelmse}};
  for (const char* key : {"ms", "setup_ms", "cpu_ms", "bias_error"}) row[key] = nullptr;
  bench::Figure figure;
  std::vector<std::string> words{"lucerna", "compare", options.image, options.reference};
  if (error) words.insert(words.end(), {"--standard-error", options.standardError});
  figure.facts = {{"title", options.image + " against " + options.reference},
                  {"program", programVersion()},
                  {"cpu", cpuName()},
                  {"command", bench::shellCommand(words)},
                  {"exposure", 1.0},
                  {"relmse_epsilon", measure::kRelativeEpsilon},
                  {"rows", nlohmann::ordered_json::array({row})}};
  figure.references.push_back({options.reference, &reference, error ? &*error : nullptr});
  bench::FigurePicture picture;
  picture.picture = &image;
  if (!flip.map.empty()) {
    picture.flip.width = image.width, picture.flip.height = image.height;
    for (const float v : flip.map)
      picture.flip.rgba.insert(picture.flip.rgba.end(), 4,
                               static_cast<std::uint8_t>(std::lround(255.0f * std::clamp(v, 0.0f, 1.0f))));
  }
  figure.pictures.push_back(std::move(picture));
  bench::HtmlPage page("Lucerna: " + options.image + " against " + options.reference);
  page.figure(bench::figureHtml(figure, bench::kPageBytes));
  writeFileAtomically(options.page, page.text());
}

void writeHeatMaps(const std::string& file, const Image& image, const Image& reference, double scale) {
  using measure::HeatMap;
  if (!(scale > 0.0)) scale = 1.0;  // equal pictures: any scale will do
  const auto tile = [&](HeatMap kind) {
    const Bitmap picture = measure::heatMap(image, reference, kind, scale),
                 legend = measure::heatMapLegend(kind, picture.width, std::max(4, picture.height / 16));
    Bitmap both = picture;
    both.height += legend.height;
    both.rgba.insert(both.rgba.end(), legend.rgba.begin(), legend.rgba.end());
    return both;
  };
  writePng(
      file,
      bench::contactSheet(
          "A less B, radiance",
          {{fmt::format("absolute: 0 (black) to {:.3g} and more (white)", scale), tile(HeatMap::absolute)},
           {fmt::format("signed luminance: -{0:.3g} (blue) to {0:.3g} (red)", scale), tile(HeatMap::signedLuminance)}},
          2));
}

int runCompare(const CompareOptions& options) {
  options.common.apply();
  if (!options.heatMap.empty() && lowerExtension(options.heatMap) != ".png")
    throwBadInput("--heatmap {}: the extension must be png", options.heatMap);
  const Image image = readImage(options.image), reference = readImage(options.reference);
  const measure::ImageErrors e = measure::errorsOf(image, reference);
  const int side = measure::blockSide(reference.width);
  const measure::ImageErrors blocks =
      measure::errorsOf(measure::blockMeans(image, side), measure::blockMeans(reference, side));
  const double blackNrmse = std::sqrt(e.referenceSquare) / e.referenceMean;
  measure::Flip flipped{NAN, {}};
  if (e.notFinite == 0) flipped = measure::flipHdr(image, reference);
  const double flip = flipped.mean;
  if (!options.page.empty()) writePage(options, image, reference, e, flipped);
  if (!options.heatMap.empty())
    writeHeatMaps(options.heatMap, image, reference, measure::heatMapScale(image, reference));
  if (!options.common.quiet) {
    fmt::print("{} against {}, {}x{}, linear radiance, mean of the reference {:.6g}\n", options.image,
               options.reference, image.width, image.height, e.referenceMean);
    fmt::print("relative L2 {:.4f} % (a black picture has 100 %), averaged over blocks of {}x{} pixels {:.4f} %\n",
               100.0 * e.l2, side, side, 100.0 * blocks.l2);
    fmt::print(
        "RMSE {:.6g}   NRMSE {:.4f} % (a black picture has {:.4f} %)   relative MSE {:.6g} (epsilon {} mean^2)\n",
        e.rmse, 100.0 * e.nrmse, 100.0 * blackNrmse, e.relmse, measure::kRelativeEpsilon);
    fmt::print("bias {:+.6g} ({:+.4f} %)   99th percentile {:.6g}   largest {:.6g}   HDR-FLIP {:.4f}\n", e.bias,
               100.0 * e.relativeBias, e.p99, e.max, flip);
    if (e.notFinite > 0) fmt::print("{} pixels are not finite, so no measure is either\n", e.notFinite);
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

Work addCompare(Command app) {
  auto options = std::make_shared<CompareOptions>();
  app.addOption("A", options->image, "a picture: hdr, exr, pfm, or png, jpg, tga, bmp taken as sRGB").required();
  app.addOption("B", options->reference, "the reference, of the same size").required();
  app.addOption("--heatmap", options->heatMap, "OUT.png: absolute and signed differences side by side");
  app.addOption("--page", options->page,
                "OUT.html: both in the reports' viewer, with maps and values under the cursor");
  app.addOption("--standard-error", options->standardError,
                "with --page: B's standard error of each pixel, such as of lucerna merge --error; gives z-scores");
  options->common.declare(app);
  return [options] { return runCompare(*options); };
}

}  // namespace lucerna::demo
