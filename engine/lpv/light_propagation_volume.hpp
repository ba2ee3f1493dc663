// Cascaded light propagation volume [Kaplanyan2010] with the corrected kernel.
// See README.md in this folder for inputs, outputs, units, sources and measurements.
#pragma once

#include "gl/context.hpp"
#include "gl/pass.hpp"
#include "gl/program.hpp"
#include "lpv/cascades.hpp"
#include "rsm/reflective_shadow_map.hpp"
#include "shared/lpv.h"

#include <array>
#include <optional>

namespace lucerna {

class LightPropagationVolume {
 public:
  /// What the grids are kept in; `full` (32-bit) is for tests, which compare with the double-precision twin.
  enum class Storage { half, full };
  struct Settings {
    CascadeSettings cascades;
    int iterations = 8;         ///< propagation steps; 0: injected light alone
    bool blocking = true;       ///< geometry volume
    float blendBand = 0.25f;    ///< fraction of a cascade's half extent over which it fades into the next
    int handOver = 0;           ///< steps after which a finer cascade takes light from the coarser one; 0: handOverStep()
    float lookupOffset = 0.5f;  ///< cells along the normal by which a receiver is moved before the lookup
    Storage storage = Storage::half;
  };
  struct Inputs {
    ReflectiveShadowMap::Outputs rsm;
    std::vector<Cascade> cascades;  ///< finest first, as many as in the settings
    float referenceIrradiance;      ///< the sun's largest channel; only scales the stored values
  };
  /// Red, green and blue: 3D textures of SH coefficients c / (E_ref s^2), cascades stacked along z.
  using Volume = std::array<gl::Texture, 3>;

  /// After how many steps light has spread as far in a grid as after `iterations` in the next finer one. Steps spread it by
  /// a root mean square distance of about sqrt(1.33 n - 0.33) cells (reference: 1, 1.496, 2.216, 3.222 cells after 1, 2, 4, 8).
  static int handOverStep(int iterations, double ratio);

  static bool isNeeded(const SceneNeeds& needs) { return ReflectiveShadowMap::isNeeded(needs); }

  LightPropagationVolume(gl::ProgramLibrary& programs, const gl::Capabilities& capabilities, const Settings& settings);

  // The frame's stages, in this order; none of them compiles or allocates.
  void place(const Inputs& inputs);           ///< uploads where the cascades lie
  void inject(const Inputs& inputs);          ///< clears, then adds every virtual point light
  void fillGeometryVolume(const Inputs& inputs);  ///< no effect without blocking
  void propagate();
  void join();                                ///< cascades into one picture; no effect with one cascade

  /// Binds block 1 and units 4, 5, 6 for shaders/lpv/lookup.glsl.
  void bindForLookup() const;

  const Volume& injected() const { return injected_; }
  /// The sum G_0 + ... + G_iterations; after join() of all cascades together.
  const Volume& result() const { return settings_.iterations > 0 ? sum_ : injected_; }
  const gl::Texture* geometryVolume() const { return geometryVolume_ ? &*geometryVolume_ : nullptr; }
  const Settings& settings() const { return settings_; }
  std::size_t gpuBytes() const;

 private:
  Settings settings_;
  bool haveClearTexture_;
  const gl::Program* inject_ = nullptr;
  const gl::Program* fillGeometryVolume_ = nullptr;
  const gl::Program* averageFaces_ = nullptr;
  const gl::Program* propagateFirst_ = nullptr;    ///< unblocked, starts the sum
  const gl::Program* propagateFurther_ = nullptr;  ///< blocked where blocking is on
  const gl::Program* propagateFar_ = nullptr;      ///< starts the sum of the far-travelled light
  const gl::Program* coarsen_ = nullptr;           ///< only with several cascades, as join_
  const gl::Program* join_ = nullptr;
  gl::Buffer constants_;
  gl::VertexArray noAttributes_;
  Volume injected_;
  Volume sum_;        ///< of the first steps; after join() all light
  Volume farSum_;     ///< of the steps after the hand-over; only with several cascades
  gl::Texture brightness_;  ///< half resolution of all cascades but the coarsest
  std::array<Volume, 2> fronts_;
  gl::Framebuffer injectTarget_;
  std::optional<gl::Texture> geometryVolume_;
  std::optional<std::array<gl::Texture, 3>> faces_;  ///< potential at the faces across x, y, z
  gl::Framebuffer geometryTarget_;
};

}  // namespace lucerna
