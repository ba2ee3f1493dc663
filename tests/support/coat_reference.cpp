#include "support/coat_reference.hpp"

#include "base/angles.hpp"

#include <algorithm>
#include <cmath>

namespace lucerna::reference {

namespace {

constexpr int kTilts = 128, kTurns = 48, kCosines = 400;

double smith(const glm::dvec3& w, double alpha) {
  return 0.5 * (std::sqrt(1.0 + alpha * alpha * (w.x * w.x + w.y * w.y) / (w.z * w.z)) - 1.0);
}

glm::dvec3 fresnel(const glm::dvec3& specular, double cosine) {
  const double grazing = std::min(1.0, 50.0 * std::max({specular.x, specular.y, specular.z}));
  return specular + (grazing - specular) * std::pow(1.0 - std::min(cosine, 1.0), 5.0);
}

glm::dvec3 coatAlbedo(const glm::dvec3& specular, double alpha, double cosine) {
  const double z = std::max(cosine, 1e-4);
  const glm::dvec3 o(std::sqrt(std::max(0.0, 1.0 - z * z)), 0.0, z);
  glm::dvec3 sum(0.0);
  for (int j = 0; j < kTilts; ++j) {
    // u = 1 - (1 - v)^3 has points far from the normal too.
    const double rest = 1.0 - (j + 0.5) / kTilts, upper = rest * rest * rest;
    const double hz = 1.0 / std::sqrt(1.0 + alpha * alpha * (1.0 - upper) / upper);
    const double r = std::sqrt(std::max(0.0, 1.0 - hz * hz));
    for (int k = 0; k < kTurns; ++k) {
      const double turn = kPi * (k + 0.5) / kTurns;
      const glm::dvec3 h(r * std::cos(turn), r * std::sin(turn), hz);
      const double along = glm::dot(o, h);
      const glm::dvec3 i = 2.0 * along * h - o;
      if (!(along > 0.0 && i.z > 0.0)) continue;
      const double shadowing = 1.0 / (1.0 + smith(o, alpha) + smith(i, alpha));
      sum += 3.0 * rest * rest * along * shadowing / (z * hz) * fresnel(specular, along);
    }
  }
  return sum / static_cast<double>(kTilts * kTurns);
}

}  // namespace

CoatedSurface::CoatedSurface(const glm::dvec3& base, const glm::dvec3& specular, double alpha)
    : base_(base), specular_(specular), alpha_(alpha) {
  for (int k = 0; k <= kCosines; ++k)
    albedos_.push_back(coatAlbedo(specular, alpha, static_cast<double>(k) / kCosines));
  for (int k = 0; k < kCosines; ++k) {
    const double cosine = (k + 0.5) / kCosines;
    mean_ += 2.0 * cosine * albedo(cosine) / static_cast<double>(kCosines);
  }
}

glm::dvec3 CoatedSurface::albedo(double cosine) const {
  const double place = std::clamp(cosine, 0.0, 1.0) * kCosines;
  const auto low = std::min(static_cast<std::size_t>(place), albedos_.size() - 2);
  return glm::mix(albedos_[low], albedos_[low + 1], place - static_cast<double>(low));
}

glm::dvec3 CoatedSurface::bsdf(const glm::dvec3& o, const glm::dvec3& i) const {
  const glm::dvec3 h = glm::normalize(o + i);
  const double a2 = alpha_ * alpha_, t = (h.x * h.x + h.y * h.y) / a2 + h.z * h.z;
  const double facets = 1.0 / (kPi * a2 * t * t) / (1.0 + smith(o, alpha_) + smith(i, alpha_)) / (4.0 * o.z * i.z);
  return facets * fresnel(specular_, glm::dot(o, h)) +
         base_ / kPi * (1.0 - albedo(o.z)) * (1.0 - albedo(i.z)) / (1.0 - mean_);
}

}  // namespace lucerna::reference
