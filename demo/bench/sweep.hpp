// The measurements of `lucerna bench error`: each technique over a sweep of settings, and each deviation alone.
#pragma once

#include "shared/commands.hpp"

#include <string>
#include <vector>

namespace lucerna::demo::bench {

/// What a picture is made without, to tell whose error it is: the cells, all of the reflective shadow map gathered at
/// each pixel; or the propagation, the exact radiance in the cells. The third bound, exact light at the records, is a
/// point of `rays`.
enum class Bound { none, map, cells };

/// One measurement: the options of a picture as on the command line, and the series that it belongs to.
struct SweepPoint {
  std::string series;  ///< such as "lpv cells"; a line of the plot
  PictureOptions picture;  ///< technique, fidelity, deviations, settings
  bool isStep = false;  ///< has more of something than the one before it in its series: it should not be worse
  Bound bound = Bound::none;
  bool byReadPixels = false;  ///< radiosity: solved by the published program, with colours drawn and read back
  std::size_t mostPatches = 0;  ///< then: of a scene with more, a coarser model
  /// Label in tables: settings that differ from the defaults.
  std::string label() const;
  /// Equal measurements have equal names: a finished one is not repeated.
  std::string name() const;
};

/// The techniques with a sweep.
std::vector<std::string> sweepTechniques();
/// Throws Error(badInput) naming an unknown technique. `shrink`: leave out the most expensive points. longestSide: of
/// the scene, for patch sizes.
std::vector<SweepPoint> sweepOf(const std::string& technique, bool shrink, double longestSide);
/// "TECHNIQUE [SETTING=VALUE]...": a picture that was asked for. Throws Error(badInput) naming the option for what it
/// cannot be.
SweepPoint parseSweepPoint(const std::string& text, const std::string& option = "--point", bool withPath = false);
/// The bounds of the light propagation volume's transports.
std::vector<SweepPoint> boundPoints();
/// Corrected, and corrected with one deviation on at a time, for every technique that has the deviation.
std::vector<SweepPoint> deviationPoints(const std::vector<std::string>& techniques);

}  // namespace lucerna::demo::bench
