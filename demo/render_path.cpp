#include "render_path.hpp"

#include "base/clock.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/json.hpp"
#include "base/log.hpp"
#include "shared/parts.hpp"
#include "pathtracer/denoiser.hpp"
#include "pathtracer/film.hpp"
#include "pathtracer/path_tracer.hpp"
#include "scene/scene_file.hpp"
#include "render/deviations.hpp"

#include <fmt/core.h>

#include <cmath>
#include <cstdint>
#include <utility>

namespace lucerna::demo {

namespace {

nlohmann::ordered_json finiteOrNull(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

/// Size of the original's pictures [VPT2024].
constexpr const char* kPublishedSize = "1920x1080";

/// Samples after which --error gives up on a picture in which none has found light.
constexpr double kMostDark = 1 << 26;

/// Whether a scene file is the original's JSON, which has a key "scene".
bool isOriginalScene(const std::string& file) {
  if (lowerExtension(file) != ".json") return false;
  const nlohmann::json json = parseJson(readFileText(file), file);
  return json.is_object() && json.contains("scene");
}

struct SampleRange {
  std::uint32_t first = 0, last = 0;
};
/// From --samples "FIRST:LAST" or --part "K/N"; empty if neither was given.
std::optional<SampleRange> sampleRange(const PathOptions& path) {
  if (!path.part.empty()) {
    if (!path.samples.empty() || path.seconds || path.error)
      throwBadInput(
          "--part {}: is a part of the samples of --spp; it cannot be combined with --samples, --seconds and --error",
          path.part);
    if (!path.spp) throwBadInput("--part {}: needs --spp, the total number of samples", path.part);
    const PartOptions::Range range = PartOptions{path.part, path.checkpoint}.rangeOf(*path.spp);
    if (range.first == range.last)
      throwBadInput("--part {}: has no sample of --spp {}; choose fewer parts", path.part, *path.spp);
    return SampleRange{static_cast<std::uint32_t>(range.first), static_cast<std::uint32_t>(range.last)};
  }
  if (path.samples.empty()) return std::nullopt;
  constexpr std::uint64_t kMost = 1u << 31;
  const auto colon = path.samples.find(':');
  const auto number = [&](const std::string& text) {
    const bool isNumber =
        !text.empty() && text.size() <= 10 && text.find_first_not_of("0123456789") == std::string::npos;
    return isNumber ? std::stoull(text) : kMost + 1;
  };
  const std::uint64_t first = colon == std::string::npos ? kMost + 1 : number(path.samples.substr(0, colon)),
                      last = colon == std::string::npos ? 0 : number(path.samples.substr(colon + 1));
  if (first >= last || last > kMost)
    throwBadInput("--samples {}: expected FIRST:LAST, whole numbers, FIRST below LAST, LAST at most {}", path.samples,
                  kMost);
  if (path.spp || path.seconds || path.error)
    throwBadInput("--samples {}: sets the number of samples; it cannot be combined with --spp, --seconds and --error",
                  path.samples);
  if (path.checkpoint.empty())
    throwBadInput("--samples {}: needs --checkpoint PART, which lucerna merge reads", path.samples);
  return SampleRange{static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(last)};
}

bool isDenoised(const PathOptions& path, const RenderSettings& shared) {
  return path.denoise || shared.of<PathSettings>().denoise;
}

void resumeFrom(PathTracer& tracer, const std::string& checkpoint, const std::optional<SampleRange>& part) {
  const std::vector<std::uint8_t> bytes = readFileBytes(checkpoint);
  const std::uint32_t first = filmOf(bytes, checkpoint).first, wanted = part ? part->first : 0;
  if (first != wanted)
    throwBadInput("{}: its samples begin with number {}, not {}{}", checkpoint, first, wanted,
                  part ? "" : " (a part of --samples; lucerna merge makes a whole)");
  tracer.resume(bytes, checkpoint);
}

}  // namespace

void PathOptions::declare(Command app) {
  app.addOption("--spp", spp, "path: maximum samples per pixel (64, without --seconds and --error)")
      .range(1u, 4000000000u);
  app.addOption("--seconds", seconds, "path: stop after this time, with at least one sample per pixel").positive();
  app.addOption("--error", error,
                "path: stop when the pixels' standard error (root mean square) is this fraction of the mean radiance; "
                "of n samples that found no light, 3 count as if they could have. With --denoise: or when the "
                "denoised picture's error is")
      .positive();
  app.addOption("--bounces", bounces, "path: maximum number of scatterings (no limit)");
  app.addOption("--checkpoint", checkpoint,
                "path: resume from this file if it exists; it is written every minute and at the end. Without it a "
                "stopped picture is stored in OUT.film, and the same command resumes it");
  app.addOption(
      "--samples", samples,
      "path: FIRST:LAST, a part of each pixel's samples, LAST excluded, stored by --checkpoint; lucerna merge "
      "makes one picture of all parts");
  app.addOption("--part", part, "path: K/N, part K of N, from 0, of the samples of --spp, as --samples");
  app.addOption("--save-every", saveEvery, "path: seconds between checkpoints").showDefault().range(0.0, 1e6);
  app.addFlag(
      "--denoise", denoise,
      "path: the picture denoised, with its error; by relative squared error it is never worse than the raw one of "
      "the same samples in expectation, and no reference is denoised");
  app.addOption("--seed", seed, "path: seed of the random numbers (0)");
}

void PathOptions::refuseIfGiven(const std::string& technique) const {
  if (spp || seconds || error || bounces || seed || denoise || !checkpoint.empty() || !samples.empty() || !part.empty())
    throwBadInput(
        "--technique {}: --spp, --samples, --part, --seconds, --error, --bounces, --seed, --denoise and --checkpoint "
        "belong to --technique path",
        technique);
}

PathTracer::Settings tracerSettings(const PictureOptions& picture, const PathOptions& path,
                                    const RenderSettings& shared) {
  for (const std::string& deviation : picture.deviations)
    if (!deviation.starts_with("path."))
      throwBadInput("--deviation {}: --technique path supports only deviations that begin with path.", deviation);
  PathTracer::Settings settings;
  settings.size = shared.size;
  settings.filter = shared.filter;
  settings.transport = transportOf(shared.component);
  settings.bounces = path.bounces.value_or(shared.of<PathSettings>().scatterings);
  settings.seed = path.seed.value_or(shared.of<PathSettings>().seed);
  settings.deviations = shared.of<PathSettings>().deviations;
  settings.halves = isDenoised(path, shared) || path.error;  // two halves know the picture's error
  return settings;
}

int renderPath(const CommonOptions& common, const PictureOptions& picture, const PathOptions& path,
               const SceneAt& sceneFile, const std::string& output) {
  PictureOptions rest = picture;
  if (!path.sizeGiven && (picture.fidelity != "corrected" || isOriginalScene(sceneFile.file)))
    rest.size = kPublishedSize;
  const RenderSettings shared = rest.parse();
  const PathTracer::Settings settings = tracerSettings(picture, path, shared);
  const std::optional<SampleRange> part = sampleRange(path);
  if (part && isDenoised(path, shared))
    throwBadInput("--denoise: cannot be combined with --samples and --part, whose parts become one picture later");
  if (output.empty() && !part) throwBadInput("--output is missing: the file for the picture");
  if (!output.empty() && !isWritableImageName(output))
    throwBadInput("-o {}: the extension must be png, hdr, exr or pfm", output);
  const auto [scene, camera] = sceneFile.load();

  // Create the path tracer, and load the film of an earlier run.
  const auto host = common.makeHost(false);
  gl::Context context;
  if (std::max(settings.size.x, settings.size.y) > context.capabilities().maxTextureSize)
    throwMissingCapability("--size {}: this driver's limit is {} pixels", rest.size,
                           context.capabilities().maxTextureSize);
  gl::ProgramLibrary programs;
  PathTracer tracer(context, programs, scene, settings);
  tracer.setCamera(camera);
  std::optional<Denoiser> denoiser;
  if (isDenoised(path, shared)) denoiser.emplace(programs, tracer);
  // Without --checkpoint the film is stored next to the picture, and only if the work was stopped.
  const std::string checkpoint = path.checkpoint.empty() ? output + ".film" : path.checkpoint;
  bool isOfAnother = false;  // OUT.film, of another picture that had the same name
  if (std::filesystem::exists(checkpoint)) {
    try {
      resumeFrom(tracer, checkpoint, part);
    } catch (const Error& error) {
      if (!path.checkpoint.empty() || error.kind() != ErrorKind::badInput) throw;
      isOfAnother = true;
      logWarning("{}; not resumed", error.what());
    }
  } else if (part) {
    tracer.setFirstSample(part->first);
  }
  const auto save = [&] { writeFileAtomically(checkpoint, tracer.checkpoint()); };
  watchForInterrupt();

  // Targets: number of samples, time or error.
  const std::uint32_t target = part ? part->last - part->first
                                    : path.spp.value_or(path.seconds || path.error ? PathTracer::kUnlimited - 1
                                                                                   : shared.of<PathSettings>().samples);
  const auto start = Clock::now();
  const auto elapsed = [&] { return secondsSince(start); };
  Progress progress("samples", static_cast<int>(std::min(target, 1000000000u)), common.quiet || !(path.spp || part));
  std::uint32_t done = tracer.statistics().fewestSamples;
  const std::uint32_t resumed = done;
  double saved = 0.0;
  bool stopped = false;
  // Also save within a step, since steps grow to hours.
  const auto saveNowAndThen = [&] {
    if (path.checkpoint.empty() || !tracer.hasSamples() || elapsed() <= saved + path.saveEvery) return;
    try {
      save();
    } catch (const Error& error) { logWarning("--checkpoint {}; rendering continues without it", error.what()); }
    saved = elapsed();
  };
  std::uint32_t denoisedSamples = 0;  // of the denoised picture
  const auto denoise = [&] {
    if (tracer.samples() != std::exchange(denoisedSamples, tracer.samples())) denoiser->denoise();
  };
  // Of what is shown: the denoised picture is no worse than the raw one.
  const auto isWithin = [&](double wanted) {
    if (done >= 4 && tracer.statistics().relativeError <= wanted) return true;
    if (!denoiser || done < Denoiser::kFewestSamples) return false;
    denoise();
    const DenoisedError error = denoiser->error();
    return error.known && error.value <= wanted;
  };
  // Sample in steps: between them the error is checked, and all pixels have the same number of samples.
  while (done < target && !stopped) {
    const std::uint32_t next = std::min(target, done + std::max(1u, done / 4));
    while (!stopped && tracer.advance(next)) {
      stopped = interrupted() || (done > 0 && path.seconds && elapsed() >= *path.seconds);
      saveNowAndThen();
    }
    if (!stopped) done = next;
    saveNowAndThen();
    progress.update(static_cast<int>(std::min(done, 1000000000u)));
    stopped = stopped || interrupted() || (path.seconds && elapsed() >= *path.seconds) ||
              (path.error && isWithin(*path.error));
    if (path.error && !stopped && done < target && tracer.statistics().mean == glm::dvec3(0.0) &&
        static_cast<double>(done) * settings.size.x * settings.size.y >= kMostDark) {
      logWarning("--error: none of {} samples a pixel has found light", done);
      stopped = true;
    }
  }
  tracer.dropUnfinishedPass();
  if (denoiser && !interrupted()) denoise();
  const double seconds = elapsed();
  if (interrupted()) {
    save();
    throw Stopped(fmt::format("stopped at {:.6g} samples per pixel; the same command resumes from {}",
                              tracer.statistics().samples, checkpoint));
  }

  // Write the picture; then report for people and as JSON.
  const PathTracer::Statistics statistics = tracer.statistics();
  const Image image = denoiser ? denoiser->picture() : tracer.mean();
  const DenoisedError denoised = denoiser ? denoiser->error() : DenoisedError{};
  if (lowerExtension(output) == ".png") writePng(output, toneMapped(image, shared.exposure.value_or(scene.exposure)));
  else if (!output.empty())  // for a part, only the checkpoint may be wanted
    writeImage(output, image);
  if (statistics.mean == glm::dvec3(0.0)) logWarning("the picture is black: {}", kNoLightSeen);
  // After the picture, so that a full disk does not cost it.
  if (!path.checkpoint.empty()) save();
  else if (!isOfAnother) std::filesystem::remove(checkpoint);
  if (!common.quiet)
    fmt::print(
        "{}: {}x{}, path, {}, {:.6g} samples per pixel, mean radiance {:.6g} {:.6g} {:.6g}, {}, {:.3f} s on {}\n",
        output.empty() ? checkpoint : output, image.width, image.height, picture.component, statistics.samples,
        statistics.mean.x, statistics.mean.y, statistics.mean.z,
        standardErrorText(statistics.standardError, statistics.relativeError), seconds,
        context.capabilities().renderer);
  if (denoiser && !common.quiet) {
    fmt::print("{}", statistics.samples < 2.0 ? "not denoised, as one sample has no halves" : "denoised");
    if (denoised.known)
      fmt::print(": root mean square error {:.3g} of the mean, between {:.3g} and {:.3g} (99 %); {:.3g} before",
                 denoised.value, denoised.low, denoised.high, denoised.raw);
    else if (statistics.samples < Denoiser::kFewestSamples)
      fmt::print("; below {} samples per pixel its error is not known", Denoiser::kFewestSamples);
    else fmt::print("; of so few pixels its error is not known");
    fmt::print("\n");
  }
  nlohmann::ordered_json json;
  json["renderer"] = context.capabilities().renderer;
  json["host"] = nameOf(host->kind());
  json["scene"] = sceneFile.file;
  if (sceneFile.time != 0.0) json["time"] = sceneFile.time;
  json["technique"] = "path";
  json["component"] = picture.component;
  json["fidelity"] = picture.fidelity;
  json["deviations"] = nlohmann::ordered_json::array();
  for (const std::string& name : activeDeviations(shared))
    if (name.starts_with("path.")) json["deviations"].push_back(name);
  json["leaked_paths"] = statistics.leakedPaths;
  json["wrong_crossings"] = statistics.wrongCrossings;
  json["iterations"] = statistics.iterations;
  json["collisions"] = statistics.collisions;
  json["settings"] = picture.settings;
  json["size"] = {image.width, image.height};
  json["seconds"] = seconds;
  json["mean"] = {statistics.mean.x, statistics.mean.y, statistics.mean.z};
  json["mean_standard_error"] = {finiteOrNull(statistics.meanError.x), finiteOrNull(statistics.meanError.y),
                                 finiteOrNull(statistics.meanError.z)};
  json["spp"] = statistics.samples;
  if (part) json["samples"] = {part->first, part->last};
  json["resumed_samples"] = resumed;
  json["standard_error"] = finiteOrNull(statistics.standardError);
  json["relative_error"] = finiteOrNull(statistics.relativeError);
  json["bounces"] = settings.bounces != PathTracer::kUnlimited ? nlohmann::ordered_json(settings.bounces)
                                                               : nlohmann::ordered_json(nullptr);
  if (denoiser) {
    json["denoised"] = {{"known", denoised.known}};
    if (denoised.known)
      json["denoised"].update(
          {{"error", denoised.value}, {"low", denoised.low}, {"high", denoised.high}, {"raw", denoised.raw}});
  }
  json["gpu_bytes"] = tracer.gpuBytes() + (denoiser ? denoiser->gpuBytes() : 0);
  json["left_out"] = nlohmann::ordered_json::array();
  for (const auto& [name, needed] : tracer.features().named())
    if (!needed) json["left_out"].push_back(name);
  common.writeJson(json);
  return 0;
}

}  // namespace lucerna::demo
