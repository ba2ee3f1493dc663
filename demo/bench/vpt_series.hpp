// The published pictures of the VPT original [VPT2024, 5.7] as scenes of ours: what each shows, what was changed for
// it, what it took there.
#pragma once

#include "bench/bench.hpp"
#include "pathtracer/path_tracer.hpp"
#include "settings/deviations.hpp"

#include <string>
#include <vector>

namespace lucerna::demo::bench {

/// What the original drew with: pixels, graphics card.
inline constexpr glm::ivec2 kVptSize{1920, 1080};
inline constexpr const char* kVptGpu = "RTX 3060 Mobile";
/// Milk and grape juice were drawn "with a lowered index of refraction"; which, the text does not say.
inline constexpr float kVptLoweredIor = 1.1f;

/// The series that differ in samples alone.
inline constexpr const char* kVptSampleSeries = "samples, 5.8 to 5.10";

struct VptPicture {
  const char* table;  ///< the series it belongs to
  const char* figure;  ///< such as "5.12 a"
  const char* label;
  const char* scene;  ///< in assets/media, lit by an area light
  const char* camera;
  const char* original;  ///< the same in the original's own format, lit by a point
  std::uint32_t samples;
  double publishedMs;
  double scattering = 1.0, absorption = 1.0, anisotropy = 1.0;  ///< factors on every medium
  float ior = 0.0f;  ///< of every boundary; 0: the scene's
  bool boosted =
      true;  ///< by the published estimator: the probability of an interaction raised to a half (figure 5.7 compares)
};

/// Those that have a published time, in the text's order; then those that have none.
const std::vector<VptPicture>& vptPictures();
const std::vector<VptPicture>& vptUntimedPictures();

/// The scene of a picture with its changes made: for the published estimator that in the original's format, as only it
/// lights through refracting boundaries.
Scene loadVptScene(const VptPicture& picture, Fidelity fidelity);
/// The estimator that draws it.
PathDeviations vptDeviations(const VptPicture& picture, Fidelity fidelity);

/// The size that --scale makes of the published one: each side times `scale`, at least 16x9.
glm::ivec2 vptSize(double scale);
/// Samples: the published ones times `scale`, at least 1, and within a series on sample counts at least one more than
/// the picture before has.
std::uint32_t vptSamples(const VptPicture& picture, double scale);

/// Path traces a picture, at most about so many seconds where that is not 0.
struct VptResult {
  Image image;
  PathTracer::Statistics statistics;
  double ms = 0.0;  ///< of what was done, compiling and uploading left out
  double preparationMs =
      0.0;  ///< on the CPU for a loaded scene: the hierarchy of boxes, packing, upload; compiling left out
};
VptResult renderVpt(const gl::Context& context, gl::ProgramLibrary& programs, const VptPicture& picture,
                    const Scene& scene, glm::ivec2 size, std::uint32_t samples, double mostSeconds,
                    const PathDeviations& deviations = {}, std::uint32_t seed = 0);

}  // namespace lucerna::demo::bench
