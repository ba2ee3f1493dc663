// Participating media by name (no GL): the twelve of the VPT original as printed, and 27 measured liquids.
//
// Coefficients are in 1/mm, as published; a scene's loader turns them into 1 / scene unit. Sources: [VPT2024,
// table 4.1], [Narasimhan2006, table 2 of the supplement: dilutions, extinction, scattering and g].
#pragma once

#include "scene/medium.hpp"

#include <glm/glm.hpp>

#include <string>
#include <string_view>
#include <vector>

namespace lucerna {

struct CatalogueMedium {
  std::string name;  ///< lower case; unique
  glm::dvec3 scattering{0.0};  ///< sigma_s, 1/mm
  glm::dvec3 absorption{0.0};  ///< sigma_a, 1/mm
  glm::dvec3 anisotropy{0.0};  ///< g; 0 if sigma_s is 0 and g undefined
  double ior = 1.0;  ///< relative to vacuum
  bool published = false;  ///< one of the original's twelve
  std::string source;

  glm::dvec3 extinction() const { return scattering + absorption; }
  glm::dvec3 albedo() const;  ///< sigma_s / sigma_t; 0 if sigma_t is 0
  glm::dvec3 meanFreePath() const;  ///< mm; infinite if sigma_t is 0
};

/// All of them: the original's first, in its order.
const std::vector<CatalogueMedium>& mediaCatalogue();

/// The medium of that name, case-insensitive; null if there is none.
const CatalogueMedium* findCatalogueMedium(std::string_view name);

/// The original's medium named in a material's name ("Milk.001", "CocaCola", also in Czech, "sklo"). The match that
/// ends last wins, since the last word names the thing ("glass_of_milk" is milk, "MilkGlass" is glass); then the longer
/// one. Null if nothing matches.
const CatalogueMedium* resemblingMedium(std::string_view materialName);

/// Converted to a scene's medium, in 1 / scene unit.
Medium mediumOf(const CatalogueMedium& entry, double millimetresPerUnit);

}  // namespace lucerna
