#include "merge.hpp"

#include "base/error.hpp"
#include "base/files.hpp"
#include "commands.hpp"
#include "pathtracer/film.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace lucerna::demo {

namespace {

struct Options {
  CommonOptions common;
  std::vector<std::string> parts;
  std::string folder, output, checkpoint, errorOutput;
  double exposure = 1.0;
};

int run(Options options) {
  options.common.apply();
  if (!options.folder.empty()) {
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator(options.folder, error))
      if (entry.path().extension() == ".film") options.parts.push_back(entry.path().string());
    if (error) throwBadInput("--parts {}: {}", options.folder, error.message());
  }
  if (options.parts.empty()) throwBadInput("merge: no parts were given");
  for (const std::string* file : {&options.output, &options.errorOutput})
    if (!file->empty() && !isWritableImageName(*file))
      throwBadInput("-o {}: the extension must be png, hdr, exr or pfm", *file);
  // In the order of their samples, one in memory at a time.
  std::vector<std::pair<std::uint32_t, std::string>> parts;
  for (const std::string& part : options.parts) parts.emplace_back(firstSampleOf(part), part);
  std::sort(parts.begin(), parts.end());
  FilmMerge merge;
  for (const auto& [first, part] : parts) merge.add(filmOf(readFileBytes(part), part), part);
  const Film film = merge.result();
  const FilmStatistics statistics = statisticsOf(film.pixels());
  const Image image = film.picture();
  if (lowerExtension(options.output) == ".png")
    writePng(options.output, toneMapped(image, static_cast<float>(options.exposure)));
  else writeImage(options.output, image);
  if (!options.errorOutput.empty()) writeImage(options.errorOutput, film.standardError());
  if (!options.checkpoint.empty()) writeFileAtomically(options.checkpoint, bytesOf(film));
  if (!options.common.quiet)
    fmt::print(
        "{}: {}x{}, {} parts, samples {} to {}, mean radiance {:.6g} {:.6g} {:.6g}, standard error of a pixel {:.3g} "
        "({:.3g} of the mean)\n",
        options.output, image.width, image.height, merge.films(), film.first, film.first + film.mean.front().w - 1,
        statistics.mean.x, statistics.mean.y, statistics.mean.z, statistics.standardError, statistics.relativeError);
  const auto finiteOrNull = [](double value) {
    return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
  };
  nlohmann::ordered_json json;
  json["parts"] = options.parts;
  json["samples"] = {film.first, film.first + film.mean.front().w};
  json["size"] = {image.width, image.height};
  json["mean"] = {statistics.mean.x, statistics.mean.y, statistics.mean.z};
  json["mean_standard_error"] = {finiteOrNull(statistics.meanError.x), finiteOrNull(statistics.meanError.y),
                                 finiteOrNull(statistics.meanError.z)};
  json["spp"] = statistics.samples;
  json["standard_error"] = finiteOrNull(statistics.standardError);
  json["relative_error"] = finiteOrNull(statistics.relativeError);
  options.common.writeJson(json);
  return 0;
}

}  // namespace

Work addMerge(CLI::App& app) {
  auto options = std::make_shared<Options>();
  app.add_option(
      "PART", options->parts,
      "films that render --samples FIRST:LAST --checkpoint PART made, of one scene and with one setting, in any order");
  app.add_option("--parts", options->folder, "a folder: all its files that end in .film");
  app.add_option("-o,--output", options->output, "OUT.{png,hdr,exr,pfm}; png is tone mapped, the others are linear")
      ->required();
  app.add_option("--error", options->errorOutput, "OUT.{hdr,exr,pfm}: the standard error of each pixel");
  app.add_option("--checkpoint", options->checkpoint,
                 "the film of all parts, from which render --checkpoint goes on where they begin with sample 0");
  app.add_option("--exposure", options->exposure, "of a png")->capture_default_str();
  options->common.declare(app);
  return [options] { return run(*options); };
}

}  // namespace lucerna::demo
