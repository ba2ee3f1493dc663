// The path tracer: unbiased light transport between surfaces, by a compute program (shaders/pathtracer/path.comp).
// See README.md in this folder for inputs, outputs, units, sources and measurements.
//
// Progressive: each submission is bounded to about Settings::submissionSeconds of work and adds to a film of means and
// variances in float that does not stall; samples can be added later, and the picture is the same however the work is
// divided.
#pragma once

#include "base/hash.hpp"
#include "base/image.hpp"
#include "base/pixel_filter.hpp"
#include "gl/context.hpp"
#include "gl/objects.hpp"
#include "gl/chunks.hpp"
#include "gl/program.hpp"
#include "gl/read_back.hpp"
#include "pathtracer/light_visibility.hpp"
#include "pathtracer/media.hpp"
#include "pathtracer/path_deviations.hpp"
#include "rays/path_scene.hpp"
#include "scene/features.hpp"
#include "scene/scene.hpp"
#include "scene/transport.hpp"

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace lucerna {

class PathTracer {
 public:
  static constexpr std::uint32_t kUnlimited = std::numeric_limits<std::uint32_t>::max();
  struct Settings {
    glm::ivec2 size{1280, 720};
    Transport transport = Transport::all;
    std::uint32_t bounces = kUnlimited;  ///< maximum number of scatterings; below kUnlimited longer paths are missing
    bool diffuseOnly =
        false;  ///< treat every scattering surface as Lambert with its `diffuse`, as forward shading does
    bool walks = true;  ///< no rays in dense media where no triangle is near; the picture is the same, bit by bit,
                        ///< but where lamps are sought through boundaries: there nothing walks
    std::size_t fewestOfHierarchy = kFewestOfHierarchy;  ///< lamps; 0: they are always drawn by power
    bool nextEvent = true;  ///< sample lights directly; without it only lights that rays can hit contribute
    PixelFilter filter = PixelFilter::box;  ///< of camera rays
    std::uint32_t seed = 0;  ///< pictures of different seeds are independent
    double submissionSeconds = 0.05;
    RayScene::Settings rays;
    PathDeviations deviations;
    /// Two independent pictures of half the samples each, as the denoiser needs them (denoiser.hpp); mean() is of both.
    /// Other random numbers than those of one picture, and a film of twice the size. With 256 pixels or more, standard
    /// errors are scaled to the halves' difference; else they are those of independent samples, which is too much.
    bool halves = false;
    /// The only pixel of the picture to trace, counted from the lower left; its light contributions are kept for
    /// takeInspected().
    std::optional<glm::ivec2> inspectedPixel;
  };
  /// Light that one path has brought to the inspected pixel.
  struct InspectedLight {
    glm::vec3 radiance;  ///< of that sample; the pixel's is the sum over samples divided by their number
    std::uint32_t sample, scatterings;
    std::uint32_t kind, number;  ///< PATH_LIGHT_* or PATH_INSPECTED_*; index of the triangle or of the table's light
    std::vector<glm::dvec3> places;  ///< the camera and the first scatterings, in the scene's coordinates
    glm::dvec3 end;  ///< the light's position; at infinity the direction to it
    bool infinite;
  };
  /// Statistics of the current film.
  struct Statistics {
    std::uint32_t fewestSamples = 0, mostSamples = 0;  ///< per pixel
    double samples = 0.0;  ///< mean over pixels
    glm::dvec3 mean{0.0};  ///< radiance
    glm::dvec3 meanError{0.0};  ///< standard error of `mean`
    double standardError = 0.0;  ///< per pixel, root mean square over pixels and channels; infinite before 2 samples
    double leakedPaths = 0.0;  ///< ended because found outside the scene yet inside a closed boundary, since setCamera
    double wrongCrossings =
        0.0;  ///< of boundaries left without having been entered, or entered too often: open or turned meshes
    double iterations = 0.0;  ///< of loops, in all lanes since setCamera: rays' nodes and triangles, steps in media:
                              ///< what time is spent on, whatever the clock
    double collisions = 0.0;  ///< in media, likewise
    double relativeError =
        0.0;  ///< standardError over the picture's mean, channels averaged; infinite for a black picture
  };

  /// Compiles and allocates. Throws Error(missingCapability) if the scene exceeds the driver's limits.
  PathTracer(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene, const Settings& settings);

  /// Sets the view and empties the film.
  void setCamera(const Camera& camera);
  /// The number of the film's first sample, for computing parts of a picture's samples. The film must be empty.
  void setFirstSample(std::uint32_t first);
  /// In place of the settings'. The film must be empty.
  void setSeed(std::uint32_t seed);
  /// A film of another size; setCamera() must follow.
  void resize(glm::ivec2 size);
  /// One submission towards `samples` samples in every pixel, waited for. False once all have them.
  bool advance(std::uint32_t samples) { return submit(samples, Passes::doubling); }
  /// Computes everything missing in as few passes as possible, without intermediate pictures.
  void record(std::uint32_t samples) {
    while (submit(samples, Passes::whole)) {}
  }

  /// Restores a tile in the middle of a pass to the pass's beginning. Unfinished paths are the long ones: a picture of
  /// the finished ones alone would be too dark. Call this when stopping between two calls of advance(), before reading
  /// the film.
  void dropUnfinishedPass();

  /// With Settings::inspectedPixel: all contributions of samples computed since the last call.
  std::vector<InspectedLight> takeInspected() { return std::exchange(inspected_, {}); }

  std::uint32_t samples() const { return done_; }  ///< in every pixel
  /// Whether no tile is in the middle of a pass, so that the film holds only whole passes.
  bool isBetweenTiles() const { return !tileBegun_; }
  /// The film's means, as shaders/pathtracer/film.frag reads them. With Settings::halves the second picture lies above
  /// the first.
  void bindMean(GLuint unit) const { filmMean_.bind(unit); }
  static int filterFlag(PixelFilter filter);  ///< PIXEL_FILTER of shaders/pathtracer/film_place.glsl
  void bindSquares(GLuint unit) const { filmM2_.bind(unit); }

  Image mean() const;  ///< radiance, linear, scene units, top row first; pixels without a sample are 0
  Image standardError() const;  ///< of each pixel's mean; 0 below 2 samples
  Statistics statistics() const;
  /// Whether a tile has samples that a checkpoint would keep.
  bool hasSamples() const { return done_ > 0 || tile_ > 0; }
  /// The film without the unfinished pass, and its identity; resume() continues from it to the same picture, bit by
  /// bit.
  std::vector<std::uint8_t> checkpoint() const;
  /// `name` is for messages. Throws Error(badInput) if the bytes are damaged or of another scene, view, size or
  /// setting.
  void resume(const std::vector<std::uint8_t>& bytes, const std::string& name);
  const Settings& settings() const { return settings_; }
  const SceneFeatures& features() const { return features_; }
  const PathScene& scene() const { return *scene_; }
  /// nullptr: nothing depends on it.
  const LightVisibility* lightVisibility() const { return lightVisibility_ ? &*lightVisibility_ : nullptr; }
  const shared::PathConstants& constants() const { return constants_; }  ///< of the view
  std::size_t gpuBytes() const;
  /// Number of lanes times iterations of the slowest lane, for the largest submission so far; `begun`: among those that
  /// began a tile, whose cost was unknown. A lane begins no segment after its share of iterations, so it exceeds the
  /// share by at most one segment.
  struct Submissions {
    std::uint64_t largest = 0, begun = 0;
  };
  Submissions submissions() const { return {largest_, largestBegun_}; }

 private:
  struct Pixel {
    glm::vec3 mean, m2;
    std::uint32_t samples;
  };
  std::vector<Pixel> readFilm() const;  ///< of the picture: both halves as one
  std::uint64_t identity() const;  ///< hash of everything that determines the picture
  gl::ShaderFlags flags() const;
  void allocateFilm();
  glm::ivec2 filmSize() const { return {settings_.size.x, settings_.size.y * (settings_.halves ? 2 : 1)}; }
  /// With flags that do not affect the picture but how it is computed.
  gl::ShaderFlags kernelFlags() const;
  std::size_t stateWords() const;  // of a lane in state_, in uvec4
  bool hasInteriors() const { return features_.dielectrics || features_.nullBoundaries || features_.media; }
  /// Whether paths walk through dense media in a kernel of their own.
  bool walks() const { return features_.denseMedia && !settings_.inspectedPixel; }
  /// Whether lanes take pixels from a queue; else each has its own.
  bool sharesPixels() const;
  std::size_t queueLength() const;
  /// Grids of distances to the nearest triangle for the boundaries of dense media.
  void addClearances(const Scene& scene);
  void markSplitMedia(const Scene& scene, PackedMedia& packed);
  enum class Passes { doubling, whole };
  bool submit(std::uint32_t samples, Passes passes);
  void dispatch(glm::ivec2 corner, glm::ivec2 size, std::uint32_t target);
  void tracePaths(int groups);  ///< of lanes
  void walkPaths(int groups);
  void seekWays(int groups);
  void bind(const gl::Program& program);
  /// Whether lamps are sought by way of refracting boundaries and mirrors.
  bool seeksByManifolds() const;
  /// Whether next-event estimation asks the sun at each surface, and draws only other lights.
  bool asksSunApart() const;
  /// Samples of lights that next-event estimation chooses one from.
  int lightCandidates() const;
  /// Whether it pays to know what light reaches where: lights of several kinds, and no body that light passes through.
  bool knowsVisibility() const;
  struct Tile {
    glm::ivec2 corner, size;
  };
  Tile tile() const;  ///< the current or next one
  int tileCount() const;  ///< of the film
  int tilesOfPicture() const;
  std::uint32_t samplesOfTile(std::uint32_t samples) const;  ///< its share of the picture's
  void readInspected();

  Settings settings_;
  SceneFeatures features_;
  std::optional<PathScene> scene_;  ///< always set after construction
  shared::PathConstants constants_{};
  const gl::Program *program_ = nullptr, *manifoldProgram_ = nullptr, *walkProgram_ = nullptr;
  /// Mirrors and smooth refracting bodies (path_tracer.cpp); empty: no lamp is sought by way of them.
  std::vector<glm::vec4> casters_;
  std::vector<glm::uvec4> casterParts_;
  std::optional<LightVisibility> lightVisibility_;
  PackedBoundaries boundaries_;
  bool touching_ = false;  ///< a boundary may coincide with or cross another surface
  int outerMedium_ = -1;
  InsideCounts cameraInside_{0u};
  float cameraIor_ = 1.0f;
  std::string cameraWarning_;  ///< to be reported before the first path
  bool splitsFlights_ = false;  ///< some media are marked to be split
  bool lampsOutside_ = false;  ///< none lies within a dielectric
  gl::Buffer media_, interiors_, grids_, densities_;
  gl::BufferTexture clearances_, casterTriangles_;
  double leakedPaths_ = 0.0, wrongCrossings_ = 0.0, iterationsTaken_ = 0.0, collisions_ = 0.0;
  gl::Buffer state_, constantsBuffer_;
  gl::Staging counters_{"path counters"};
  gl::Texture filmMean_, filmM2_, filmRest_;
  std::array<gl::Texture, 3> kept_;  ///< copy of the current tile before the pass
  int tileSide_ = 0;
  std::uint32_t mostIterations_;  ///< per lane and submission
  bool clearTexture_;
  Hash sceneHash_;

  // Progress: a pass gives every pixel passTarget_ samples, tile by tile.
  std::uint32_t done_ = 0, passTarget_ = 0;
  int tile_ = 0;
  bool tileBegun_ = false;
  std::uint32_t finished_ = 0;  ///< pixels of the tile
  unsigned turn_ = 0;  ///< of the queues
  gl::ChunkSize iterations_;  ///< per lane, in the next submission
  std::uint64_t largestBegun_ = 0, largest_ = 0;
  std::vector<InspectedLight> inspected_;
};

}  // namespace lucerna
