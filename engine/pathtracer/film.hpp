// The film of a path traced picture as a file (no GL): what PathTracer::checkpoint() writes and resume() takes, and films of parts of the samples as one.
//
// A film holds the samples number first, first + 1, ..., one after another in every pixel. The random numbers of a sample follow from seed, pixel and
// its number alone, so that parts that were made anywhere are together what one run makes of all of them, up to rounding.
#pragma once

#include "base/image.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace lucerna {

struct FilmPixel {
  glm::vec3 mean;
  glm::vec3 spread;  ///< sum of squared deviations from the mean [Welford1962]
  std::uint32_t samples = 0;
};

/// Radiance, or what else a film holds, over all its pixels.
struct FilmStatistics {
  std::uint32_t fewestSamples = 0, mostSamples = 0;
  double samples = 0.0;           ///< mean over pixels
  glm::dvec3 mean{0.0}, meanError{0.0};
  double standardError = 0.0;     ///< root mean square over pixels and channels of a pixel's standard error; infinite below 2 samples
  double relativeError = 0.0;     ///< that over the mean, channels averaged; 0 for a black picture without error
};
FilmStatistics statisticsOf(std::span<const FilmPixel> pixels);
/// Standard error of a pixel's mean; 0 below 2 samples.
glm::vec3 standardErrorOf(const FilmPixel& pixel);

struct Film {
  std::uint64_t identity = 0;  ///< of scene, view, size and settings: what decides the picture
  glm::ivec2 size{0};
  std::uint32_t first = 0;     ///< number of the first sample
  /// Words of floats' bits, the bottom row first: mean and, in w, the number of samples; spread; the mean's rest below a float's last place.
  std::vector<glm::uvec4> mean, spread, rest;

  std::vector<FilmPixel> pixels() const;
  Image picture() const;        ///< top row first
  Image standardError() const;
};

/// Throws Error(badInput) where the bytes are no film, of another version, damaged or cut off; `name` is for messages.
Film filmOf(std::span<const std::uint8_t> bytes, const std::string& name);
std::vector<std::uint8_t> bytesOf(const Film& film);

/// The films of parts as one [ChanGolubLeVeque1983, pairwise update]. In any order. Throws Error(badInput) where they differ in scene, view, size or
/// settings, where one is not finished (pixels of different numbers of samples, or none), where two hold the same samples, or samples between them are missing.
Film merged(std::span<const Film> films, std::span<const std::string> names);

}  // namespace lucerna
