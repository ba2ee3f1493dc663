// Participating media as plain data (no GL).
//
// Coefficients are per scene unit of length: loaders divide by the scene's scale, so no later code deals with
// millimetres. Source of the quantities and their names: [Chandrasekhar1960]; extinction = scattering + absorption.
#pragma once

#include <glm/glm.hpp>

#include <optional>
#include <string>
#include <vector>

namespace lucerna {

enum class PhaseFunction { henyeyGreenstein, rayleigh };

/// A dimensionless density on a regular grid over a box in world space; between cell centres it is interpolated
/// trilinearly, outside the box it is 0. It multiplies scattering, absorption and emission alike.
struct DensityGrid {
  glm::ivec3 size{0};  ///< cells
  std::vector<float> density;  ///< size.x * size.y * size.z, x fastest; finite, >= 0
  glm::dvec3 min{0.0}, max{1.0};  ///< the box, scene units
};

struct Medium {
  std::string name;
  glm::vec3 scattering{0.0f};  ///< sigma_s, 1 / scene unit
  glm::vec3 absorption{0.0f};  ///< sigma_a, 1 / scene unit
  glm::vec3 anisotropy{
      0.0f};  ///< g per channel, mean cosine of Henyey-Greenstein, -1..1 exclusive; not read for Rayleigh
  PhaseFunction phase = PhaseFunction::henyeyGreenstein;
  glm::vec3 emission{0.0f};  ///< radiance emitted per scene unit of length
  std::optional<DensityGrid> grid;  ///< none: homogeneous
};

}  // namespace lucerna
