// The whole of corrected radiosity: patches, direct light of lamps, form factors, solution, refinement; and its files.
//
// Input: a Scene. Output: irradiance and exitance of each patch (scene units), with the error that is guaranteed for the linear system.
// What that bound does not cover is the mesh (constant exitance in a patch) and the form factors (pixels decide visibility): README.md.
#pragma once

#include "gl/context.hpp"
#include "gl/program.hpp"
#include "radiosity/hemicubes.hpp"
#include "radiosity/patches.hpp"
#include "radiosity/solvers.hpp"

#include <filesystem>
#include <functional>
#include <span>
#include <vector>

namespace lucerna {

struct RadiositySolutionSettings {
  PatchSettings patches;           ///< longestEdge 0: a 12th of the scene's largest extent
  bool wholeTriangles = false;     ///< patches are the scene's triangles, whatever longestEdge says
  HemicubeSettings hemicubes;
  RadiosityDeviations deviations;  ///< of the original; values24Bit alone is refused: whole numbers are the published solver's
  RadiositySolver solver = RadiositySolver::automatic;
  double error = 1e-3;             ///< guaranteed: max |B - exact| over the mean of B
  int mostProducts = 100000;
  bool repair = true;              ///< reciprocity and row sums
  int refinements = 0;             ///< times that patches are halved where light changes steeply
  double steep = 0.1;              ///< change from patch to patch, in parts of the mean irradiance, that is refined
  std::size_t memoryBytes = 0;     ///< for form factors; more are read from the checkpoint for each product, or computed anew. 0: half of what the machine has free
};

/// What decides a solution, as on the command line: "rad.edge=0 rad.resolution=64 ...". Solver, memory and visibility are no part of it: with them a solution
/// differs within its error at most.
std::string textOf(const RadiositySolutionSettings& settings);

struct RadiosityStage {
  enum class Kind { direct, formFactors, solving } kind = Kind::formFactors;
  int refinement = 0;
  std::size_t done = 0, total = 0;  ///< patches
  RadiosityProgress solve;
};

struct RadiositySolution {
  RadiosityMesh mesh;
  RadiosityDeviations deviations;
  std::string settings;                ///< textOf() the settings it was solved with
  std::vector<glm::dvec3> direct;      ///< irradiance by sun, spot and omnidirectional lights
  std::vector<glm::dvec3> fromEmitters;  ///< irradiance by what patches emit, reflected nowhere
  std::vector<glm::dvec3> fromSky;     ///< irradiance by the environment, reflected nowhere
  std::vector<glm::dvec3> irradiance;  ///< in all
  std::vector<glm::dvec3> exitance;    ///< emission + reflectance * irradiance
  std::vector<float> fronts, backs;    ///< shares of each hemisphere
  RadiosityProgress progress;
  RadiositySolver solver = RadiositySolver::automatic;
  bool reached = false;
  bool keptRows = true;
  HemicubeVisibility visibility = HemicubeVisibility::automatic;  ///< that this run's hemicubes were made by
  std::size_t hemicubes = 0;           ///< computed in this run
  double hemicubeSeconds = 0.0, solveSeconds = 0.0;
  std::size_t entries = 0;             ///< form factors kept
  double repaired = 0.0;               ///< mean |row sum - share of fronts| before repair
};

/// Throws Error(badInput) for scenes without a solution and for checkpoints of another scene, other settings or another version.
/// `checkpoint`: every submission's rows are appended to it; a later run with the same scene and settings goes on from there, to the same bits.
/// It stays (and one more a refinement) until removeCheckpoints(). `onStage`: false stops: throws Stopped, and what
/// was computed stays in the checkpoint.
RadiositySolution solveScene(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene, const RadiositySolutionSettings& settings,
                             const std::filesystem::path& checkpoint = {}, const std::function<bool(const RadiosityStage&)>& onStage = {});

/// For when the solution has been saved.
void removeCheckpoints(const std::filesystem::path& checkpoint);

/// Values of patches at light vertices, for interpolation: means of the patches about them, by area; patches that see backs (they are inside something)
/// count less.
std::vector<glm::vec3> interpolatedToVertices(const RadiositySolution& solution, std::span<const glm::dvec3> ofPatches);

/// The patches as a scene of their own, three vertices a patch in order, so that gl_VertexID finds a corner's light; about `origin`.
Scene litScene(const Scene& scene, const RadiosityMesh& mesh, const glm::dvec3& origin = glm::dvec3(0.0));

/// A finished solution. Versioned, checked, written whole or not at all; loading one of another scene, or damaged, throws Error(badInput).
void saveSolution(const std::filesystem::path& file, const Scene& scene, const RadiositySolution& solution);
RadiositySolution loadSolution(const std::filesystem::path& file, const Scene& scene);

/// Compares what a solution was solved with to what is asked for now. Throws Error(badInput) naming `file` and all that differs where something was asked
/// for (is not the default) and is not so in the solution; what differs by default alone is one warning.
void checkSettings(const std::filesystem::path& file, const RadiositySolution& solution, const RadiositySolutionSettings& asked);

}  // namespace lucerna
