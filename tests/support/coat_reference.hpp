// Double-precision reference implementation of the surface of all techniques (engine/scene/coat.hpp): a Lambertian base
// under a rough coat. Independent of the engine's table: albedos are integrated over facets as they are distributed
// [Walter2007, eq 35], not as they are seen.
#pragma once

#include <glm/glm.hpp>

#include <vector>

namespace lucerna::reference {

class CoatedSurface {
 public:
  CoatedSurface(const glm::dvec3& base, const glm::dvec3& specular, double alpha);
  /// Directional albedo of the coat, and its mean over the hemisphere.
  glm::dvec3 albedo(double cosine) const;
  glm::dvec3 meanAlbedo() const { return mean_; }
  /// BSDF without the cosine; normal: z. Directions unit, away from the surface, above it.
  glm::dvec3 bsdf(const glm::dvec3& o, const glm::dvec3& i) const;

 private:
  glm::dvec3 base_, specular_, mean_{0.0};
  double alpha_;
  std::vector<glm::dvec3> albedos_;  ///< at equal steps of the cosine
};

}  // namespace lucerna::reference
