// Cascaded light propagation volume [Kaplanyan2010] with the corrected kernel.
// See README.md in this folder for inputs, outputs, units, sources and measurements.
#pragma once

#include "base/named_values.hpp"
#include "gl/context.hpp"
#include "gl/pass.hpp"
#include "gl/program.hpp"
#include "lpv/cascades.hpp"
#include "rsm/reflective_shadow_map.hpp"
#include "shared/lpv.h"

#include <array>
#include <optional>
#include <string_view>

namespace lucerna {

/// How the grid is filled. `layered`: geometry shader and additive blending. `atomic`: float image atomics, an
/// extension. `fixed`: 32-bit integer image atomics, core OpenGL 4.3, the same bits every run.
enum class LpvFill { layered, atomic, fixed };
constexpr std::array<std::string_view, 3> namesOf(LpvFill) { return {"layered", "atomic", "fixed"}; }

/// `compute`: all cascades in one dispatch a step. `layered`: as published, one pass a step and cascade with a point a
/// cell. `slices`: the same pass with a triangle a slice instead.
enum class LpvPropagate { compute, layered, slices };
constexpr std::array<std::string_view, 3> namesOf(LpvPropagate) { return {"compute", "layered", "slices"}; }

/// How irradiance at a surface follows from the propagated coefficients. `flux`: what the propagation kernel itself
/// would send through a face there. `published`: the light of one source half a cell away [Kaplanyan2010], 1.91 times
/// too much for light in transit.
enum class LpvLookup { flux, published };
constexpr std::array<std::string_view, 2> namesOf(LpvLookup) { return {"flux", "published"}; }

/// How light gets from what is lit to what is looked up. `propagate`: through the grids' cells, step by step, as
/// published. The others to receivers, points of surfaces (receivers.hpp): `gather` from the lights' maps, one bounce;
/// `rays` along paths.
enum class LpvTransport { propagate, gather, rays };
constexpr std::array<std::string_view, 3> namesOf(LpvTransport) { return {"propagate", "gather", "rays"}; }

/// What light that is gathered passes through: everything, or everything but the voxels in which surfaces lie.
enum class LpvVisibility { none, voxels };
constexpr std::array<std::string_view, 2> namesOf(LpvVisibility) { return {"none", "voxels"}; }

/// Whose surfels fill the geometry volume: those that the lights' maps see, those that the camera sees, or both.
enum class LpvSurfels { rsm, camera, both };
constexpr std::array<std::string_view, 3> namesOf(LpvSurfels) { return {"rsm", "camera", "both"}; }

class LightPropagationVolume {
 public:
  /// Storage of the result, rounded to nearest; everything before it is in 32 bits. `full` (32-bit) is for tests.
  enum class Storage { half, full };
  /// Differences of the published text and its public demo, one by one; README.md has formula, source and effect.
  struct Deviations {
    bool fluxUnits = false;  ///< ignores texel area and cell size; lookup times 1.7 / pi
    bool sumCascades = false;  ///< all cascades are added, none is joined
    bool unjoined = false;  ///< cascades are blended as they are
    bool truncate = false;  ///< conversion to int instead of floor; grids snap to whole world units
    bool firstCell = false;  ///< bounds tested with > for >=: cell 0 of every axis stays dark
    bool sideDirections = false;  ///< side faces by component-wise product
    bool sideSolidAngle = false;  ///< 0.4234413544
    bool fourPiKernel = false;  ///< Omega / (4 pi) with an amplifier
    bool fewerSteps = false;  ///< one step fewer, and the injected grid is not in the sum
    bool blockFirstStep = false;  ///< the first step is blocked too
    bool surfelArea = false;  ///< perspective formula times N.L for an orthographic light; other lights keep true areas
    bool unwindowed = false;  ///< light that travels away from a surface counts negative
    bool blockingDirection = false;  ///< potential evaluated in the direction of travel
    bool halfGrids = false;  ///< what leads to the result is kept in 16 bits too; filled and propagated by layered
                             ///< passes, as there alone textures hold it
    bool kernel() const { return sideDirections || sideSolidAngle || fourPiKernel || blockingDirection; }
    bool operator==(const Deviations&) const = default;
  };
  static constexpr int kAllBounces = 0;
  struct Settings {
    CascadeSettings cascades;
    LpvTransport transport = LpvTransport::propagate;
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
    bool mergeViews = false;  ///< several maps: of a surfel seen twice the longer vector counts; else all are summed
    int bounces = 1;  ///< with propagate more than 1 need blocking, two iterations and maps with albedo; with rays
                      ///< kAllBounces too
    float blendBand = 0.25f;  ///< fraction of a cascade's half extent over which it fades into the next
    int handOver = 0;  ///< steps after which a finer cascade takes light from the coarser one; 0: handOverStep()
    std::optional<float> lookupOffset;  ///< cells along the normal by which a point is moved before the lookup; not
                                        ///< set: the lookup's default
    LpvVisibility visibility = LpvVisibility::voxels;  ///< of LpvTransport::gather
    int voxels = 256;  ///< the same: along the longest side of the scene
    int rays = 16;  ///< of LpvTransport::rays: paths per receiver and frame, 1, 2, 4 ... 64
    int leastRays = 64;  ///< the same: least paths of a receiver in its first frame
    int samples = 512;  ///< the same: paths of a receiver while light and geometry stand still
    /// Of receivers: by how much of itself the irradiance that is shown may change in a frame while the camera moves or
    /// paths are added; 0: by any.
    float mostChange = 0.004f;
    Storage storage = Storage::half;
    bool everyBrick =
        false;  ///< the compute gather also runs bricks without light; the same bits, for tests and measurements
  };
  /// Deviations of the published lookup are deviations of that one alone.
  static LpvLookup lookupOf(const Settings& settings) {
    return settings.deviations.fluxUnits || settings.deviations.unwindowed ? LpvLookup::published : settings.lookup;
  }
  /// Of grids in 16 bits there are layered passes alone.
  static Settings withItsPasses(Settings settings);
  /// In cells along the normal.
  static float offsetOf(const Settings& settings) {
    return settings.lookupOffset.value_or(lookupOf(settings) == LpvLookup::published ? 0.5f : 0.0f);
  }
  struct Inputs {
    std::vector<ReflectiveShadowMap::Outputs> rsms;  ///< one per light; all are added
    std::vector<Cascade> cascades;  ///< finest first, as many as in the settings
    float referenceIrradiance;  ///< E_ref > 0, of the order of the lights' irradiance; only scales stored values
    glm::vec3 lightPosition{0.0f};  ///< the sun's; only read by the deviation surfelArea
    std::vector<ReflectiveShadowMap::Outputs>
        views{};  ///< what the camera sees, only for its surfels: flux is not read
  };
  /// Red, green and blue: 3D textures of SH coefficients c / (E_ref s^2), cascades stacked along z.
  using Volume = std::array<gl::Texture, 3>;

