// What a moment of a scene that moves takes from the moment before: rows of form factors, and the light that its
// solution starts from (no GL, pure).
//
// A patch is the same if its corners (bit for bit, in their order), its material and its hidden parts are, and whether
// it emits. Its row is made again if its hemicube saw a patch that is gone, or may see a new one. Where it is closed,
// what it saw hides what lies beyond: the new is unseen if no line to what it saw passes a box around it.
#pragma once

#include "radiosity/form_factor_matrix.hpp"
#include "radiosity/form_factor_rows.hpp"
#include "radiosity/patches.hpp"
#include "radiosity/solvers.hpp"

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace lucerna {

/// What a solution leaves for the next moment.
struct RadiosityMoment {
  RadiosityMesh mesh;  ///< where it was solved: about the origin
  /// As hemicubes made them, and after their repair; null if they do not fit in memory.
  std::shared_ptr<const FormFactorMatrix> rows, repaired;
  std::vector<float> fronts, backs;  ///< shares of each hemisphere
  std::vector<std::uint32_t> sources;  ///< smallSourcesOf(mesh)
  std::vector<glm::dvec3> irradiance;  ///< from patches
  glm::dvec3 emitted{0.0};  ///< flux that patches emit, and reflect of lamps and sky
};

/// Flux of RadiositySystem::emission.
glm::dvec3 emittedBy(const RadiositySystem& system);

class MomentBefore {
 public:
  /// `sources`: smallSourcesOf(mesh), empty if hemicubes do not look for them. All must outlive this.
  MomentBefore(const RadiosityMoment& before, const Scene& scene, const RadiosityMesh& mesh,
               std::span<const std::uint32_t> sources);

  /// Whether all rows are those of the moment before: nothing but light has changed.
  bool isWhole() const { return isWhole_; }
  /// Of each patch: whether its row is that of the moment before, but for the numbers of patches.
  const std::vector<bool>& rowHolds() const { return rowHolds_; }
  /// Rows first..end - 1, which hold, with the numbers of now.
  FormFactorRows rows(std::size_t first, std::size_t end) const;
  /// Irradiance from patches to start with: that of the same patch, else the mean of the patch's triangle, all times
  /// the change of the emitted light. 0 where there was none, and where no light reaches now.
  std::vector<glm::dvec3> start(const RadiositySystem& system) const;

 private:
  void findSamePatches();
  bool holds(std::size_t patch) const;
  bool maySee(const Patch& patch, const Bounds& box, std::span<const std::uint32_t> seen) const;
  bool lacksASource(std::size_t patch, std::span<const std::uint32_t> seen) const;
  bool isBlocked(const glm::dvec3& from, const glm::dvec3& to, std::span<const std::uint32_t> seen) const;

  const RadiosityMoment& before_;
  const RadiosityMesh& mesh_;
  double slack_;  ///< boxes are wider by this: surfaces that touch them may hide them or not
  std::vector<std::uint32_t> same_;  ///< of each patch: the same one before, or kNone
  std::vector<std::uint32_t> now_;  ///< of each patch before: the same one now, or kNone
  std::vector<Bounds> gone_, new_;  ///< around the patches of each mesh of the scene that are not the same
  std::vector<std::uint32_t> sources_;  ///< small sources, by number
  std::vector<bool> rowHolds_;
  bool isWhole_ = false;
};

}  // namespace lucerna
