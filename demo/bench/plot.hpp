// Log-log plots by gnuplot, which must be installed where a report is made (Debian package gnuplot-nox).
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace lucerna::demo::bench {

struct Series {
  std::string name;
  struct Point {
    double x, y;
    std::string label;  ///< next to the point; empty: none
  };
  std::vector<Point> points;
  bool joined = true;
  bool isFront = false;  ///< drawn thick, behind the others
  bool isBefore = false;  ///< of an earlier program: dotted, with small marks
  std::size_t style = 0;  ///< index of its colour, mark and dashes
};

struct LogLogPlot {
  std::string title, xLabel, yLabel;  ///< labels with units
  std::vector<Series> series;
  struct Level {
    double y;  ///< above 0; others are left out
    std::string label;
  };
  std::vector<Level> levels;  ///< horizontal lines, such as a black picture's error and the reference's noise
  double guideSlope = 0.0;  ///< draws a thin line of that slope through the first point of the last series; 0: none
};

bool haveGnuplot();
/// Writes STEM.gp, STEM.svg and STEM.png into the folder. Points that are not finite and positive cannot be plotted on
/// these axes; they are left out, and their number is returned. Throws Error(missingCapability) if gnuplot is missing
/// or fails.
int writeLogLogPlot(const std::filesystem::path& folder, const std::string& stem, const LogLogPlot& plot);

}  // namespace lucerna::demo::bench
