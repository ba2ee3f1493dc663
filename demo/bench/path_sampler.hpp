// The path tracer as the sampler of references: corrected, restricted to one transport, surfaces Lambert's unless all
// materials are asked for, camera rays through pixel centres as forward shading has them.
#pragma once

#include "commands.hpp"
#include "measure/reference.hpp"

#include <memory>
#include <string>

namespace lucerna {
class PathTracer;
}

namespace lucerna::demo::bench {

class PathSampler {
 public:
  /// Part of the references' key: raised when the path tracer's answer changes.
  static constexpr std::string_view kVersion = "path tracer 2, pixel centres, lambert";
  static constexpr std::string_view kVersionOfAllMaterials = "path tracer 2, pixel centres, all materials";

  /// bounces: of indirect light at most; 0: any number.
  PathSampler(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene, const Camera& camera,
              glm::ivec2 size, Transport transport, bool allMaterials = false, int bounces = 0);
  ~PathSampler();
  PathSampler(const PathSampler&) = delete;
  PathSampler& operator=(const PathSampler&) = delete;

  measure::Sampler asSampler();
  /// kVersion or kVersionOfAllMaterials, and the bounces: what a reference's key says of its sampler.
  std::string version() const;

 private:
  Image sample(std::uint64_t first, std::uint32_t samples);

  const gl::Context& context_;
  gl::ProgramLibrary& programs_;
  const Scene& scene_;
  Camera camera_;
  glm::ivec2 size_;
  Transport transport_;
  bool allMaterials_;
  int bounces_;
  std::unique_ptr<PathTracer> tracer_;
};

/// What is seen of lights alone, nothing scattered: emissive surfaces, environment, background.
Image seenLights(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene, const Camera& camera,
                 glm::ivec2 size);
/// The albedo of what is seen through the pixels' centres; 0 where nothing is.
Image albedoPicture(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene, const Camera& camera,
                    glm::ivec2 size);

}  // namespace lucerna::demo::bench
