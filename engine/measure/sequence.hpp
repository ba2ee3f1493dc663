// Errors of a sequence of pictures against references of the same moments (no GL): of each, and what only a sequence
// shows. Below P_k is picture k, R_k its reference with noise of variance s_k^2 a pixel and channel; sums are over
// pixels and channels of all pictures. The references' noise is taken off each sum, so results are means over noise.
//
// A technique that lacks light has pictures that are too dark in all moments, which is neither lag nor ghosts. So both
// allow a gain g that is the same in all moments: lag one for each channel of each square of 16x16 pixels, ghosts one
// for each pixel. (Where light grows and fades by the same factor in a square, that is exact, whatever each pixel
// lacks.)
//
//   lag      the time by which the references would have to be late to explain the pictures best: the shift that makes
//            sum |P(t) - g R(t - lag)|^2 least, with the best g, and R linear between moments; from -1 to 4 moments
//   ghosts   how much of what has just changed the pictures still show: where references differ from the moment before,
//            sum g (P_k - g R_k)(R_k-1 - R_k) / sum g^2 (R_k-1 - R_k)^2, g for that lag. 0: none; 1: the picture of the
//            moment before
//   flicker  sqrt(sum |P_k+1 - 2 P_k + P_k-1|^2 / sum |R_k+1 - 2 R_k + R_k-1|^2): 1 is as steady as the references
#pragma once

#include "measure/reference.hpp"

#include <span>
#include <vector>

namespace lucerna::measure {

struct SequenceErrors {
  std::vector<double> l2;  ///< of each picture, sqrt(sum d^2 / sum r^2)
  double mean = 0.0, worst = 0.0;  ///< of those
  // NaN where nothing changes by more than its noise, and with fewer than three pictures:
  double lag = 0.0;  ///< in moments
  double ghosts = 0.0, flicker = 0.0;
};

/// Of at least two pictures, as many as references, all of one size.
SequenceErrors sequenceErrors(std::span<const Image> pictures, std::span<const Reference> references);

}  // namespace lucerna::measure
