// The one surface of all techniques: a Lambertian base of albedo rho (Material::diffuse) under a rough coat (specular,
// roughness). Metals are coats over a black base. Pure, no GL.
//
//   f(o, i) = F D G2 / (4 <n,o> <n,i>) + rho / pi (1 - E(o)) (1 - E(i)) / (1 - Ebar)
//
// The first term is GGX with height-correlated shadowing [Walter2007; Heitz2014] and Schlick's Fresnel term F; E is its
// directional albedo, Ebar the mean of E over the hemisphere's cosine. The base gets what the coat lets in, both ways
// [KelemenSzirmayKalos2001]: f is reciprocal, and the albedo E(o) + rho (1 - E(o)) is 1 for a white base. Light that is
// reflected between microfacets is not added, so that a rough coat alone loses some.
// F(c) = F0 + (F90 - F0) (1 - c)^5, F0 = specular, F90 = min(1, 50 F0): below 2 % no real coat reflects fully at
// grazing angles, and a coat of 0 is none [Lagarde2014].
#pragma once

#include "scene/scene.hpp"

#include <vector>

namespace lucerna {

/// Directional albedo of a rough coat: E = F0 facets + (F90 - F0) grazing.
struct CoatReflectance {
  double facets;  ///< of facets with F = 1
  double grazing;  ///< of facets with F = (1 - c)^5
};

/// cosine: of the direction to the normal, 0..1; alpha: GGX roughness, 0..1. A midpoint rule over visible facets, to
/// 1e-4.
CoatReflectance coatReflectance(double cosine, double alpha);

/// The table that shaders read: COAT_COSINES columns from cosine 0 to 1, COAT_ALPHAS rows from sqrt(alpha) 0 to 1; x:
/// facets, y: grazing, z and w: their means. Made once.
const std::vector<glm::vec4>& coatTable();

/// Ebar, between the rows of the table.
glm::vec3 meanCoatReflectance(const glm::vec3& specular, float alpha);

/// Whether it reflects as a rough coat: also a conductor that is not smooth.
bool hasCoat(const Material& material);

/// Whether what it reflects, or lets through, is most of what it shows: metals, mirrors, glass.
bool isMostlyReflection(const Material& material);

/// Part of light from all sides that a surface reflects to all sides: what techniques for Lambertian surfaces take as
/// its albedo. Without textures; mirrors and metals count with all of their reflection.
glm::vec3 wholeReflectance(const Material& material);

/// GGX alpha of a Blinn-Phong exponent (MTL's Ns), the same width near the peak [Walter2007]: sqrt(2 / (n + 2)).
float alphaOfExponent(float exponent);

/// Albedo of the base below a coat so that `diffuse` (MTL's Kd) is the share of light that a surface seen along its
/// normal reflects diffusely, as far as its energy allows: Kd / (1 - Ks), at most 1.
glm::vec3 baseUnderCoat(const glm::vec3& diffuse, const glm::vec3& specular);

}  // namespace lucerna
