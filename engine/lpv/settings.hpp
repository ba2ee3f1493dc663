// Settings and inputs of a light propagation volume. README.md in this folder has units and sources.
#pragma once

#include "base/named_values.hpp"
#include "gl/objects.hpp"
#include "cascades/cascades.hpp"
#include "rsm/reflective_shadow_map.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>
#include <vector>

namespace lucerna {

/// How the grid is filled. `layered`: geometry shader and additive blending. `atomic`: float image atomics, an
/// extension. `fixed`: 32-bit integer image atomics, core OpenGL 4.3, the same bits every run.
enum class LpvFill { layered, atomic, fixed };
constexpr std::array<std::string_view, 3> namesOf(LpvFill) { return {"layered", "atomic", "fixed"}; }

/// `compute`: all cascades in one dispatch per step. `layered`: as published, one pass per step and cascade with one
/// point per cell.
enum class LpvPropagate { compute, layered };
constexpr std::array<std::string_view, 2> namesOf(LpvPropagate) { return {"compute", "layered"}; }

/// How irradiance at a surface follows from the propagated coefficients. `flux`: what the propagation kernel itself
/// would send through a face there. `published`: the light of one source half a cell away [Kaplanyan2010], 1.91 times
/// too much for light in transit.
enum class LpvLookup { flux, published };
constexpr std::array<std::string_view, 2> namesOf(LpvLookup) { return {"flux", "published"}; }

/// Whose surfels fill the geometry volume: those in the lights' maps, those seen by the camera, or both.
enum class LpvSurfels { rsm, camera, both };
constexpr std::array<std::string_view, 3> namesOf(LpvSurfels) { return {"rsm", "camera", "both"}; }

struct LpvSettings {
  /// Storage of the result, rounded to nearest; everything before it is in 32 bits. `full` (32-bit) is for tests.
  enum class Storage { half, full };
  /// Deviations of the published text and its public demo, each selectable; README.md has formula, source and effect.
  struct Deviations {
    bool fluxUnits = false;  ///< ignores texel area and cell size; lookup times 1.7 / pi
    bool sumCascades = false;  ///< all cascades are added instead of joined
    bool unjoined = false;  ///< cascades are blended without joining
    bool truncate = false;  ///< conversion to int instead of floor; grids snap to whole world units
    bool firstCell = false;  ///< bounds tested with > for >=: cell 0 of every axis stays dark
    bool sideDirections = false;  ///< side faces by component-wise product
    bool sideSolidAngle = false;  ///< 0.4234413544
    bool fourPiKernel = false;  ///< Omega / (4 pi) with an amplifier
    bool fewerSteps = false;  ///< one step fewer, and the injected grid is not in the sum
    bool blockFirstStep = false;  ///< the first step is blocked too
    bool surfelArea = false;  ///< perspective formula times N.L for an orthographic light; other lights keep true areas
    bool unwindowed = false;  ///< light travelling away from a surface counts as negative
    bool blockingDirection = false;  ///< potential evaluated in the direction of travel
    bool halfGrids = false;  ///< what leads to the result is kept in 16 bits too; filled and propagated by layered
                             ///< passes, as there alone textures hold it
    bool kernel() const { return sideDirections || sideSolidAngle || fourPiKernel || blockingDirection; }
    bool operator==(const Deviations&) const = default;
  };

  CascadeSettings cascades;
  LpvLookup lookup = LpvLookup::flux;
  LpvFill fill = LpvFill::layered;
  int tile = 4;  ///< with atomics: side of the square of texels that is added up before it goes to the grid; 1: an
                 ///< atomic a light, as published
  LpvPropagate propagate = LpvPropagate::compute;
  Deviations deviations;
  float amplifier = 1.0f;  ///< of the deviating kernel: 4 would conserve
  int iterations = 8;  ///< propagation steps; 0: only injected light
  bool blocking = true;  ///< geometry volume
  LpvSurfels surfels = LpvSurfels::rsm;
  bool mergeViews = false;  ///< several maps: the longer vector of a surfel seen twice counts; otherwise all are summed
  int bounces = 1;  ///< more than 1 need blocking, two iterations and maps with albedo
  bool shafts = false;  ///< light shafts in the scene's haze (light_shafts.hpp)
  int shaftSteps = 64;  ///< samples along a view ray
  bool glossy = false;  ///< reflection of the volume's light by glossy materials (glossy_lobes.hpp)
  int glossySteps = 64;  ///< cells along a reflected ray, at most
  float blendBand = 0.25f;  ///< fraction of a cascade's half extent over which it fades into the next
  int handOver = 0;  ///< steps after which a finer cascade takes light from the coarser one; 0: lpvHandOverStep()
  std::optional<float> lookupOffset;  ///< cells along the normal by which a point is moved before the lookup; not
                                      ///< set: the lookup's default
  Storage storage = Storage::half;
  /// The compute gather also runs bricks without light; the same bits, for tests and measurements.
  bool everyBrick = false;

  /// Deviations of the published lookup apply to that lookup only.
  LpvLookup lookupUsed() const { return deviations.fluxUnits || deviations.unwindowed ? LpvLookup::published : lookup; }
  /// In cells along the normal.
  float offset() const { return lookupOffset.value_or(lookupUsed() == LpvLookup::published ? 0.5f : 0.0f); }
  bool reflects() const { return bounces > 1; }
  /// Propagation steps that are run.
  int steps() const { return std::max(iterations - (deviations.fewerSteps ? 1 : 0), 0); }
  /// Whether any step is blocked; the first is not by default.
  bool isBlocked() const { return blocking && (steps() > 1 || (steps() == 1 && deviations.blockFirstStep)); }
  /// Whether cascades are joined; call it on resolved() settings.
  bool joins() const {
    return cascades.cascades > 1 && !deviations.sumCascades && !deviations.unjoined && handOver < steps();
  }
  /// With dependent settings filled in, passes and hand-over: 16-bit grids exist only as layered passes.
  LpvSettings resolved() const;
};

struct LpvInputs {
  std::vector<ReflectiveShadowMap::Outputs> rsms;  ///< one per light; all are added
  std::vector<Cascade> cascades;  ///< finest first, as many as in the settings
  float referenceIrradiance;  ///< E_ref > 0, of the order of the lights' irradiance; only scales stored values
  glm::vec3 lightPosition{0.0f};  ///< the sun's; only read by the deviation surfelArea
  std::vector<ReflectiveShadowMap::Outputs> views{};  ///< the camera's view, only for its surfels: flux is not read
};

/// Red, green and blue: 3D textures of SH coefficients c / (E_ref s^2), cascades stacked along z.
using LpvVolume = std::array<gl::Texture, 3>;

/// Steps after which light has spread as far in a grid as after `iterations` in the next finer one. Steps spread it by
/// a root mean square distance of about sqrt(1.33 n - 0.33) cells (reference: 1, 1.496, 2.216, 3.222 cells after 1, 2,
/// 4, 8).
int lpvHandOverStep(int iterations, double ratio);

}  // namespace lucerna
