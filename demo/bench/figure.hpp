// The interactive part of a report: linear pictures, their reference and its standard error, and the rows that they
// belong to, as one piece of HTML that holds all of it. assets/report/figure.js shows it: viewer, maps, plot, tables,
// crops, exports.
//
// Pictures travel as what they are less their reference, in half floats times a power of two (relative error of a
// difference 2^-11, so that a z-score is right where both are nearly equal); references as floats, standard errors as
// halves, FLIP as bytes.
#pragma once

#include "base/image.hpp"

#include <nlohmann/json.hpp>

#include <cstddef>
#include <string>
#include <vector>

namespace lucerna::demo::bench {

struct FigureReference {
  std::string name;
  const Image* mean = nullptr;
  const Image* standardError = nullptr;  ///< null: none known, and no z-scores
};

struct FigurePicture {
  std::size_t row = 0;  ///< of facts["rows"]
  std::size_t reference = 0;  ///< what it is judged by
  const Image* picture = nullptr;
  const Image* standardError = nullptr;  ///< its own, where it is sampled; else null
  Bitmap flip;  ///< red 0..255 for 0..1; empty: none
  bool isFirstChoice = true;  ///< the last to be shrunk where there is no room for all
};

struct Figure {
  nlohmann::ordered_json
      facts;  ///< title, rows, yardsticks, references, exposure, provenance: what the JSON of the command says
  std::vector<FigureReference> references;  ///< one at least; all of one size
  std::vector<FigurePicture> pictures;
};

/// At most about `bytes` long: first the pictures that are no first choice are shrunk to means over blocks of 2 to 4
/// pixels, then all are, and the figure says so.
std::string figureHtml(const Figure& figure, std::size_t bytes);

}  // namespace lucerna::demo::bench
