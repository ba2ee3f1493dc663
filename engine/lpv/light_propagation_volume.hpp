// Cascaded light propagation volume [Kaplanyan2010] with the corrected kernel.
// See README.md in this folder for inputs, outputs, units, sources and measurements.
#pragma once

#include "forward/inspected_pixel.hpp"
#include "gl/context.hpp"
#include "gl/program.hpp"
#include "lpv/cascade_join.hpp"
#include "lpv/geometry_volume.hpp"
#include "lpv/injection.hpp"
#include "lpv/propagation.hpp"
#include "lpv/settings.hpp"
#include "shared/cascades.h"

#include <optional>
#include <vector>

namespace lucerna {

class LightPropagationVolume {
 public:
  /// Flags of shaders/lpv/lookup.glsl, for the programs that include it.
  static gl::ShaderFlags lookupFlags(const LpvSettings& settings);
  static bool isNeeded(const SceneFeatures& features) { return ReflectiveShadowMap::isNeeded(features); }

  LightPropagationVolume(gl::ProgramLibrary& programs, const gl::Capabilities& capabilities,
                         const LpvSettings& settings);

  // The frame's stages, in this order; none of them compiles or allocates.
  void place(const LpvInputs& inputs);  ///< uploads the cascades' placement
  void inject(const LpvInputs& inputs);  ///< clears, then adds every virtual point light
  void fillGeometryVolume(const LpvInputs& inputs);  ///< no effect without blocking
  void propagate();
  void join();  ///< joins the cascades; no effect with one

  /// Binds block 1 and units 4, 5, 6 for shaders/lpv/lookup.glsl.
  void bindForLookup() const;

  /// The contribution of each cell to the lookup at a point in the frame's coordinates; outside the volume there is
  /// none. `normal`: for shading. Compiles and allocates.
  std::vector<InspectedPart> inspect(gl::ProgramLibrary& programs, const glm::vec3& position,
                                     const glm::vec3& normal) const;

  const LpvVolume& injected() const { return injection_.volume(); }
  /// The sum G_0 + ... + G_iterations; after join(), of all cascades together.
  const LpvVolume& result() const { return join_ ? join_->result() : injected(); }
  const gl::Texture* geometryVolume() const { return geometry_ ? &geometry_->potential() : nullptr; }
  const LpvSettings& settings() const { return settings_; }
  std::size_t gpuBytes() const;

 private:
  void propagateFrom(const LpvVolume& source);
  void bindSums() const;
  void reflect(bool first);

  LpvSettings settings_;  ///< resolved
  gl::Buffer constants_;
  LpvInjection injection_;
  std::optional<LpvGeometryVolume> geometry_;  ///< only with blocking
  std::optional<LpvComputePropagation> compute_;  ///< this or the next one, and the join; only if there are steps
  std::optional<LpvLayeredPropagation> layered_;
  std::optional<LpvCascadeJoin> join_;
  const gl::Program* reflect_ = nullptr;  ///< only with several bounces, like the next
  LpvVolume source_;  ///< injected light and all bounces so far, 32 bits
};

/// Placement of the cascades and normalisation of stored values, as shaders read it.
shared::CascadeConstants lpvConstants(const LpvSettings& settings, const std::vector<Cascade>& cascades,
                                      float referenceIrradiance);

}  // namespace lucerna
