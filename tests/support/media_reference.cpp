#include "support/media_reference.hpp"

#include <algorithm>
#include <cmath>

namespace lucerna::reference {

using Real = long double;

double henyeyGreensteinCosine(double g_, double xi_) {
  const Real g = g_, xi = xi_;
  if (g == 0.0L) return static_cast<double>(2.0L * xi - 1.0L);
  const Real s = (1.0L - g * g) / (1.0L - g + 2.0L * g * xi);
  return static_cast<double>((1.0L + g * g - s * s) / (2.0L * g));
}

double henyeyGreensteinPdf(double g_, double cosine) {
  const Real g = g_, d = 1.0L + g * g - 2.0L * g * cosine;
  return static_cast<double>((1.0L - g * g) / (4.0L * static_cast<Real>(M_PI) * d * std::sqrt(d)));
}

double henyeyGreensteinCdf(double g_, double cosine) {
  const Real g = g_;
  if (std::abs(g) < 1e-9L) return 0.5 * (1.0 + cosine);
  return static_cast<double>((1.0L - g * g) / (2.0L * g) *
                             (1.0L / std::sqrt(1.0L + g * g - 2.0L * g * cosine) - 1.0L / (1.0L + g)));
}

double rayleighPdf(double cosine) { return 3.0 / (16.0 * M_PI) * (1.0 + cosine * cosine); }
double rayleighCdf(double c) { return 0.5 + 0.375 * (c + c * c * c / 3.0); }

double fresnel(double cosI, double eta) {
  const Real sinT = static_cast<Real>(eta) * std::sqrt((1.0L - cosI) * (1.0L + cosI));
  if (sinT >= 1.0L) return 1.0;
  const Real a = std::acos(static_cast<Real>(cosI)), b = std::asin(sinT);
  if (a < 1e-6L) return static_cast<double>((eta - 1.0L) * (eta - 1.0L) / ((eta + 1.0L) * (eta + 1.0L)));
  const Real s = std::sin(a - b) / std::sin(a + b), p = std::tan(a - b) / std::tan(a + b);
  return static_cast<double>(0.5L * (s * s + p * p));
}

namespace {
struct Channels {
  Real extinction[3], scattering[3], transmittance[3];
  Real rate[3], flies[3];  ///< of collisions drawn, and the probability of flying that far
};
Channels channelsOf(const Medium& medium, double t) {
  Channels c;
  for (int i = 0; i < 3; ++i) {
    c.scattering[i] = medium.scattering[i];
    c.extinction[i] = c.scattering[i] + static_cast<Real>(medium.absorption[i]);
    c.transmittance[i] = std::exp(-c.extinction[i] * static_cast<Real>(t));
    c.rate[i] = c.scattering[i] < 0.25L * c.extinction[i] ? c.scattering[i] : c.extinction[i];
    c.flies[i] = std::exp(-c.rate[i] * static_cast<Real>(t));
  }
  return c;
}
}  // namespace

glm::dvec3 scatteringWeight(const Medium& medium, const glm::dvec3& q, double t) {
  const Channels c = channelsOf(medium, t);
  Real pdf = 0.0L;
  for (int i = 0; i < 3; ++i) pdf += static_cast<Real>(q[i]) * c.rate[i] * c.flies[i];
  glm::dvec3 weight;
  for (int i = 0; i < 3; ++i) weight[i] = static_cast<double>(c.scattering[i] * c.transmittance[i] / pdf);
  return weight;
}

glm::dvec3 passageWeight(const Medium& medium, const glm::dvec3& q, double d) {
  const Channels c = channelsOf(medium, d);
  Real probability = 0.0L;
  for (int i = 0; i < 3; ++i) probability += static_cast<Real>(q[i]) * c.flies[i];
  glm::dvec3 weight;
  for (int i = 0; i < 3; ++i) weight[i] = static_cast<double>(c.transmittance[i] / probability);
  return weight;
}

double density(const DensityGrid& grid, const glm::dvec3& point) {
  const glm::dvec3 cell = (point - grid.min) / (grid.max - grid.min) * glm::dvec3(grid.size);
  for (int i = 0; i < 3; ++i)
    if (cell[i] < 0.0 || cell[i] > grid.size[i]) return 0.0;
  double sum = 0.0;
  const glm::dvec3 base = glm::floor(cell - 0.5), f = cell - 0.5 - base;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::ivec3 step(corner & 1, (corner >> 1) & 1, corner >> 2);
    const glm::ivec3 at = glm::clamp(glm::ivec3(base) + step, glm::ivec3(0), grid.size - 1);
    double weight = 1.0;
    for (int i = 0; i < 3; ++i) weight *= step[i] ? f[i] : 1.0 - f[i];
    sum += weight * static_cast<double>(
                        grid.density[static_cast<std::size_t>(at.x + grid.size.x * (at.y + grid.size.y * at.z))]);
  }
  return sum;
}

double densityIntegral(const DensityGrid& grid, const glm::dvec3& origin, const glm::dvec3& direction, double length,
                       int steps) {
  double sum = 0.0;
  for (int i = 0; i < steps; ++i) sum += density(grid, origin + (i + 0.5) * length / steps * direction);
  return sum * length / steps;
}

SlabResult walkSlab(double albedo, double opticalDepth, double g, double ior, double mu, int photons, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  double back = 0.0, through = 0.0;
  for (int i = 0; i < photons; ++i) {
    if (unit(random) < fresnel(mu, 1.0 / ior)) {
      ++back;
      continue;
    }
    double z = 0.0,
           c = std::sqrt(1.0 - (1.0 - mu * mu) / (ior * ior));  // depth in mean free paths, cosine down the slab
    for (;;) {
      z -= std::log(1.0 - unit(random)) * c;
      if (z < 0.0 || z > opticalDepth) {
        // Distances are memoryless, so a walk reflected at the boundary starts anew there.
        const bool top = z < 0.0;
        if (unit(random) < fresnel(std::abs(c), ior)) {
          z = top ? 0.0 : opticalDepth;
          c = -c;
          continue;
        }
        ++(top ? back : through);
        break;
      }
      if (unit(random) >= albedo) break;
      const double turn = henyeyGreensteinCosine(g, unit(random)), phi = 2.0 * M_PI * unit(random);
      c = std::clamp(c * turn + std::sqrt((1.0 - c * c) * (1.0 - turn * turn)) * std::cos(phi), -1.0, 1.0);
    }
  }
  const double r = back / photons, t = through / photons;
  return {r, t, std::sqrt(r * (1.0 - r) / photons), std::sqrt(t * (1.0 - t) / photons)};
}

}  // namespace lucerna::reference
