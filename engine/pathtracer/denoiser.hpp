// Denoises a path traced picture, and says how far from the truth the result is: never worse than the raw picture in
// expectation, and ever closer to it the more samples there are.
//
// The film holds two independent pictures A and B of half the samples each (PathTracer::Settings::halves). A candidate
// D is any function of one half alone: D(A) does not know the noise of B. With the raw picture R = (A + B) / 2, the
// filtered F = (D(A) + D(B)) / 2 and the truth t,
//   E[(R - t)^2]         = E[(A - B)^2] / 4,
//   E[(F - R) (R - t)]   = -E[(A - B) ((A - B) - (D(A) - D(B)))] / 4,
// since A - t and B - t are independent of each other and of what was made of the other half. The squared error of
// R + sum l_i (F_i - R) is therefore a known quadratic function of the shares l, without an assumption about the noise
// and without a variance. As in [JamesStein1961] the shares that minimise it, summed over a window, go to 0 as the
// noise falls below the candidates' bias: with n samples the gain falls as 1 / n against the error, and nothing is
// lost. An unequal pair (one sample more in A) has other factors (shaders/pathtracer/denoise_candidates.glsl).
//
// Candidates: a fit of first order to features of the surfaces seen; the same with weights by colours; a second one of
// that farther around; and despeckling, which replaces only values whose variance stands out.
//
// Needs: a tracer with halves. Stages: features (once a view), candidates, terms, sums over windows, picture.
// Everything on the GPU; error() reads a picture back.
#pragma once

#include "base/image.hpp"
#include "gl/objects.hpp"
#include "gl/picture_chunks.hpp"
#include "gl/program.hpp"
#include "pathtracer/path_tracer.hpp"

#include <array>
#include <span>
#include <vector>

namespace lucerna {

/// Root mean square error of a denoised picture over its mean, and an interval that holds the true one.
struct DenoisedError {
  bool known = false;  ///< not below kFewestSamples
  double value = 0.0, low = 0.0, high = 0.0;
  double raw = 0.0;  ///< that of the raw picture, estimated likewise
};

/// Sums over a block of pixels and their channels.
struct DenoisedBlock {
  double error = 0.0;  ///< of estimated squared errors
  double heldOut = 0.0;  ///< the same, with the shares that a pixel's neighbours choose without it
  double raw = 0.0;  ///< of the raw picture's
  double pixels = 0.0;
};

/// `columns` blocks a row; `mean`: of the picture, over pixels and channels.
///
/// Shares are chosen by the same estimates that are then summed, which makes `error` too low: they follow its noise.
/// `heldOut` is free of that, and too high, as its shares are worse. The interval goes from the one less to the other
/// plus 2.576 standard errors, 99 % of a normal distribution; with few blocks Student's quantile. A standard error
/// comes from the scatter of the blocks with their neighbours (blocks next to each other share candidates), times
/// sqrt(2): the true error scatters about its expectation as much as the estimate does. The upper end is raised where
/// blocks are skewed [Johnson1978]. Light that no sample has found is in neither.
DenoisedError denoisedError(std::span<const DenoisedBlock> blocks, int columns, double mean);

class Denoiser {
 public:
  /// Below it the error is not stated, as for references: too few samples have found the picture's light.
  static constexpr std::uint32_t kFewestSamples = 16;

  /// Compiles and allocates. `tracer` must have halves, and outlive it.
  Denoiser(gl::ProgramLibrary& programs, const PathTracer& tracer);
  /// The tracer's view or size is another.
  void forget();
  /// Of the tracer's whole passes so far. A picture of a single sample stays as it is.
  void denoise();

  /// Radiance, linear, scene units; alpha is 1.
  const gl::Texture& result() const { return result_; }
  Image picture() const;  ///< top row first
  /// What pixels show: albedo and the share that shines; normal and inverse distance.
  const gl::Texture& surfaceColours() const { return colours_; }
  const gl::Texture& surfacePlaces() const { return places_; }
  DenoisedError error() const;  ///< of the last denoise()
  std::size_t gpuBytes() const;

  static constexpr int kNarrow = 2, kWide = 7;  ///< radii of the fits' windows
  static constexpr int kStride = 3;  ///< between the pixels of the farthest one's

 private:
  void allocate();
  void traceFeatures();
  void readFilm();
  void regress(const gl::Program& program, const gl::Texture& to, const gl::Texture* guide, int radius);
  void sumRadiance();
  void combine();

  const PathTracer& tracer_;
  const gl::Program *features_, *readFilm_, *narrowFit_, *wideFit_, *colouredFit_, *farFit_, *terms_, *rows_, *combine_,
      *rawSums_, *allSums_;
  gl::PictureChunks chunks_;
  gl::Buffer constants_;
  gl::Texture colours_, places_;  ///< features
  gl::Texture film_;  ///< values and variances of both halves
  gl::Texture narrow_, wide_, coloured_, far_;  ///< fits, of both halves
  std::array<gl::Texture, 4> term_, row_;
  gl::Texture result_, errors_, blocks_, total_;
  bool hasFeatures_ = false;
};

}  // namespace lucerna
