// Direct light per pixel by shadow rays, for the radiosity view: sharp shadows, whereas patches have one value each.
//
// Input: a Scene. Output, to fragment shaders that include shaders/radiosity/direct_rays.glsl: irradiance from emissive
// triangles (their closed form [Lambert1760] times their visible fraction, by rays), sun, spot and omnidirectional
// lights (one ray each). Scene units. A triangle that shines by a picture is cut into the texels of it, or squares of
// texels where there are too many, so that each piece has one emission.
#pragma once

#include "gl/objects.hpp"
#include "rays/ray_scene.hpp"
#include "scene/scene.hpp"

namespace lucerna {

class DirectRays {
 public:
  /// Maximum number of emissive triangles, or pieces of them: each costs rays in every pixel.
  static constexpr std::size_t kMostEmitters = 64;
  static std::size_t emitterCount(const Scene& scene);  ///< triangles, or pieces

  /// `rays`: per pixel, divided among the emissive triangles (at least one each). `origin`: of the pixels' positions,
  /// in the scene's coordinates.
  DirectRays(const Scene& scene, const gl::Capabilities& capabilities, int rays,
             const glm::dvec3& origin = glm::dvec3(0.0));
  void bind() const;  ///< storage block 1, texture units 60 and 61
  /// Estimated work per pixel: gl/chunks.hpp.
  double iterationsOfPixel() const { return iterationsOfPixel_; }
  std::size_t gpuBytes() const { return rays_.gpuBytes() + lights_.bytes(); }

 private:
  RayScene rays_;
  gl::Buffer lights_;
  double iterationsOfPixel_ = 1.0;
};

}  // namespace lucerna
