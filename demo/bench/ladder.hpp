// The measurements of `lucerna bench error`: each technique over a ladder of settings, and each deviation alone.
#pragma once

#include "commands.hpp"

#include <string>
#include <vector>

namespace lucerna::demo::bench {

/// One measurement: the options of a picture as on the command line, and the series that it belongs to.
struct Rung {
  std::string series;  ///< such as "lpv cells"; a line of the plot
  PictureOptions picture;  ///< technique, fidelity, deviations, settings
  bool byReadPixels = false;  ///< radiosity: solved by the published program, with colours drawn and read back
  std::size_t mostPatches = 0;  ///< then: of a scene with more, a coarser model
  /// Label in tables: settings that differ from the defaults.
  std::string label() const;
  /// Equal measurements have equal names: a finished one is not repeated.
  std::string name() const;
};

/// The techniques with a ladder.
std::vector<std::string> ladderTechniques();
/// Throws Error(badInput) naming an unknown technique. `shrink`: leave out the most expensive rungs. longestSide: of
/// the scene, for patch sizes.
std::vector<Rung> ladderOf(const std::string& technique, bool shrink, double longestSide);
/// Corrected, and corrected with one deviation on at a time, for every technique that has the deviation.
std::vector<Rung> deviationRungs(const std::vector<std::string>& techniques);

}  // namespace lucerna::demo::bench
