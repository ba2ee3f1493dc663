// The interactive part of a report: linear pictures, their reference and its standard error, and the rows that they
// belong to, in one self-contained piece of HTML. assets/report/figure.js displays it: viewer, maps, plot, tables,
// crops, exports.
//
// Pictures are stored as differences from their reference, in half floats times a power of two (a difference has a
// relative error of 2^-11, so that z-scores are right even where both are nearly equal); references as floats, standard
// errors as halves, FLIP as bytes.
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
  std::size_t row = 0;  ///< in facts["rows"]
  std::size_t reference = 0;  ///< index of its reference
  const Image* picture = nullptr;
  const Image* standardError = nullptr;  ///< its own if it is sampled; else null
  Bitmap flip;  ///< red 0..255 for 0..1; empty: none
  bool isFirstChoice = true;  ///< among the last to be shrunk if there is too little room
};

struct Figure {
  nlohmann::ordered_json
      facts;  ///< title, rows, baselines, references, exposure, provenance: the content of the command's JSON
  std::vector<FigureReference> references;  ///< at least one; all of the same size
  std::vector<FigurePicture> pictures;
};

/// At most about `bytes` long. If necessary, pictures that are not first choice are reduced to means over blocks of 2
/// to 4 pixels, then all of them; the figure says so.
std::string figureHtml(const Figure& figure, std::size_t bytes);

}  // namespace lucerna::demo::bench
