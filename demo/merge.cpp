#include "merge.hpp"

#include "base/error.hpp"
#include "base/files.hpp"
#include "shared/commands.hpp"
#include "shared/parts.hpp"
#include "pathtracer/film.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace lucerna::demo {

namespace {

struct MergeOptions {
  CommonOptions common;
  std::vector<std::string> parts;
  std::string folder, output, checkpoint, errorOutput;
  double exposure = 1.0;
};

/// Frames, batches or rows: merges folders into one.
int mergeFolders(const MergeOptions& options) {
  for (const std::string& part : options.parts)
    if (!isPartFolder(part)) throwBadInput("{}: is not a folder of --part, unlike those before it", part);
  if (options.checkpoint.empty() || !options.output.empty())
    throwBadInput(
        "merge: parts of frames, batches or rows become one with --checkpoint FOLDER, from which their command goes "
        "on; -o is for parts of samples");
  const nlohmann::ordered_json all = mergeParts({options.parts.begin(), options.parts.end()}, options.checkpoint);
  const auto command = all.at("command").get<std::string>();
  if (!options.common.quiet)
    fmt::print(
        "{}: {} units of {} parts; the same lucerna {} with --checkpoint {} instead of --part makes the result\n",
        options.checkpoint, all.at("units").dump(), options.parts.size(), command, options.checkpoint);
  options.common.writeJson({{"parts", options.parts}, {"command", command}, {"units", all.at("units")}});
  return 0;
}

int runMerge(MergeOptions options) {
  options.common.apply();
  if (!options.folder.empty()) {
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator(options.folder, error))
      if (entry.path().extension() == ".film" || isPartFolder(entry.path()))
        options.parts.push_back(entry.path().string());
    if (error) throwBadInput("--parts {}: {}", options.folder, error.message());
  }
  if (options.parts.empty()) throwBadInput("merge: no parts given");
  if (std::filesystem::is_directory(options.parts.front())) return mergeFolders(options);
  if (options.output.empty() && options.checkpoint.empty())
    throwBadInput("--output or --checkpoint is missing: the file for the picture or the film of all parts");
  for (const std::string* file : {&options.output, &options.errorOutput})
    if (!file->empty() && !isWritableImageName(*file))
      throwBadInput("-o {}: the extension must be png, hdr, exr or pfm", *file);
  const Film film = mergeFilms({options.parts.begin(), options.parts.end()});
  const FilmStatistics statistics = statisticsOf(film.pixels());
  const Image image = film.picture();
  if (lowerExtension(options.output) == ".png")
    writePng(options.output, toneMapped(image, static_cast<float>(options.exposure)));
  else if (!options.output.empty()) writeImage(options.output, image);
  if (!options.errorOutput.empty()) writeImage(options.errorOutput, film.standardError());
  if (!options.checkpoint.empty()) writeFileAtomically(options.checkpoint, bytesOf(film));
  if (!options.common.quiet)
    fmt::print("{}: {}x{}, {} parts, samples {} to {}, mean radiance {:.6g} {:.6g} {:.6g}, {}\n",
               options.output.empty() ? options.checkpoint : options.output, image.width, image.height,
               options.parts.size(), film.first, film.first + film.mean.front().w - 1, statistics.mean.x,
               statistics.mean.y, statistics.mean.z,
               standardErrorText(statistics.standardError, statistics.relativeError));
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

Film mergeFilms(const std::vector<std::filesystem::path>& parts) {
  // In the order of their samples, one in memory at a time.
  std::vector<std::pair<std::uint32_t, std::filesystem::path>> inOrder;
  for (const std::filesystem::path& part : parts) inOrder.emplace_back(firstSampleOf(part), part);
  std::sort(inOrder.begin(), inOrder.end());
  FilmMerge merge;
  for (const auto& [first, part] : inOrder) merge.add(filmOf(readFileBytes(part), part.string()), part.string());
  return merge.result();
}

Work addMerge(Command app) {
  auto options = std::make_shared<MergeOptions>();
  app.addOption("PART", options->parts,
                "what a command made with --part K/N --checkpoint PART (render: --samples FIRST:LAST too), of one "
                "scene and with one setting, in any order");
  app.addOption("--parts", options->folder, "a folder: all parts in it");
  app.addOption("-o,--output", options->output,
                "of a path traced picture's samples: OUT.{png,hdr,exr,pfm}; png is tone mapped, the others are linear");
  app.addOption("--error", options->errorOutput, "OUT.{hdr,exr,pfm}: the standard error of each pixel");
  app.addOption("--checkpoint", options->checkpoint,
                "all parts as one, from which the same command goes on with --checkpoint: of samples a film, if they "
                "begin with sample 0; of frames, batches and rows a folder");
  app.addOption("--exposure", options->exposure, "of a png").showDefault();
  options->common.declare(app);
  return [options] { return runMerge(*options); };
}

}  // namespace lucerna::demo
