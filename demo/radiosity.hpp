// `lucerna radiosity`: declarations shared by its parts.
#pragma once

#include "shared/commands.hpp"
#include "shared/parts.hpp"
#include "radiosity/original/coarse_scene.hpp"
#include "radiosity/settings.hpp"

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace lucerna::demo {

/// `lucerna radiosity solve`: all of its command line, checked as far as both solvers agree.
struct RadiositySolve {
  CommonOptions common;
  PartOptions part;  ///< corrected: rows of hemicubes
  std::string in, out, fidelity = "corrected", solver;
  std::vector<std::string> deviations;
  std::vector<std::string> set;  ///< corrected: radiosity.KEY=VALUE as for `lucerna render`
  /// Corrected: the other options, which are shorthands for settings: option, KEY=VALUE. They come before `set`.
  std::vector<std::pair<std::string, std::string>> shortSettings;
  int resolution = 500;  ///< original: pixels per side of a hemicube
  int maxSweeps = 0;  ///< original; 0: no limit
  unsigned seed = 1;  ///< original: for the random roll
  std::optional<double> nearPlane;
  double saveEvery = 10.0;  ///< seconds between checkpoints within a sweep
  bool restart = false;  ///< ignore checkpoints
};

/// The published program on its own file format; --fidelity corrected has a function of the same form below.
/// demo/radiosity_original.cpp
int solveOriginal(const RadiositySolve& options);
/// Any scene or triangle file. demo/radiosity_corrected.cpp
int solveCorrected(const RadiositySolve& options);

/// A scene as its triangle file is made of it, by the options of `generate` that `show --scene` has too: edges of at
/// most `edge` scene units, if given at most `triangles` of them. demo/radiosity.cpp
struct RadSource {
  CoarseScene model;
  double edge = 0.0;  ///< the value used
};
RadSource loadRadSource(const std::string& file, std::optional<double> edge, std::optional<unsigned> triangles);

/// Distinguishes a file from one that replaces it; zeros if there is none. demo/radiosity.cpp
std::array<std::int64_t, 4> stampOf(const std::filesystem::path& file);

Work addRadiosityShow(Command app);

}  // namespace lucerna::demo