  /// Flags of shaders/lpv/lookup.glsl, for the programs that include it.
  static gl::ShaderFlags lookupFlags(const Settings& settings);

  /// Steps after which light has spread as far in a grid as after `iterations` in the next finer one. Steps spread it
  /// by a root mean square distance of about sqrt(1.33 n - 0.33) cells (reference: 1, 1.496, 2.216, 3.222 cells after
  /// 1, 2, 4, 8).
  static int handOverStep(int iterations, double ratio);

  static bool isNeeded(const SceneNeeds& needs) { return ReflectiveShadowMap::isNeeded(needs); }

  LightPropagationVolume(gl::ProgramLibrary& programs, const gl::Capabilities& capabilities, const Settings& settings);

  // The frame's stages, in this order; none of them compiles or allocates.
  void place(const Inputs& inputs);  ///< uploads the cascades' placement
  void inject(const Inputs& inputs);  ///< clears, then adds every virtual point light
  void fillGeometryVolume(const Inputs& inputs);  ///< no effect without blocking
  void propagate();
  void join();  ///< joins the cascades; no effect with one

  /// Binds block 1 and units 4, 5, 6 for shaders/lpv/lookup.glsl.
  void bindForLookup() const;

  const Volume& injected() const { return injected_; }
  /// The sum G_0 + ... + G_iterations; after join() of all cascades together.
  const Volume& result() const { return steps_ > 0 ? result_ : injected_; }
  const gl::Texture* geometryVolume() const { return geometryVolume_ ? &*geometryVolume_ : nullptr; }
  const Settings& settings() const { return settings_; }
  std::size_t gpuBytes() const;

