// A radiosity solution in the frame: solved or loaded once, then shown from anywhere in real time.
//
// Input: a Scene. Output, each frame: radiance of the patches into the bound target, irradiance interpolated between light vertices (never across an
// edge or to another material) and multiplied by the texture. Direct light is part of that, or is left to shadow rays in each pixel
// (shaders/render/direct_rays.glsl, which the caller binds): then patches give what is reflected alone.
#pragma once

#include "gl/context.hpp"
#include "gl/objects.hpp"
#include "gl/program.hpp"
#include "forward/gpu_scene.hpp"
#include "radiosity/solution.hpp"

#include <filesystem>
#include <string_view>

namespace lucerna {

class RadiosityView {
 public:
  enum class Mapping { tone, linear, logarithmic, falseColours };  ///< tone: the engine's own
  enum class Light { all, direct, indirect };                      ///< direct: of lamps, of the sky and of what patches emit
  enum class Direct { automatic, patches, pixels };                ///< pixels: shadow rays in each pixel instead of a value a patch; automatic: patches

  struct Settings {
    RadiositySolutionSettings solution;
    std::filesystem::path file;  ///< loaded where there is one, else saved here once solved; empty: neither
    Mapping mapping = Mapping::tone;
    float decades = 4.0f;        ///< that logarithmic and false colours span below 1 / exposure
    bool mesh = false;           ///< patch edges drawn over
    bool flat = false;           ///< patches as they are, not interpolated
    Light light = Light::all;
    Direct direct = Direct::automatic;
    int shadowRays = 32;         ///< a pixel, divided among the emissive triangles; not read here
  };

  /// Solves or loads; throws as solveScene and loadSolution do. scene() is drawn about `origin`.
  RadiosityView(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene, const Settings& settings, const glm::dvec3& origin = glm::dvec3(0.0));

  /// What GpuScene is to draw: the patches.
  const Scene& scene() const { return lit_; }
  const RadiositySolution& solution() const { return solution_; }
  /// Programs for GpuScene::draw with depth equal, and the display mapping (null: the engine's).
  SurfacePrograms loadPrograms(gl::ProgramLibrary& programs, const GpuScene& gpuScene) const;
  const gl::Program* loadMapping(gl::ProgramLibrary& programs) const;
  /// Whether pixels ask for direct light themselves: then DirectRays are to be bound too.
  bool takesDirectRays() const { return settings_.direct == Direct::pixels && settings_.light != Light::indirect; }
  void bind() const;  ///< before drawing
  std::size_t gpuBytes() const { return light_.bytes() + faces_.bytes(); }

 private:
  Settings settings_;
  RadiositySolution solution_;
  Scene lit_;
  gl::Buffer light_, faces_;
};

std::string_view nameOf(RadiosityView::Mapping mapping);
std::string_view nameOf(RadiosityView::Direct direct);

}  // namespace lucerna
