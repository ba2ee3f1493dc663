// FLIP: visibility of the differences between two pictures when flipping between them, 0 (none) to 1 (no GL).
//
// LDR: [Andersson2020]; HDR: [Andersson2021], the largest LDR error over exposures that the reference needs, tone
// mapped by the ACES curve [Narkowicz2015]. As in the papers: 67.02 pixels per degree (a 0.7 m wide display of 3840
// pixels seen from 0.7 m), filters cut at three standard deviations, pixels beyond the edge repeat the edge's,
// tone-mapped values read as linear.
#pragma once

#include "base/image.hpp"

#include <vector>

namespace lucerna::measure {

inline constexpr double kFlipPixelsPerDegree = 67.0206432765823;

struct Flip {
  double mean = 0.0;
  std::vector<float> map;  ///< one value per pixel, top row first
};

/// Both in linear RGB within 0..1; throws Error(badInput) if sizes differ. Values outside are clamped, as a display
/// would.
Flip flipLdr(const Image& image, const Image& reference, double pixelsPerDegree = kFlipPixelsPerDegree);

/// Linear HDR. Exposures start .. stop in stops, `count` of them evenly: from the reference's largest and median
/// luminance.
struct FlipExposures {
  double start = 0.0, stop = 0.0;
  int count = 2;
};
FlipExposures flipExposures(const Image& reference);
Flip flipHdr(const Image& image, const Image& reference, double pixelsPerDegree = kFlipPixelsPerDegree);

}  // namespace lucerna::measure
