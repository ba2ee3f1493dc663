// The lights of a scene for next-event estimation: which one a path asks, by one random number. No GL.
//
// Lamps (sun, spots, omnidirectional), each emissive triangle and an environment picture are entries of one alias table [Vose1991]. Half of
// the choice goes in equal parts to the lamps, to all triangles together and to the environment, half in proportion to power, so that none
// is ever neglected; any choice gives the same picture in the end.
#pragma once

#include "scene/scene.hpp"
#include "shared/path_tracer.h"

#include <vector>

namespace lucerna {

/// Entry i is taken where a number in [0,1) is below threshold[i], else alias[i]; i is uniform.
struct AliasTable {
  std::vector<float> threshold;
  std::vector<std::uint32_t> alias;
  std::vector<double> probability;  ///< of each entry, as asked for
};
/// Weights finite and >= 0, one at least above 0; at most 2^32 - 1 of them.
AliasTable aliasTable(const std::vector<double>& weights);

struct LightTable {
  std::vector<shared::PathLight> lights;  ///< positions relative to `origin`; empty: nothing to ask
  std::vector<float> pickDensity;         ///< a triangle: probability of asking a light sample for a point of it, per unit of area; empty: nothing shines
  double environmentPick = 0.0;           ///< probability of asking the environment picture
};
LightTable lightTable(const Scene& scene, const glm::dvec3& origin);

/// An environment picture as the shader picks its texels: a row, then a texel of it, each by an alias table [Vose1991] in whole numbers, so that pictures of any size are picked
/// texel by texel (a float counts to 2^24). The picture must not be black.
struct EnvironmentTable {
  std::vector<glm::uvec4> texels;  ///< row by row: threshold of 2^32, alias (a column), bits of the density over solid angle in 1/sr
  std::vector<glm::uvec4> rows;    ///< threshold of 2^32, alias (a row)
};
EnvironmentTable environmentTable(const Image& picture);
/// Mean radiance over all directions, without Environment::radiance.
glm::dvec3 meanRadiance(const Image& picture);

}  // namespace lucerna
