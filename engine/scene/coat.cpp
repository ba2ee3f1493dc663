#include "scene/coat.hpp"

#include "base/angles.hpp"
#include "shared/coat.h"

#include <algorithm>
#include <cmath>

namespace lucerna {

namespace {

constexpr int kAround = 24, kOutwards = 48;  // points of the rule; half of the circle, since lobes are symmetric

double lambdaOf(double cosine, double alpha) {
  return 0.5 * (std::sqrt(1.0 + alpha * alpha * (1.0 / (cosine * cosine) - 1.0)) - 1.0);
}

float grazingReflectance(const glm::vec3& specular) {
  return std::min(50.0f * std::max({specular.x, specular.y, specular.z}), 1.0f);
}

}  // namespace

// Facets are drawn as they are seen [DupuyBenyoub2023]; then the integrand is F G2 / G1. The cube has points for the
// lobe's long tail, facets seen edge-on.
CoatReflectance coatReflectance(double cosine, double alpha) {
  const double z = std::max(cosine, 1e-6), x = std::sqrt(std::max(0.0, 1.0 - z * z));
  const double lambda = lambdaOf(z, alpha), length = std::hypot(alpha * x, z);
  const glm::dvec2 stretched(alpha * x / length, z / length);  // x, z of the direction
  CoatReflectance sum{0.0, 0.0};
  for (int j = 0; j < kOutwards; ++j) {
    const double rest = 1.0 - (j + 0.5) / kOutwards, weight = 3.0 * rest * rest;
    const double capZ = rest * rest * rest * (1.0 + stretched.y) - stretched.y;
    const double r = std::sqrt(std::max(0.0, (1.0 - capZ) * (1.0 + capZ)));
    for (int k = 0; k < kAround; ++k) {
      const double angle = kPi * (k + 0.5) / kAround;
      const glm::dvec3 h = glm::normalize(glm::dvec3(alpha * (r * std::cos(angle) + stretched.x),
                                                     alpha * r * std::sin(angle), std::max(capZ + stretched.y, 1e-9)));
      const double along = x * h.x + z * h.z, iz = 2.0 * along * h.z - z;
      if (!(along > 0.0 && iz > 0.0)) continue;
      const double visible = weight * (1.0 + lambda) / (1.0 + lambda + lambdaOf(iz, alpha));
      sum.facets += visible;
      sum.grazing += visible * std::pow(1.0 - std::min(along, 1.0), 5.0);
    }
  }
  return {sum.facets / (kAround * kOutwards), sum.grazing / (kAround * kOutwards)};
}

const std::vector<glm::vec4>& coatTable() {
  static const std::vector<glm::vec4> table = [] {
    std::vector<glm::vec4> texels;
    texels.reserve(COAT_COSINES * COAT_ALPHAS);
    for (int y = 0; y < COAT_ALPHAS; ++y) {
      const double root = static_cast<double>(y) / (COAT_ALPHAS - 1);
      const std::size_t first = texels.size();
      for (int x = 0; x < COAT_COSINES; ++x) {
        const CoatReflectance e = coatReflectance(static_cast<double>(x) / (COAT_COSINES - 1), root * root);
        texels.emplace_back(e.facets, e.grazing, 0.0f, 0.0f);
      }
      // 2 times the integral of the cosine times what lies linearly between two texels.
      constexpr float kStep = 1.0f / (COAT_COSINES - 1);
      glm::vec2 mean(0.0f);
      for (int x = 0; x + 1 < COAT_COSINES; ++x) {
        const glm::vec2 a(texels[first + static_cast<std::size_t>(x)]),
            b(texels[first + static_cast<std::size_t>(x) + 1]);
        const float low = kStep * static_cast<float>(x);
        mean += kStep * (low * (a + b) + kStep * (a + 2.0f * b) / 3.0f);
      }
      for (std::size_t i = first; i < texels.size(); ++i) texels[i].z = mean.x, texels[i].w = mean.y;
    }
    return texels;
  }();
  return table;
}

glm::vec3 meanCoatReflectance(const glm::vec3& specular, float alpha) {
  if (specular == glm::vec3(0.0f)) return specular;
  const float row = std::sqrt(std::clamp(alpha, 0.0f, 1.0f)) * (COAT_ALPHAS - 1);
  const auto low = std::min(static_cast<std::size_t>(row), std::size_t{COAT_ALPHAS - 2});
  const glm::vec4 mean =
      glm::mix(coatTable()[low * COAT_COSINES], coatTable()[(low + 1) * COAT_COSINES], row - static_cast<float>(low));
  return specular * (mean.z - mean.w) + grazingReflectance(specular) * mean.w;
}

bool hasCoat(const Material& material) {
  if (material.bsdf == Bsdf::conductor) return material.roughness > 0.0f;
  if (material.bsdf != Bsdf::diffuse) return false;
  return material.specular != glm::vec3(0.0f) || (material.metalMap && material.metalMap->roughness >= 0.0f);
}

glm::vec3 wholeReflectance(const Material& material) {
  if (material.bsdf == Bsdf::mirror) return material.specular;
  const glm::vec3 coat = meanCoatReflectance(material.specular, material.roughness);
  return material.bsdf == Bsdf::conductor ? coat : coat + (1.0f - coat) * material.diffuse;
}

bool isMostlyReflection(const Material& material) {
  if (material.bsdf != Bsdf::diffuse) return material.bsdf != Bsdf::none;
  if (!hasCoat(material)) return false;
  const glm::vec3 coat = meanCoatReflectance(material.specular, material.roughness),
                  base = (1.0f - coat) * material.diffuse;
  return coat.x + coat.y + coat.z > base.x + base.y + base.z;
}

float alphaOfExponent(float exponent) { return std::sqrt(2.0f / (std::max(exponent, 0.0f) + 2.0f)); }

glm::vec3 baseUnderCoat(const glm::vec3& diffuse, const glm::vec3& specular) {
  return glm::min(diffuse / glm::max(1.0f - specular, glm::vec3(1e-6f)), glm::vec3(1.0f));
}

}  // namespace lucerna
