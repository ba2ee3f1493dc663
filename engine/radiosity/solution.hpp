// Corrected radiosity from start to end: patches, direct light of lamps, form factors, solution, refinement; and its
// files.
//
// Input: a Scene. Output: irradiance and exitance of each patch (scene units), with a guaranteed error of the linear
// system. The bound excludes errors of the mesh (constant exitance in a patch) and of form factors (visibility by
// pixels): README.md.
#pragma once

#include "base/stop_watch.hpp"
#include "gl/context.hpp"
#include "gl/program.hpp"
#include "radiosity/hemicube_settings.hpp"
#include "radiosity/moment_before.hpp"
#include "radiosity/patches.hpp"
#include "radiosity/solvers.hpp"

#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace lucerna {

struct RadiositySolutionSettings {
  PatchSettings patches;  ///< longestEdge 0: a 12th of the scene's largest extent
  bool wholeTriangles = false;  ///< patches are the scene's triangles, whatever longestEdge says
  HemicubeSettings hemicubes;
  RadiosityDeviations deviations;  ///< of the original; values24Bit is refused: only the published solver has it
  RadiositySolver solver = RadiositySolver::automatic;
  double error = 1e-3;  ///< guaranteed: max |B - exact| over the mean of B
  double mostProducts = 100000.0;
  bool repair = true;  ///< reciprocity and row sums
  int refinements = 0;  ///< number of times that patches are halved where light changes steeply
  double steep = 0.1;  ///< change between patches, relative to the mean irradiance, that is refined
  std::size_t memoryBytes = 0;  ///< for form factors; the rest is read from the checkpoint for each product, or
                                ///< recomputed. 0: half of the free memory
};

/// The settings that determine a solution, as on the command line: "radiosity.edge=0 radiosity.resolution=64 ...".
/// Solver, memory and visibility are excluded: they change a solution at most within its error.
std::string textOf(const RadiositySolutionSettings& settings);

struct RadiosityStage {
  enum class Kind { direct, formFactors, solving } kind = Kind::formFactors;
  int refinement = 0;
  std::size_t done = 0, total = 0;  ///< patches
  RadiosityProgress solve;
  LongWork prepares;  ///< what is done before the first form factor
};

struct RadiositySolution {
  RadiosityMesh mesh;
  RadiosityDeviations deviations;
  std::string settings;  ///< textOf() of its settings
  std::vector<glm::dvec3> direct;  ///< irradiance from sun, spot and omnidirectional lights
  std::vector<glm::dvec3> fromEmitters;  ///< irradiance directly from emissive patches
  std::vector<glm::dvec3> fromSky;  ///< irradiance directly from the environment
  std::vector<glm::dvec3> irradiance;  ///< in total
  std::vector<glm::dvec3> exitance;  ///< emission + reflectance * irradiance
  std::vector<float> fronts, backs;  ///< fractions of each hemisphere
  RadiosityProgress progress;
  RadiositySolver solver = RadiositySolver::automatic;
  bool reached = false;
  bool keptRows = true;
  HemicubeVisibility visibility = HemicubeVisibility::automatic;  ///< method of this run's hemicubes
  std::size_t hemicubes = 0;  ///< computed in this run
  double hemicubeSeconds = 0.0, solveSeconds = 0.0;
  std::size_t entries = 0;  ///< stored form factors
  double repaired = 0.0;  ///< mean |row sum - fraction of fronts| before repair
  std::shared_ptr<const RadiosityMoment> moment;  ///< for the next moment; null unless the scene moves
};

/// Throws Error(badInput) for scenes without a solution and for checkpoints of another scene, other settings or another
/// version. `checkpoint`: every submission's rows are appended to it; a later run with the same scene and settings
/// resumes from it, to the same bits. It stays (and one more per refinement) until removeCheckpoints(). `onStage`:
/// false stops: throws Stopped, and finished work stays in the checkpoint. `before`: a solution of the same scene at
/// another time, by the same settings. Rows that saw nothing of what has changed are taken from it (not with
/// refinements, which follow the light), so is the method of hemicubes, and its light is what the solver starts from.
RadiositySolution solveScene(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene,
                             const RadiositySolutionSettings& settings, const std::filesystem::path& checkpoint = {},
                             const std::function<bool(const RadiosityStage&)>& onStage = {},
                             const RadiositySolution* before = nullptr);

