// The path tracer as the sampler of references: corrected, restricted to one transport, with Lambertian surfaces unless
// all materials are requested, and camera rays through pixel centres as in forward shading.
#pragma once

#include "gl/context.hpp"
#include "gl/program.hpp"
#include "measure/reference.hpp"
#include "scene/scene.hpp"

#include <memory>
#include <string>

namespace lucerna {

class PathTracer;

class PathSampler {
 public:
  /// Part of the references' key: incremented when the path tracer's result changes.
  static constexpr std::string_view kVersion = "path tracer 2, pixel centres, lambert";
  static constexpr std::string_view kVersionOfAllMaterials = "path tracer 2, pixel centres, all materials";

  /// bounces: maximum for indirect light; 0: any number.
  PathSampler(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene, const Camera& camera,
              glm::ivec2 size, Transport transport, bool allMaterials = false, int bounces = 0);
  ~PathSampler();
  PathSampler(const PathSampler&) = delete;
  PathSampler& operator=(const PathSampler&) = delete;

  measure::Sampler asSampler();
  /// kVersion or kVersionOfAllMaterials, and the bounces: the sampler's part of a reference's key.
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

/// Only directly visible lights, nothing scattered: emissive surfaces, environment, background.
Image seenLights(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene, const Camera& camera,
                 glm::ivec2 size);
/// The albedo visible through the pixels' centres; 0 where there is no surface.
Image albedoPicture(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene, const Camera& camera,
                    glm::ivec2 size);

}  // namespace lucerna
