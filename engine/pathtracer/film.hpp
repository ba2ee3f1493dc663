// The film of a path traced picture as a file (no GL): what PathTracer::checkpoint() writes and resume() takes, and
// films of parts of the samples as one.
//
// A film holds the samples number first, first + 1, ..., one after another in every pixel. The random numbers of a
// sample follow from seed, pixel and its number alone, so that parts that were made anywhere are together what one run
// makes of all of them, up to rounding.
#pragma once

#include "base/image.hpp"

#include <cstdint>
#include <filesystem>
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
  double samples = 0.0;  ///< mean over pixels
  glm::dvec3 mean{0.0}, meanError{0.0};
  double standardError =
      0.0;  ///< root mean square over pixels and channels of a pixel's standard error; infinite below 2 samples
  double relativeError = 0.0;  ///< that over the mean, channels averaged; 0 for a black picture without error
};
FilmStatistics statisticsOf(std::span<const FilmPixel> pixels);
/// Standard error of a pixel's mean; 0 below 2 samples.
glm::vec3 standardErrorOf(const FilmPixel& pixel);

struct Film {
  std::uint64_t identity = 0;  ///< of scene, view, size and settings: what decides the picture
  glm::ivec2 size{0};
  std::uint32_t first = 0;  ///< number of the first sample
  /// Words of floats' bits, the bottom row first: mean and, in w, the number of samples; spread; the mean's rest below
  /// a float's last place.
  std::vector<glm::uvec4> mean, spread, rest;

  std::vector<FilmPixel> pixels() const;
  Image picture() const;  ///< top row first
  Image standardError() const;
};

/// Throws Error(badInput) where the bytes are no film, of another version, damaged or cut off; `name` is for messages.
Film filmOf(std::span<const std::uint8_t> bytes, const std::string& name);
std::vector<std::uint8_t> bytesOf(const Film& film);

/// Number of the first sample, from the beginning of a file alone: nothing else of it is checked.
std::uint32_t firstSampleOf(const std::filesystem::path& file);

/// The films of parts as one [ChanGolubLeVeque1983, pairwise update], one after another in the order of their samples,
/// so that two are in memory however many there are. Sums in double.
class FilmMerge {
 public:
  /// Throws Error(badInput) where the film differs from those before in scene, view, size or settings, is not finished
  /// (pixels of different numbers of samples, or of none), holds samples that one before it holds, or leaves some out
  /// between them.
  void add(const Film& film, const std::string& name);
  int films() const { return films_; }
  /// At least one was added.
  Film result() const;

 private:
  Film head_;  ///< of the first: identity, size, first sample
  std::string headName_, before_;
  std::uint64_t next_ = 0;
  int films_ = 0;
  std::vector<glm::dvec3> mean_, spread_;
};

}  // namespace lucerna
