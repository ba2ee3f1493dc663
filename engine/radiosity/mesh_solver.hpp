// Inside of solveScene(): one mesh, from direct light to exitances.
#pragma once

#include "radiosity/solution.hpp"

#include <cstdint>
#include <filesystem>
#include <functional>

namespace lucerna {

/// A hash of everything that determines a mesh's rows of form factors.
std::uint64_t rowsFingerprint(const RadiosityMesh& mesh, const HemicubeSettings& settings);

struct MeshSolverInput {
  const gl::Context& context;
  gl::ProgramLibrary& programs;
  const Scene& scene;
  const RadiositySolutionSettings& settings;  ///< with its deviations in terms of hemicubes and repair
  const std::function<bool(const RadiosityStage&)>& onStage;
  int refinement = 0;
  std::filesystem::path checkpoint = {};  ///< of this mesh; empty: none
  const RadiosityMoment* before = nullptr;  ///< of the same scene at another time
};

/// Solves one mesh as solveScene() says. `visibility`: of the hemicubes, if no checkpoint was begun with another; not
/// automatic where there is a moment before.
/// `deviations` and `settings` of the result are left to the caller.
RadiositySolution solveMesh(const MeshSolverInput& input, RadiosityMesh mesh, HemicubeVisibility visibility);

}  // namespace lucerna
