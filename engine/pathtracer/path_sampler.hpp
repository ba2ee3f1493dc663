// The path tracer as the sampler of references: corrected, restricted to one transport, with Lambertian surfaces unless
// all materials are requested, and camera rays over the pixels' filter, as a camera sees them.
#pragma once

#include "base/pixel_filter.hpp"
#include "gl/context.hpp"
#include "gl/program.hpp"
#include "measure/reference.hpp"
#include "scene/scene.hpp"

#include <memory>
#include <string>
#include <vector>

namespace lucerna {

class PathTracer;

class PathSampler {
 public:
  /// The sampler's part of a reference's key: another when the path tracer's result changes.
  static std::string versionOf(PixelFilter filter, bool allMaterials = false, int bounces = 0);

  /// bounces: maximum for indirect light; 0: any number.
  PathSampler(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene, const Camera& camera,
              glm::ivec2 size, PixelFilter filter, Transport transport, bool allMaterials = false, int bounces = 0);
  ~PathSampler();
  PathSampler(const PathSampler&) = delete;
  PathSampler& operator=(const PathSampler&) = delete;

  measure::Sampler asSampler();
  std::string version() const { return versionOf(filter_, allMaterials_, bounces_); }

 private:
  Image sample(std::uint64_t first, std::uint32_t samples);

  const gl::Context& context_;
  gl::ProgramLibrary& programs_;
  const Scene& scene_;
  Camera camera_;
  glm::ivec2 size_;
  PixelFilter filter_;
  Transport transport_;
  bool allMaterials_;
  int bounces_;
  std::unique_ptr<PathTracer> tracer_;
};

/// Only directly visible lights, nothing scattered: emissive surfaces, environment, background.
Image seenLights(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene, const Camera& camera,
                 glm::ivec2 size, PixelFilter filter);
/// Pixels that an emissive surface covers in part.
std::vector<bool> emitterEdges(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene,
                               const Camera& camera, glm::ivec2 size, PixelFilter filter);
/// The albedo that pixels show; 0 where there is no surface.
Image albedoPicture(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene, const Camera& camera,
                    glm::ivec2 size, PixelFilter filter);

}  // namespace lucerna
