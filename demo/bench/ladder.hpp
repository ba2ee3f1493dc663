// What `lucerna bench error` measures: each technique over a ladder of settings, and each deviation alone.
#pragma once

#include "commands.hpp"

#include <string>
#include <vector>

namespace lucerna::demo::bench {

/// One measurement: the options of a picture as the command line has them, and the series that it belongs to.
struct Rung {
  std::string series;  ///< such as "lpv cells"; a line of the plot
  PictureOptions picture;  ///< technique, fidelity, deviations, settings
  bool byReadPixels = false;  ///< radiosity: solved by the published program, its colours drawn and read back
  /// What is said of it in tables: settings that differ from the defaults.
  std::string label() const;
  /// The same measurement has the same name: a finished one is not made again.
  std::string name() const;
};

/// The techniques that have a ladder.
std::vector<std::string> ladderTechniques();
/// Throws Error(badInput) naming an unknown technique. `shrink`: leave the most expensive rungs out. longestSide: of
/// the scene, for patch sizes.
std::vector<Rung> ladderOf(const std::string& technique, bool shrink, double longestSide);
/// Corrected, and corrected with one deviation on at a time, for every technique that the deviation belongs to.
std::vector<Rung> deviationRungs(const std::vector<std::string>& techniques);

}  // namespace lucerna::demo::bench
