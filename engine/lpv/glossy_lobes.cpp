#include "lpv/glossy_lobes.hpp"

#include "base/angles.hpp"
#include "shared/bindings.h"
#include "shared/lpv.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace lucerna {

namespace {
constexpr int kFromPole = 32, kAround = 16;  // points of the rule; half of the circle, since lobes are symmetric

double shadowingLambda(double cosine, double alpha) {
  return 0.5 * (std::sqrt(1.0 + alpha * alpha * (1.0 / (cosine * cosine) - 1.0)) - 1.0);
}
}  // namespace

// f <n, i> di = D G2 <o, h> / <n, o> dh. Facets are distributed as D <n, h> dh = du dphi / (2 pi) with tan^2 = alpha^2
// u / (1 - u) [Walter2007, eq 35]; u = 1 - (1 - v)^3 resolves the facets far from the normal.
GlossyLobe glossyLobe(double cosine, double alpha) {
  const glm::dvec3 o(-std::sqrt(std::max(0.0, 1.0 - cosine * cosine)), 0.0, cosine);  // x: towards the mirror direction
  const double lambda = shadowingLambda(cosine, alpha);
  GlossyLobe lobe{glm::dvec3(0.0), glm::dvec3(0.0)};
  for (int j = 0; j < kFromPole; ++j) {
    const double rest = 1.0 - (j + 0.5) / kFromPole, upper = rest * rest * rest;  // 1 - v and 1 - u
    const double z = 1.0 / std::sqrt(1.0 + alpha * alpha * (1.0 - upper) / upper), r = std::sqrt(1.0 - z * z);
    for (int k = 0; k < kAround; ++k) {
      const double angle = kPi * (k + 0.5) / kAround;
      const glm::dvec3 h(r * std::cos(angle), r * std::sin(angle), z);
      const double along = glm::dot(o, h);
      const glm::dvec3 i = 2.0 * along * h - o;
      if (!(along > 0.0 && i.z > 0.0)) continue;
      const double shadowed = 1.0 / (1.0 + lambda + shadowingLambda(i.z, alpha));
      const double weight = 3.0 * rest * rest * shadowed * along / (cosine * z) / (kFromPole * kAround);
      const glm::dvec3 moments = weight * glm::dvec3(1.0, i.x, i.z);
      lobe.facets += moments;
      lobe.grazing += std::pow(1.0 - std::min(along, 1.0), 5.0) * moments;
    }
  }
  return lobe;
}

GlossyLobes::GlossyLobes()
    : table_("lpv glossy lobes", gl::Format::rgba32f, glm::ivec2(LPV_LOBES_ANGLES, 2 * LPV_LOBES_ALPHAS),
             gl::Sampling{gl::Filter::linear, gl::Filter::linear}) {
  std::vector<glm::vec4> facets, grazing;
  for (int y = 0; y < LPV_LOBES_ALPHAS; ++y)
    for (int x = 0; x < LPV_LOBES_ANGLES; ++x) {
      const double angle = 0.5 * kPi * (x + 0.5) / LPV_LOBES_ANGLES, root = (y + 0.5) / LPV_LOBES_ALPHAS;
      const GlossyLobe lobe = glossyLobe(std::cos(angle), root * root);
      facets.emplace_back(glm::vec3(lobe.facets), 0.0f);
      grazing.emplace_back(glm::vec3(lobe.grazing), 0.0f);
    }
  std::vector<glm::vec4> texels = facets;
  texels.insert(texels.end(), grazing.begin(), grazing.end());
  table_.upload(gl::Texels::rgbaFloat, texels.data());
}

void GlossyLobes::bind() const { table_.bind(UNIT_LPV_LOBES); }

}  // namespace lucerna
