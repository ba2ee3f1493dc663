// The denoiser (engine/pathtracer/denoiser.hpp) in double, written from its description: normal equations by Gaussian
// elimination, the window as a plain double sum, and the shares of candidates by trying every set of those that are not
// 0.
#pragma once

#include "pathtracer/film.hpp"

#include <glm/glm.hpp>

#include <array>
#include <vector>

namespace lucerna::test {

struct DenoiseInput {
  int width = 0, height = 0;
  struct Half {
    std::vector<glm::dvec3> mean, squares;  ///< squares: sums of squared deviations
    std::vector<double> samples;
  };
  std::array<Half, 2> halves;
  std::vector<std::array<double, 8>> features;  ///< albedo (3), shining, normal (3), inverse distance
};

/// Of a film of two halves one above the other, and of textures' texels.
DenoiseInput denoiseInput(const Film& film, const std::vector<glm::vec4>& colours,
                          const std::vector<glm::vec4>& places);

struct DenoiseReference {
  std::vector<glm::dvec3> raw, picture;
  std::vector<double> error, heldOut, rawError;  ///< estimates, summed over channels
  std::vector<std::array<double, 4>> shares;  ///< of far, wide, coloured, despeckled
};
DenoiseReference denoise(const DenoiseInput& input);

/// The minimum of 2 c.l + l.G l over l >= 0 whose sum is at most 1.
std::array<double, 4> bestShares(const std::array<double, 4>& c, const std::array<std::array<double, 4>, 4>& g);

}  // namespace lucerna::test
