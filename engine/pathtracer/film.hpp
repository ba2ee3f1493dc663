// The film of a path traced picture as a file (no GL), written by PathTracer::checkpoint() and read by resume(); and
// merging of films that hold parts of the samples.
//
// A film holds the samples number first, first + 1, ..., consecutively in every pixel. The random numbers of a sample
// follow from seed, pixel and sample number alone. Parts computed anywhere therefore combine to what one run computes,
// up to rounding.
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
  glm::vec3 m2;  ///< sum of squared deviations from the mean [Welford1962]
  std::uint32_t samples = 0;
};

/// Radiance, or other quantity that the film holds, over all its pixels.
struct FilmStatistics {
  std::uint32_t fewestSamples = 0, mostSamples = 0;
  double samples = 0.0;  ///< mean over pixels
  glm::dvec3 mean{0.0}, meanError{0.0};
  double standardError = 0.0;  ///< root mean square over pixels and channels of a pixel's standard error; infinite
                               ///< below 2 samples. A pixel that found nothing counts by the rule of three
  double relativeError = 0.0;  ///< that over the mean, channels averaged; infinite for a black picture
};
FilmStatistics statisticsOf(std::span<const FilmPixel> pixels);
/// "standard error of a pixel 0.343 (0.455 of the mean)", or that it is not known.
std::string standardErrorText(double standardError, double relativeError);
/// Standard error of a pixel's mean; 0 below 2 samples.
glm::vec3 standardErrorOf(const FilmPixel& pixel);

struct Film {
  std::uint64_t identity = 0;  ///< hash of scene, view, size and settings: everything that determines the picture
  glm::ivec2 size{0};
  std::uint32_t first = 0;  ///< number of the first sample
  bool halves = false;  ///< two pictures of half the samples, one above the other (PathTracer::Settings::halves)
  /// Bits of floats as words, bottom row first: mean and, in w, the number of samples; sum of squared deviations; the
  /// mean's low part below a float's last place.
  std::vector<glm::uvec4> mean, m2, rest;

  std::vector<FilmPixel> pixels() const;
  Image picture() const;  ///< top row first
  Image standardError() const;
};

/// Throws Error(badInput) if the bytes are not a film, of another version, damaged or truncated; `name` is for
/// messages.
Film filmOf(std::span<const std::uint8_t> bytes, const std::string& name);
std::vector<std::uint8_t> bytesOf(const Film& film);

/// Number of the first sample, read from the beginning of a file; the rest is not checked.
std::uint32_t firstSampleOf(const std::filesystem::path& file);

/// Merges films of parts [ChanGolubLeVeque1983, pairwise update], one by one in the order of their samples, so that
/// only two are in memory at a time. Sums in double.
class FilmMerge {
 public:
  /// Throws Error(badInput) if the film has halves, differs from the previous ones in scene, view, size or settings, is
  /// unfinished (pixels with different numbers of samples, or none), repeats samples of a previous one, or leaves a gap
  /// between them.
  void add(const Film& film, const std::string& name);
  /// Requires at least one add().
  Film result() const;

 private:
  Film head_;  ///< of the first film: identity, size, first sample
  std::string headName_, before_;
  std::uint64_t next_ = 0;
  int films_ = 0;
  std::vector<glm::dvec3> mean_, m2_;
};

}  // namespace lucerna
