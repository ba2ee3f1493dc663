// lucerna render --technique path: the path tracer's options and its progressive picture.
#pragma once

#include "commands.hpp"
#include "pathtracer/path_tracer.hpp"

namespace lucerna::demo {

/// What stops a path traced picture, whichever comes first, and which light paths it holds.
struct PathOptions {
  std::optional<std::uint32_t> spp;  ///< else path.samples, where nothing else stops
  std::optional<double> seconds;
  std::optional<double> error;
  std::optional<std::uint32_t> bounces;
  std::string
      samples;  ///< "FIRST:LAST": those samples alone, FIRST up to but without LAST, into the checkpoint; empty: all
  std::string part;  ///< "K/N": part K of N of the samples of --spp, into the checkpoint; empty: all
  std::optional<std::uint32_t> seed;
  std::string checkpoint;  ///< empty: none
  double saveEvery = 60.0;  ///< seconds between checkpoints
  bool sizeGiven = true;  ///< --size was; without it the original's files and fidelity have the original's size

  void declare(Command app);
  /// Throws Error(badInput) where one is given with another technique.
  void refuseIfGiven(const std::string& technique) const;
};

/// The tracer's settings of a path traced picture.
PathTracer::Settings tracerSettings(const PictureOptions& picture, const PathOptions& path,
                                    const RenderSettings& shared);

/// output: empty where the checkpoint of --samples alone is wanted.
int renderPath(const CommonOptions& common, const PictureOptions& picture, const PathOptions& path,
               const std::string& sceneFile, const std::string& cameraText, const std::string& output);

}  // namespace lucerna::demo
