// Moments of rough reflection, for glossy reflection of the light propagation volume (shaders/lpv/glossy.glsl).
//
// Of a GGX lobe with height-correlated shadowing [Walter2007; Heitz2014], f times the cosine of i: its integral, the
// reflectance, and its integral times i, the first moment. Light of two bands needs no more of a lobe.
#pragma once

#include "gl/objects.hpp"

#include <glm/glm.hpp>

namespace lucerna {

/// x: reflectance, 0..1; y: moment along the mirror direction's tangent; z: moment along the normal.
struct GlossyLobe {
  glm::dvec3 facets;  ///< of facets of reflectance 1
  glm::dvec3 grazing;  ///< each weighted by (1 - <o, h>)^5: with Schlick's term F0 facets + (1 - F0) grazing
};

/// `cosine`: of the direction towards the eye, above 0; alpha: GGX roughness, above 0 to 1. A midpoint rule over
/// facets, to 2e-3. Pure.
GlossyLobe glossyLobe(double cosine, double alpha);

/// A table of them over the angle and sqrt(alpha).
class GlossyLobes {
 public:
  GlossyLobes();
  void bind() const;
  std::size_t gpuBytes() const { return table_.bytes(); }

 private:
  gl::Texture table_;
};

}  // namespace lucerna
