// The GL light propagation volume fed by hand-made reflective shadow maps and read back in the units of the CPU
// reference implementation.
#pragma once

#include "gl/context.hpp"
#include "gl/program.hpp"
#include "lpv/light_propagation_volume.hpp"
#include "support/lpv_reference.hpp"

#include <functional>
#include <span>
#include <vector>

namespace lucerna::test {

/// One texel of a reflective shadow map, as the three textures hold it.
struct RsmTexel {
  glm::vec4 position{0.0f};  ///< world; w = 1 where there is a surface
  glm::vec4 normal{0.0f};  ///< w = cosine to the light
  glm::vec3 flux{0.0f};
  glm::vec3 albedo{0.0f};  ///< for bounces
};

/// A reflective shadow map that no light has drawn.
class RsmTextures {
 public:
  RsmTextures(std::span<const RsmTexel> texels, double texelArea, gl::Format normalFormat = gl::Format::rgba32f);
  ReflectiveShadowMap::Outputs outputs() const {
    return {position_, normal_, flux_, texelArea_, largestFlux_, ReflectiveShadowMap::Light::sun, &albedo_};
  }

 private:
  gl::Texture position_, normal_, flux_, albedo_;
  float texelArea_;
  double largestFlux_ = 0.0;  ///< of the texels that carry finite light
};

/// The same texels as the reference implementation takes them; background is left out. Area: texelArea / max(cosine,
/// 1/20).
std::vector<reference::Vpl> vplsOf(std::span<const RsmTexel> texels, double texelArea);

reference::GridSpec gridOf(const Cascade& cascade, int cells);

/// All stages of a volume made for it; join() unless told otherwise.
LightPropagationVolume runVolume(gl::ProgramLibrary& programs, const gl::Capabilities& capabilities,
                                 const LpvSettings& settings, const LpvInputs& inputs, bool join = true);

/// One cascade of a volume that was read back, c = value * E_ref * s^2.
std::vector<reference::VolumeRgb> readVolume(const LpvVolume& volume, const LpvInputs& inputs);
/// One cascade each of the geometry volume; nothing is scaled there.
std::vector<reference::Volume> readGeometryVolume(const LightPropagationVolume& lpv, const LpvInputs& inputs);

/// A point and the unit normal of the surface there.
struct Probe {
  glm::vec3 position;
  glm::vec3 normal;
};
/// lpvIrradiance of shaders/lpv/lookup.glsl at the probes.
std::vector<glm::vec3> probeIrradiance(gl::ProgramLibrary& programs, const LightPropagationVolume& lpv,
                                       std::span<const Probe> probes);

/// Largest difference of a coefficient over the largest coefficient of `expected`: the error of a sum is set by its
/// largest terms, and a cell's small coefficients are differences of larger ones.
double relativeError(const reference::Volume& expected, const reference::Volume& actual);
double relativeError(const reference::VolumeRgb& expected, const reference::VolumeRgb& actual);
/// What that may be with 32-bit floats.
inline constexpr double kFullTolerance = 1e-5;

/// By how much the weights of linear filters may be off: 0 where the driver takes them to 32 bits; with the 8 bits of
/// most GPUs 1/512. Measured once.
double filterStep();
/// What that may do to a lookup of grids of these cells at p: `lookup` where each grid is moved by as many cells.
double offByFilters(const glm::dvec3& p, std::span<const double> cellSizes,
                    const std::function<double(const glm::dvec3&)>& lookup);

/// One cascade with its minimum in the origin.
std::vector<Cascade> unitCascade(int cells, double cellSize = 1.0);

/// Among the test's output.
void report(const char* what, double value);

}  // namespace lucerna::test
