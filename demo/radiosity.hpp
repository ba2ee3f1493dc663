// `lucerna radiosity`: what its parts share.
#pragma once

#include "commands.hpp"
#include "radiosity/settings.hpp"

#include <optional>
#include <string>
#include <vector>

namespace lucerna::demo {

/// `lucerna radiosity solve`: everything on its command line, checked as far as both solvers agree.
struct RadiositySolve {
  CommonOptions common;
  std::string in, out, fidelity = "corrected", solver;
  std::vector<std::string> deviations;
  std::vector<std::string> set;   ///< corrected: rad.KEY=VALUE as `lucerna render` takes them
  RadiositySettings settings;     ///< view, maxSweeps, seed; the rest is parsed by the solver that runs
  std::optional<double> nearPlane;
  double saveEvery = 10.0;        ///< seconds between checkpoints within a sweep
  bool viewGiven = false;         ///< else each solver takes its own
  double edge = 0.0;              ///< corrected: longest edge of a patch, scene units; 0: its own
  int refinements = 0;            ///< corrected
  std::string visibility;         ///< corrected: how pixels learn what they see; empty: auto
  bool restart = false;           ///< take no checkpoint up
};

/// The published program on its own file format; --fidelity corrected goes to a function of the same shape beside it. demo/radiosity_original.cpp
int solveOriginal(const RadiositySolve& options);
/// Any scene or triangle file. demo/radiosity_corrected.cpp
int solveCorrected(const RadiositySolve& options);

Work addRadiosityShow(CLI::App& app);

}  // namespace lucerna::demo
