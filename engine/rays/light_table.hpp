// The lights of a scene for next-event estimation, chosen by one random number. No GL.
//
// Lamps (sun, spots, omnidirectional), each emissive triangle and an environment picture are entries of one alias table
// [Vose1991]. Half of the probability goes in equal parts to the lamps, to all triangles together and to the
// environment, half in proportion to power, so that none is neglected; any choice converges to the same picture.
// Programs that take more than one sample may take one of the sun each time, and draw the others from other lights.
#pragma once

#include "rays/light_hierarchy.hpp"
#include "scene/scene.hpp"
#include "shared/path_tracer.h"

#include <cmath>
#include <vector>

namespace lucerna {

/// Entry i is chosen if a number in [0,1) is below threshold[i], else alias[i]; i is uniform.
struct AliasTable {
  std::vector<float> threshold;
  std::vector<std::uint32_t> alias;
  std::vector<double> probability;  ///< requested, of each entry
};
/// Weights finite and >= 0, at least one above 0; at most 2^32 - 1 of them.
AliasTable aliasTable(const std::vector<double>& weights);

/// 1 - cosine of half the sun's angular diameter, in full precision.
inline float sunLessCosine(const DirectionalLight& sun) {
  return static_cast<float>(2.0 * std::pow(std::sin(0.25 * sun.angularDiameter), 2.0));
}

struct LightTable {
  std::vector<shared::PathLight> lights;  ///< positions relative to `origin`; empty: no lights to sample
  std::vector<float> pickDensity;  ///< per triangle: probability density of sampling a point of it, per unit of area;
                                   ///< empty: nothing emits
  double environmentPick = 0.0;  ///< probability of sampling the environment picture
  double lampPick = 0.0;  ///< probability of sampling any of `lamps`
  bool sunApart = false;  ///< the first light is the sun, of probability 1; the alias table is that of the others
  std::vector<LocalLamp> lamps;  ///< the lights that are not at infinity
};
/// sunApart: where that is possible and pays, with a sun and other lights, none of them an environment picture.
LightTable lightTable(const Scene& scene, const glm::dvec3& origin, bool sunApart = false);

/// Sampling tables of an environment picture: a row, then a texel of it, each by an alias table [Vose1991] in integers,
/// so that pictures of any size are sampled by texel (a float counts to 2^24). The picture must not be black.
struct EnvironmentTable {
  std::vector<glm::uvec4>
      texels;  ///< row by row: threshold of 2^32, alias (a column), bits of the density over solid angle in 1/sr
  std::vector<glm::uvec4> rows;  ///< threshold of 2^32, alias (a row)
};
EnvironmentTable environmentTable(const Image& picture);
/// Mean radiance over all directions, without Environment::radiance.
glm::dvec3 meanRadiance(const Image& picture);

}  // namespace lucerna
