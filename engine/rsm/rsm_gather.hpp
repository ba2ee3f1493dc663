// The gather over the reflective shadow map [Dachsbacher2005]: indirect irradiance at every visible surface point,
// gathered from samples of the map around the point's projection, with screen-space interpolation. Unoccluded, one
// bounce. See README.md in this folder for inputs, outputs, units, sources, deviations and measurements.
#pragma once

#include "base/named_values.hpp"
#include "forward/inspected_pixel.hpp"
#include "forward/visible_surfaces.hpp"
#include "gl/pass.hpp"
#include "gl/picture_chunks.hpp"
#include "gl/read_back.hpp"
#include "rsm/reflective_shadow_map.hpp"

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

namespace lucerna {

class RsmGather {
 public:
  enum class Weight { unbiased, published };  ///< xi1, or xi1^2 [Dachsbacher2005]
  enum class Reach { map, radius };  ///< half of the samples within the radius, half beyond; or all within
  enum class Rotation { none, noise };  ///< the same pattern for every pixel, or rotated by interleaved gradient noise
  enum class Near { none, clamp, disc, quad };  ///< replacement of 1/d^2 near a surfel; see README.md
  struct Settings {
    int samples = 400;
    float radius = 0.3f;  ///< r, fraction of the map's side
    Reach reach = Reach::map;
    Weight weight = Weight::unbiased;
    Rotation rotation = Rotation::none;
    Near nearField = Near::quad;
    float clampTexels = 1.0f;  ///< Near::clamp: minimum distance, in texel sides across the rays
    bool interpolate = true;
    int lowResolution = 4;  ///< pixels between low-resolution samples; 1 is the same as interpolate = false
    float fitNormal = 0.9f;  ///< minimum cosine between the normals of a pixel and a fitting sample
    float fitPlane = 0.25f;  ///< maximum distance from each other's tangent plane, in sample spacings at the pixel
    float fitDistance = 8.0f;  ///< maximum distance, in the same unit
    bool showRefused = false;  ///< paint rejected pixels red
    bool interpolates() const { return interpolate && lowResolution > 1; }
    float farthest() const;  ///< of a sample, fraction of the map's side
    double exponent() const;  ///< samples lie at farthest() xi1^exponent
  };
  using Light = ReflectiveShadowMap::Light;
  struct Map {
    ReflectiveShadowMap::Outputs rsm;
    const LightViews* views = nullptr;  ///< for a spot or omnidirectional light; the sun's are in the frame's block
  };
  struct Inputs {
    std::vector<Map> maps;  ///< one per light, at least one; their contributions are added
    glm::mat4 worldFromClip;  ///< the camera's
    float pixelWidth;  ///< width of a pixel, scene units across the view per unit of distance
  };
  /// Pixels, summed over `frames` whose counts have arrived.
  struct Counts {
    std::uint64_t frames = 0, pixels = 0, gathered = 0, refused = 0;  ///< pixels: those that show a surface
    std::uint64_t perFrame(std::uint64_t sum) const { return frames ? (sum + frames / 2) / frames : 0; }
    double saving() const { return pixels ? 1.0 - static_cast<double>(gathered) / static_cast<double>(pixels) : 0.0; }
  };
  static bool isNeeded(const SceneFeatures& features) { return ReflectiveShadowMap::isNeeded(features); }

  /// Gathers at the pixels of `visible`, which must outlive this and be drawn before. lights: whether there
  /// are maps of the sun, of spots and of omnidirectional lights. unmeasuredIterations: of a submission where a frame's
  /// gather is cut (gl/picture_chunks.hpp).
  RsmGather(gl::ProgramLibrary& programs, const std::array<bool, 3>& lights, const Settings& settings,
            const VisibleSurfaces& visible, double unmeasuredIterations = gl::kUnmeasuredIterations);
  void resize();  ///< to the current size of the visible surfaces

  // Call in this order; the first two only if settings().interpolates().
  void gatherLow(const Inputs& inputs);
  void interpolate(const Inputs& inputs);
  void gatherFull(const Inputs& inputs);

  /// Irradiance in W/m^2, RGBA32F of the picture's size; w: 0 no surface, 1 surface, 2 refused by interpolation.
  const gl::Texture& irradiance() const { return irradiance_; }
  void collect(bool wait = false);  ///< fetches counts that have arrived; wait: waits for all
  const Counts& counts() const { return counts_; }
  double largestIterations() const {
    return chunks_.largestIterations();
  }  ///< estimated, of the largest submission so far
  const Settings& settings() const { return settings_; }
  std::size_t gpuBytes() const;

  /// What the gather found for one pixel, counted from the lower left: one entry per sample and map, in the order of
  /// the maps; number.w is the map's index. For the last gathered frame, with the same inputs. Compiles and allocates.
  std::vector<InspectedPart> inspect(gl::ProgramLibrary& programs, const Inputs& inputs, glm::ivec2 pixel) const;

  // Shared by the passes and the tests' probe.
  /// (d sin 2 pi xi2, d cos 2 pi xi2, weight, 0), d = xi1^exponent: a Hammersley set, shifted on the torus by `shift`.
  /// With the exponent 1 the weight is xi1 or xi1^2.
  static std::vector<glm::vec4> pattern(int samples, Weight weight, const glm::dvec2& shift = glm::dvec2(0.0),
                                        double exponent = 1.0);
  static gl::ShaderFlags flags(const Settings& settings, Light light);
  /// adds: to the present content of the image.
  static void bindMap(const gl::Program& program, const Settings& settings, const Map& map, bool adds = false);

 private:
  void setFit(const gl::Program& program, const Inputs& inputs) const;
  void bindVisible(const gl::Program& program, const Inputs& inputs) const;

  Settings settings_;
  std::array<const gl::Program*, 3> low_{}, full_{};  ///< by kind of light
  const gl::Program* interpolate_ = nullptr;
  gl::Buffer pattern_, work_;
  const VisibleSurfaces* visible_;
  gl::Texture lowIrradiance_, irradiance_;
  gl::Texture refused_;  ///< 32 bits: a list of pixels, row by row
  std::unique_ptr<gl::ReadBackRing> ring_;
  Counts counts_;
  gl::PictureChunks chunks_;
};

constexpr std::array<std::string_view, 2> namesOf(RsmGather::Weight) { return {"unbiased", "published"}; }
constexpr std::array<std::string_view, 2> namesOf(RsmGather::Reach) { return {"map", "radius"}; }
constexpr std::array<std::string_view, 2> namesOf(RsmGather::Rotation) { return {"none", "noise"}; }
constexpr std::array<std::string_view, 4> namesOf(RsmGather::Near) { return {"none", "clamp", "disc", "quad"}; }

}  // namespace lucerna
