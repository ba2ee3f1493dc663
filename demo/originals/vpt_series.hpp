// The published pictures of the VPT original [VPT2024, 5.7] as our scenes: their content, the changes made for each,
// and the published times.
#pragma once

#include "originals/originals.hpp"
#include "pathtracer/path_tracer.hpp"
#include "render/deviations.hpp"

#include <string>
#include <vector>

namespace lucerna::demo::bench {

/// The original's picture size and graphics card.
inline constexpr glm::ivec2 kVptSize{1920, 1080};
inline constexpr const char* kVptGpu = "RTX 3060 Mobile";
/// Milk and grape juice were drawn "with a lowered index of refraction"; the text does not give its value.
inline constexpr float kVptLoweredIor = 1.1f;

/// The series whose pictures differ only in samples.
inline constexpr const char* kVptSampleSeries = "samples, 5.8 to 5.10";

struct VptPicture {
  const char* table;  ///< its series
  const char* figure;  ///< for example "5.12 a"
  const char* label;
  const char* scene;  ///< in assets/media, lit by an area light
  const char* camera;
  const char* original;  ///< the same in the original's own format, lit by a point light
  std::uint32_t samples;
  double publishedMs;
  double scattering = 1.0, absorption = 1.0, anisotropy = 1.0;  ///< factors on every medium
  float ior = 0.0f;  ///< of every boundary; 0: the scene's own
  bool boosted =
      true;  ///< published estimator: raise the probability of an interaction to a half (compared in figure 5.7)
};

/// Pictures with a published time, in the text's order; then those without.
const std::vector<VptPicture>& vptPictures();
const std::vector<VptPicture>& vptUntimedPictures();

/// The scene of a picture with its changes applied. For the published estimator it is the scene in the original's
/// format, since only that estimator lights through refracting boundaries.
Scene loadVptScene(const VptPicture& picture, Fidelity fidelity);
/// The estimator for the picture.
PathDeviations vptDeviations(const VptPicture& picture, Fidelity fidelity);

/// The published size scaled by --scale: each side times `scale`, at least 16x9.
glm::ivec2 vptSize(double scale);
/// Samples: the published ones times `scale`, at least 1; within a series on sample counts, at least one more than the
/// previous picture.
std::uint32_t vptSamples(const VptPicture& picture, double scale);

/// Path traces a picture, for at most about that many seconds if that is not 0.
struct VptResult {
  Image image;
  PathTracer::Statistics statistics;
  double ms = 0.0;  ///< of the work done, without compiling and uploading
  double preparationMs = 0.0;  ///< loading, and vptPreparationMs()
};
VptResult renderVpt(const gl::Context& context, gl::ProgramLibrary& programs, const VptPicture& picture,
                    const Scene& scene, glm::ivec2 size, std::uint32_t samples, double mostSeconds,
                    const PathDeviations& deviations = {}, std::uint32_t seed = 0);

/// Of a loaded scene whose programs are compiled: building the hierarchy, packing, upload.
double vptPreparationMs(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene, glm::ivec2 size,
                        const PathDeviations& deviations);

}  // namespace lucerna::demo::bench
