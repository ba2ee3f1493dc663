// lucerna render --technique path: the path tracer's options and its progressive picture.
#pragma once

#include "shared/commands.hpp"
#include "pathtracer/path_tracer.hpp"

namespace lucerna::demo {

/// The stopping criteria of a path traced picture, of which the first to be met counts, and its light paths.
struct PathOptions {
  std::optional<std::uint32_t> spp;  ///< otherwise path.samples, if no other criterion is given
  std::optional<double> seconds;
  std::optional<double> error;
  std::optional<std::uint32_t> bounces;
  std::string samples;  ///< "FIRST:LAST": only those samples, LAST excluded, into the checkpoint; empty: all
  std::string part;  ///< "K/N": part K of N of the samples of --spp, into the checkpoint; empty: all
  std::optional<std::uint32_t> seed;
  bool denoise = false;  ///< as path.denoise
  std::string checkpoint;  ///< empty: none
  double saveEvery = 60.0;  ///< seconds between checkpoints
  bool sizeGiven = true;  ///< without --size, the original's files and fidelity use the original's size

  void declare(Command app);
  /// Throws Error(badInput) if one is given with another technique.
  void refuseIfGiven(const std::string& technique) const;
};

/// The tracer's settings of a path traced picture.
PathTracer::Settings tracerSettings(const PictureOptions& picture, const PathOptions& path,
                                    const RenderSettings& shared);

/// output: empty if only the checkpoint of --samples is wanted.
int renderPath(const CommonOptions& common, const PictureOptions& picture, const PathOptions& path,
               const SceneAt& sceneFile, const std::string& output);

}  // namespace lucerna::demo
