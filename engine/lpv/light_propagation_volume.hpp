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
    float lookupOffset = 0.5f;  ///< cells along the normal by which a receiver is moved before the lookup
    Storage storage = Storage::half;
  };
  struct Inputs {
    std::vector<ReflectiveShadowMap::Outputs> rsms;  ///< one a light; all are added up
    std::vector<Cascade> cascades;  ///< finest first, as many as in the settings
    float referenceIrradiance;      ///< E_ref > 0, of the order of what the lights make; only scales the stored values
  };
  /// Red, green and blue: 3D textures of SH coefficients c / (E_ref s^2), cascades stacked along z.
  using Volume = std::array<gl::Texture, 3>;

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
  /// One point for each texel of each reflective shadow map, with the program in use.
  void drawTexels(const Inputs& inputs) const;

  Settings settings_;
  bool haveClearTexture_;
  const gl::Program* inject_ = nullptr;
  const gl::Program* fillGeometryVolume_ = nullptr;
  const gl::Program* averageFaces_ = nullptr;
  const gl::Program* propagateFirst_ = nullptr;    ///< unblocked, starts the sum
  const gl::Program* propagateFurther_ = nullptr;  ///< blocked where blocking is on
  const gl::Program* coarsen_ = nullptr;
  const gl::Program* compose_ = nullptr;
  gl::Buffer constants_;
  gl::VertexArray noAttributes_;
  Volume injected_, sum_;
  std::array<Volume, 2> fronts_;
  Volume coarsened_;  ///< half resolution of all cascades but the coarsest
  gl::Framebuffer injectTarget_;
  std::optional<gl::Texture> geometryVolume_;
  std::optional<std::array<gl::Texture, 3>> faces_;  ///< potential at the faces across x, y, z
  gl::Framebuffer geometryTarget_;
};

}  // namespace lucerna
