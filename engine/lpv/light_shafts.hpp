// Light shafts: single scattering along the view ray in a homogeneous medium, for light of the sun and of the light
// propagation volume [LPV2015, 8: a wish of its author]. README.md lists what is left out.
//
// Input: a frame's depth, the sun's shadow map and the volume, bound as for shading. In place: the frame's radiance.
#pragma once

#include "gl/objects.hpp"
#include "gl/picture_chunks.hpp"
#include "gl/program.hpp"
#include "scene/scene.hpp"

#include <glm/glm.hpp>

#include <optional>

namespace lucerna {

/// A medium and its extent.
struct Haze {
  Medium medium;  ///< homogeneous
  Bounds box;  ///< of the meshes that bound it; exact for a box
};

/// The first homogeneous medium within a boundary that light passes straight through (Bsdf::none), otherwise the
/// camera's medium, which here ends at the scene's bounds; none without either. Pure.
std::optional<Haze> hazeOf(const Scene& scene);

class LightShafts {
 public:
  struct Settings {
    int steps = 64;  ///< along a view ray within the box
    int sunCascades = 0;  ///< shadow maps of the sun; 0: one for all
    bool sun = true, volume = true;  ///< whether its light scatters
    bool fullFloat = false;  ///< radiance in 32 bits, otherwise 16
    gl::ShaderFlags lookup;  ///< of the volume (LightPropagationVolume::lookupFlags); not read without it
    double unmeasuredIterations =
        gl::kUnmeasuredIterations;  ///< of a submission where a frame is cut (gl/picture_chunks.hpp)
  };
  LightShafts(gl::ProgramLibrary& programs, const Haze& haze, const Settings& settings);

  /// For every program with the flag HAZE: attenuates light that arrives through the medium.
  void bind() const;
  void record(const gl::Texture& radiance, const gl::Texture& depth, const glm::dmat4& clipFromWorld);
  double largestIterations() const {
    return chunks_.largestIterations();
  }  ///< estimated, of the largest submission so far
  std::size_t gpuBytes() const { return constants_.bytes(); }

 private:
  const gl::Program* program_;
  gl::Buffer constants_;
  int steps_;
  gl::PictureChunks chunks_;
};

}  // namespace lucerna
