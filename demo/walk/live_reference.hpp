// Live reference: while the camera rests, the path tracer computes the reference for the current view, and pictures are
// judged against it.
//
// In: the scene, the view, the size and the kind of light; each frame, the time budget. Out: mean and standard error as
// textures, and for a picture its error with an interval that contains the true error. References are loaded from and
// stored in the bench's cache (measure/reference.hpp).
#pragma once

#include "gl/context.hpp"
#include "gl/program.hpp"
#include "measure/error_interval.hpp"
#include "measure/reference.hpp"
#include "pathtracer/denoiser.hpp"
#include "pathtracer/path_tracer.hpp"
#include "render/renderer.hpp"

#include <future>
#include <memory>
#include <optional>

namespace lucerna::demo {

class LiveReference {
 public:
  /// Compiles, and builds the scene's hierarchy; `scene` must outlive it.
  LiveReference(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene, glm::ivec2 size,
                PixelFilter filter, Component component, bool denoised = false);
  ~LiveReference();

  glm::ivec2 size() const { return size_; }
  Component component() const { return component_; }
  PixelFilter filter() const;
  /// Switches to another view: stores the samples in the cache if worthwhile, and restarts sampling.
  void look(const Camera& camera);
  /// Spends about `seconds`: after the first submission, none is started that would probably exceed the remaining time.
  void advance(double seconds);
  /// Time of a submission, estimated by the last one; 0 before the first.
  double submissionSeconds() const { return submission_; }

  /// Samples per pixel, including those of the cache; 0: none yet.
  std::uint64_t samples() const { return cachedSamples_ + shownSamples_; }
  bool ready() const { return samples() >= kFewest; }
  double seconds() const { return seconds_; }  ///< spent on this view
  /// Its picture. Denoised, if wanted and once this view has more samples of its own than the cache's; reference(),
  /// against which pictures are judged and which is stored, never is.
  const gl::Texture& mean() const { return meanTexture_; }
  bool denoises() const { return denoiser_.has_value(); }  ///< if wanted
  bool showsDenoised() const { return showsDenoised_; }
  const gl::Texture& standardError() const { return errorTexture_; }
  const measure::Reference& reference() const { return shown_; }
  /// Incremented whenever the reference has improved or changed.
  std::uint64_t version() const { return version_; }
  std::size_t gpuBytes() const;
  /// Stores the samples of this view in the cache.
  void keep();

  static constexpr std::uint64_t kFewest = 16;  ///< samples before errors are reported
  static constexpr std::uint64_t kWorthKeeping = 64;

 private:
  void publish();

  const gl::Context& context_;
  const Scene& scene_;
  glm::ivec2 size_;
  Component component_;
  std::unique_ptr<PathTracer> tracer_;
  std::optional<Denoiser> denoiser_;
  bool showsDenoised_ = false;
  std::uint64_t denoisedAt_ = 0;  ///< samples, of the picture shown
  measure::ReferenceCache cache_;
  std::optional<measure::ReferenceKey> key_;
  std::optional<measure::Reference> cached_;
  measure::Reference shown_;
  std::uint64_t cachedSamples_ = 0, shownSamples_ = 0, keptSamples_ = 0;
  std::uint32_t target_ = 1;
  double submission_ = 0.0, seconds_ = 0.0;
  std::uint64_t version_ = 0;
  gl::Texture meanTexture_, errorTexture_;
};

/// Judges a picture against a reference: the measures at once, FLIP on a separate thread (one core-second at 640x360).
class Judgement {
 public:
  Judgement() = default;
  Judgement(Judgement&&) = default;
  Judgement& operator=(Judgement&&) = default;
  ~Judgement();
  void judge(Image picture, const measure::Reference& reference, bool withFlip);
  void clear();
  bool known() const { return known_; }
  const measure::ErrorInterval& nrmse() const { return nrmse_; }
  double bias() const { return bias_; }  ///< relative, of the mean
  /// FLIP's mean and map, once available; the map as a texture.
  std::optional<double> flip();
  const gl::Texture* flipMap() const { return flipMap_.id() ? &flipMap_ : nullptr; }

 private:
  struct FlipResult {
    double mean = 0.0;
    std::vector<float> map;
    int width = 0, height = 0;
  };
  bool known_ = false;
  measure::ErrorInterval nrmse_;
  double bias_ = 0.0;
  std::future<FlipResult> pending_;
  std::optional<double> flip_;
  gl::Texture flipMap_;
};

/// Converts a linear picture (top row first) to a texture (bottom row first).
gl::Texture textureOf(const std::string& name, const Image& image);

}  // namespace lucerna::demo
