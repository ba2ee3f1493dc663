// A radiosity solution in the frame: solved or loaded once, then rendered from any viewpoint in real time.
//
// Input: a Scene. Output, each frame: radiance of the patches into the bound target; irradiance is interpolated between
// light vertices (never across an edge or to another material) and multiplied by the texture. Direct light is included,
// or left to shadow rays per pixel (shaders/radiosity/direct_rays.glsl, bound by the caller); then patches give only
// reflected light.
#pragma once

#include "base/named_values.hpp"
#include "forward/gpu_scene.hpp"
#include "gl/context.hpp"
#include "gl/objects.hpp"
#include "gl/program.hpp"
#include "radiosity/solution.hpp"

#include <filesystem>
#include <string_view>

namespace lucerna {

class RadiosityView {
 public:
  enum class Mapping { tone, linear, logarithmic, falseColours };  ///< tone: the engine's own
  enum class Light { all, direct, indirect };  ///< direct: of lamps, the sky and emissive patches
  enum class Direct {
    automatic,
    patches,
    pixels
  };  ///< pixels: shadow rays per pixel instead of a value per patch; automatic: patches

  struct Settings {
    RadiositySolutionSettings solution;
    std::filesystem::path file;  ///< loaded if it exists, else saved here once solved; empty: neither
    Mapping mapping = Mapping::tone;
    float decades = 4.0f;  ///< spanned by logarithmic and false colours below 1 / exposure
    bool mesh = false;  ///< draw patch edges on top
    bool flat = false;  ///< do not interpolate patches
    Light light = Light::all;
    Direct direct = Direct::automatic;
    int shadowRays = 32;  ///< per pixel, divided among the emissive triangles; used by the caller
  };

  /// Solves or loads; throws as solveScene and loadSolution do. scene() is drawn about `origin`. `before`: as for
  /// solveScene; nothing is loaded or saved then.
  RadiosityView(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene, const Settings& settings,
                const glm::dvec3& origin = glm::dvec3(0.0), const RadiositySolution* before = nullptr);

  /// The patches, for GpuScene.
  const Scene& scene() const { return lit_; }
  const RadiositySolution& solution() const { return solution_; }
  /// Programs for GpuScene::draw with depth equal, and the display mapping (null: the engine's). inspected: the variant
  /// with which one pixel records its terms.
  SurfacePrograms loadPrograms(gl::ProgramLibrary& programs, const GpuScene& gpuScene, bool inspected = false) const;
  const gl::Program* loadMapping(gl::ProgramLibrary& programs) const;
  /// Whether direct light is computed per pixel: then DirectRays must be bound too.
  bool takesDirectRays() const { return settings_.direct == Direct::pixels && settings_.light != Light::indirect; }
  void bind() const;  ///< before drawing
  std::size_t gpuBytes() const { return light_.bytes() + faces_.bytes(); }

 private:
  Settings settings_;
  RadiositySolution solution_;
  Scene lit_;
  gl::Buffer light_, faces_;
};

constexpr std::array<std::string_view, 4> namesOf(RadiosityView::Mapping) {
  return {"tone", "linear", "log", "false-colours"};
}
constexpr std::array<std::string_view, 3> namesOf(RadiosityView::Direct) { return {"auto", "patches", "pixels"}; }

}  // namespace lucerna
