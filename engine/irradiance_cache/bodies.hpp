// Media inside of bodies, for the preview in reflections (shaders/irradiance_cache/body.glsl): absorption along rays;
// scattering as of a surface, by the diffuse reflectance of a half-space; clouds by random walks.
//
// Units: scene units of length. Sources: [vandeHulst1980], [Saunderson1942].
#pragma once

#include "gl/context.hpp"
#include "gl/objects.hpp"
#include "gl/program.hpp"
#include "scene/features.hpp"
#include "scene/scene.hpp"
#include "shared/bodies.h"

#include <glm/glm.hpp>

#include <vector>

namespace lucerna {

/// Share of diffuse light that a half-space of isotropic scattering throws back. albedo: scattering over extinction,
/// 0..1. Fit of [vandeHulst1980] for the spherical albedo, within 0.002.
double halfSpaceReflectance(double albedo);
/// Share of diffuse light that a smooth boundary reflects from outside; ior: of the inside over the outside, above 0.
double diffuseFresnel(double ior);
/// A record per material; the same for those that bound nothing.
std::vector<shared::BodyRecord> bodiesOf(const Scene& scene);

class Bodies {
 public:
  static bool isNeeded(const SceneFeatures& features) {
    return features.media && (features.dielectrics || features.nullBoundaries);
  }
  /// Density grids behind boundaries that light passes straight through: surfaces are seen through them.
  static bool hasClouds(const SceneFeatures& features) {
    return features.heterogeneousMedia && features.nullBoundaries;
  }
  /// origin: of the rays.
  Bodies(const Scene& scene, const glm::dvec3& origin, const gl::Capabilities& capabilities);
  gl::ShaderFlags flags() const;
  void bind(const gl::Program& program) const;  ///< storage blocks 0, 1 and 5
  std::size_t gpuBytes() const { return records_.bytes() + grids_.bytes() + densities_.bytes(); }

 private:
  static constexpr int kMostGrids = 4;  ///< further clouds are left out
  bool hasMedia_ = false, hasClouds_ = false;
  int gridCount_ = 0;
  glm::uvec4 gridClouds_{0u};  ///< materials
  gl::Buffer records_, grids_, densities_;
};

}  // namespace lucerna