 private:
  bool reflects() const { return settings_.bounces > 1; }
  float fluxScale(const ReflectiveShadowMap::Outputs& rsm) const;
  void drawSurfels(const Inputs& inputs, const ReflectiveShadowMap::Outputs& map, const gl::Framebuffer& target);
  void drawAllSurfels(const std::vector<const ReflectiveShadowMap::Outputs*>& maps, const Inputs& inputs);
  void mergeView();
  void reflect(bool first);
  void propagateFrom(const Volume& source);
  void propagateByCompute(const Volume& source);
  void bindSums() const;
  void copyResult();
  void propagateLayered(const Volume& source);
  void fillByAtomics(const Inputs& inputs);
  void resolveCounts(const gl::BufferTexture& counts, const glm::ivec3& size, int channels, float fixedScale);
  bool countsSurfels(const std::vector<const ReflectiveShadowMap::Outputs*>& maps) const;
  void countSurfels(const std::vector<const ReflectiveShadowMap::Outputs*>& maps, const Inputs& inputs);

  Settings settings_;
  int steps_ = 0;  ///< propagation steps that are run
  int brickCount_ = 0;  ///< of all cascades, lit or not
  bool haveClearTexture_;
  bool fillsHalfVectors_ = false;  ///< atomics on four half floats at once
  bool frontIsInjected_ = false;  ///< with atomics the injected light is already in the first front
  const gl::Program* inject_ = nullptr;
  const gl::Program* resolve_ = nullptr;  ///< only with atomics on integers or half floats
  const gl::Program* countSurfels_ = nullptr;  ///< only with atomics on 32 bits
  const gl::Program* fillGeometryVolume_ = nullptr;
  const gl::Program* averageFaces_ = nullptr;  ///< from the texture
  const gl::Program* averageCountedFaces_ = nullptr;  ///< from the atomics' counts
  const gl::Program* mergeViews_ = nullptr;  ///< only with several views
  const gl::Program* reflect_ = nullptr;  ///< only with several bounces
  const gl::Program* begin_ = nullptr;  ///< only with compute, as averageFaces_ and the two of bricks
  const gl::Program* markBricks_ = nullptr;
  const gl::Program* listBricks_ = nullptr;
  const gl::Program* propagateFirst_ = nullptr;
  const gl::Program* propagateFurther_ = nullptr;  ///< blocked if blocking is on
  const gl::Program* finish_ = nullptr;  ///< only if nothing is joined
  const gl::Program* balance_ = nullptr;  ///< only with several cascades, as the two of join
  const gl::Program* join_ = nullptr;
  const gl::Program* joinCoarsest_ = nullptr;
  gl::Buffer constants_;
  gl::VertexArray noAttributes_;
  Volume counts_;  ///< target of atomics on half floats
  Volume injected_;
  Volume result_;  ///< read by the lookup
  Volume sum_, farSum_;  ///< of the layered pass, 32 bits: of the first steps and of those after the hand-over
  // Of the compute gather (lpv/propagate.comp). Three channels one after the other, as the three below.
  std::array<gl::BufferTexture, 2> fronts_;  ///< atomics count in the first
  gl::BufferTexture sums_, farSums_;  ///< as the layered pass' two; the second only with several cascades
  gl::BufferTexture potential_;  ///< the geometry volume as atomics count it
  gl::BufferTexture faces_;  ///< potential at the faces across x, y, z
  gl::Buffer bricks_;  ///< reached by light (lpv/bricks.glsl)
  gl::BufferTexture
      received_;  ///< light from the coarser cascades for the finer one; only with several cascades, as the two below
  gl::BufferTexture balances_;  ///< between one cascade and the next coarser, at half its resolution
  gl::BufferTexture balanced_;  ///< band 0 of the first steps' light as joined
  gl::Buffer resultTexels_;  ///< the result before it is copied to the textures
  std::array<Volume, 2> layeredFronts_;
  gl::Framebuffer injectTarget_;
  std::optional<gl::Texture> geometryVolume_;
  gl::Texture reflectance_;  ///< albedo A / s^2 of its surfels; only with several bounces
  gl::Texture viewPotential_, viewReflectance_;  ///< of one view, before it is merged
  gl::Framebuffer viewTarget_;
  Volume source_;  ///< injected light and all bounces so far, 32 bits
  gl::Framebuffer geometryTarget_;
  std::array<std::array<gl::Framebuffer, 2>, 2> layeredTargets_;  ///< front x (sum, far sum); only for the layered pass
};

/// Placement of the cascades and normalisation of stored values, as shaders read it.
shared::LpvConstants lpvConstants(const LightPropagationVolume::Settings& settings,
                                  const std::vector<Cascade>& cascades, float referenceIrradiance);

}  // namespace lucerna