/// The form factors of a scene's first mesh only (refinements have others), so that parts of their rows can be computed
/// separately. joinRowFiles() (row_file.hpp) joins them to the checkpoint that solveScene() would have written, to the
/// same bits. All parts must use the same method: automatic visibility here means visibilityByCount(), and solveScene()
/// continues with it as with any checkpoint.
class FormFactorParts {
 public:
  FormFactorParts(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene,
                  const RadiositySolutionSettings& settings);
  ~FormFactorParts();
  std::size_t patches() const;  ///< number of rows
  HemicubeVisibility visibility() const;
  std::uint64_t fingerprint() const;  ///< hash of everything that determines them
  /// Computes rows `first` to `last` - 1 into `file`, submission by submission, or continues it. `goOn` is called with
  /// the number of rows computed so far; false stops. Returns the number computed in this call.
  std::size_t make(std::size_t first, std::size_t last, const std::filesystem::path& file,
                   const std::function<bool(std::size_t done)>& goOn);

 private:
  struct Work;
  std::unique_ptr<Work> work_;
};

/// Call it after the solution has been saved.
void removeCheckpoints(const std::filesystem::path& checkpoint);

/// Values of patches at light vertices, for interpolation: area-weighted means of the patches around; patches that see
/// backs (inside something) count less.
std::vector<glm::vec3> interpolatedToVertices(const RadiositySolution& solution, std::span<const glm::dvec3> ofPatches);

/// Sources of the irradiance at a point of a patch, W per square scene unit.
struct RadiosityOrigins {
  glm::dvec3 lamps{0.0}, sky{0.0};  ///< of the surrounding patches
  struct FromPatch {
    std::uint32_t patch;
    double factor;  ///< form factor from the point to it
    glm::dvec3 emitted, reflected;
  };
  std::vector<FromPatch> patches;  ///< the largest first
  /// The solution's irradiance less that of `patches`: its form factors were repaired (reciprocity, row sums). The
  /// solver's error is in it too.
  glm::dvec3 repairOfEmitted{0.0}, repairOfReflected{0.0};
};
/// For the point of `patch` with these weights of its corners; `flat`: for the patch as a whole. The form factors are
/// recomputed, by hemicubes only.
RadiosityOrigins originsOf(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene,
                           const RadiositySolution& solution, const RadiositySolutionSettings& settings,
                           std::uint32_t patch, const glm::dvec3& corners, bool flat);

/// A patch's hemicube, pixel by pixel.
struct HemicubePixels {
  int resolution = 0;  ///< pixels per side of the full face
  std::vector<std::uint32_t> seen;  ///< patch + 1, or 0, in the layout of shaders/radiosity/hemicube.glsl
  std::vector<double> weights;  ///< of the full face's pixels, then of a half face's: deltaFormFactors()
  glm::dmat3 axes{1.0};  ///< u, v and the patch's normal
  HemicubeVisibility visibility = HemicubeVisibility::rays;
};
/// As the solution's were drawn, but by rays where those were by raster, whose pixels name no patches: the two differ
/// within rounding of a pixel's centre.
HemicubePixels hemicubeOf(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene,
                          const RadiositySolution& solution, const RadiositySolutionSettings& settings,
                          std::uint32_t patch);

/// The patches as a separate scene, three vertices per patch in order, so that gl_VertexID finds a corner's light;
/// relative to `origin`.
Scene litScene(const Scene& scene, const RadiosityMesh& mesh, const glm::dvec3& origin = glm::dvec3(0.0));

/// Solution files. Versioned, checked, written completely or not at all; loading one of another scene, or a damaged
/// one, throws Error(badInput).
void saveSolution(const std::filesystem::path& file, const Scene& scene, const RadiositySolution& solution);
RadiositySolution loadSolution(const std::filesystem::path& file, const Scene& scene);

/// Compares a solution's settings with the requested ones. Throws Error(badInput) naming `file` and all differences
/// where a setting was given (is not the default); differences from defaults give one warning.
void checkSettings(const std::filesystem::path& file, const RadiositySolution& solution,
                   const RadiositySolutionSettings& asked);

}  // namespace lucerna
