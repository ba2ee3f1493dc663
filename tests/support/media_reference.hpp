// The double-precision CPU reference implementation of the functions for participating media (no GL). Written from the
// textbook's formulas in long double, never from the shaders, which use others so as to bear single precision.
#pragma once

#include "scene/medium.hpp"

#include <glm/glm.hpp>

#include <random>

namespace lucerna::reference {

/// Cosine of the scattering angle for a uniform number: the textbook's inversion [HenyeyGreenstein1941]; xi = 0 is
/// straight back.
double henyeyGreensteinCosine(double g, double xi);
double henyeyGreensteinPdf(double g, double cosine);
/// Fraction scattered into cosines below `cosine`.
double henyeyGreensteinCdf(double g, double cosine);
double rayleighPdf(double cosine);
double rayleighCdf(double cosine);

/// Unpolarised, by the sines and tangents of the angles [BornWolf, 1.5.2 eq 21a]. eta: index on the light's side over
/// the other's.
double fresnel(double cosI, double eta);

/// Weights of the balance heuristic over the channels, unscaled in long double.
glm::dvec3 scatteringWeight(const Medium& medium, const glm::dvec3& q, double t);
glm::dvec3 passageWeight(const Medium& medium, const glm::dvec3& q, double d);

/// Trilinear between cell centres, 0 outside the box.
double density(const DensityGrid& grid, const glm::dvec3& point);
/// Integral of the density from `origin` over a length, by the midpoint rule.
double densityIntegral(const DensityGrid& grid, const glm::dvec3& origin, const glm::dvec3& direction, double length,
                       int steps);

/// Reflectance and transmittance of a slab with smooth boundaries in air for light that comes in at cosine mu, by an
/// analog random walk in double precision: nothing of the path tracer's estimators.
struct SlabResult {
  double reflectance = 0.0, transmittance = 0.0;
  double reflectanceError = 0.0, transmittanceError = 0.0;  ///< standard errors
};
SlabResult walkSlab(double albedo, double opticalDepth, double g, double ior, double mu, int photons, unsigned seed);

}  // namespace lucerna::reference
