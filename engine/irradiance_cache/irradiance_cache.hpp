// Records: irradiance stored at surface points, in nested grids (engine/cascades), gathered from the lights' maps or
// found by paths.
//
// Irradiance along a surface is smooth even in a corner, where a field of radiance in space is not; so surface points
// are interpolated. Each cell of each cascade has six slots, one per axis and sign; a slot holds one real point that
// the camera has seen, or in the coarsest cascades would see if it turned, and whose normal points that way. Points are
// kept while the camera moves, and their paths accumulate while light and geometry are static.
//
// In: a scene (PathScene), cascades, the visible surfaces, the lights' maps for gather. Out: a layered 3D texture that
// shaders/irradiance_cache/lookup.glsl interpolates: irradiance in W per square scene unit. Light: emissive surfaces,
// the sky, and everything scattered `bounces` times; forward shading adds the direct light of sun and lamps. Errors:
// Error(missingCapability) if a texture or buffer exceeds the driver's limits. Source: README.md in this folder,
// section "Records".
#pragma once

#include "base/image.hpp"
#include "forward/visible_surfaces.hpp"
#include "gl/context.hpp"
#include "gl/pass.hpp"
#include "gl/program.hpp"
#include "forward/inspected_pixel.hpp"
#include "gl/read_back.hpp"
#include "cascades/cascades.hpp"
#include "irradiance_cache/light_gather.hpp"
#include "rays/path_scene.hpp"

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

namespace lucerna {

/// What paths have hit, kept while the scene moves (shaders/irradiance_cache/relight.comp).
struct KeptHits {
  const gl::Program *lamps, *trace, *relight;
  std::array<const gl::Program*, 2> retrace;  ///< the second: where surfaces have moved
  std::array<gl::Buffer, 2> hits;  ///< CACHE_HITS per record; the second: before the records were moved
  gl::Buffer traced;  ///< paths to be traced
  gl::BufferTexture light;  ///< of a record, for paths that end at it
  bool areValid = false;  ///< records marked CACHE_KEPT have hits of now
  bool allAnew = false;  ///< other light than that of lamps has changed
};

class IrradianceCache {
 public:
  using Light = CachedLight;
  struct Inputs {
    std::vector<Cascade> cascades;  ///< of placeCascadesAround
    Camera camera;  ///< of the visible surfaces, in the frame's coordinates
    glm::dvec2 offset;  ///< of what pixels show from their centres, in pixels
    glm::mat4 worldFromClip;  ///< the same
    const VisibleSurfaces& visible;
    /// For CacheTransport::gather, one per light; the same ones every frame. Read if `mapsAreNew`, and by new records.
    const std::vector<ReflectiveShadowMap::Outputs>& maps;
    bool mapsAreNew;
    bool fades;  ///< limit changes of the shown irradiance to Settings::mostChange; otherwise they apply at once
  };
  /// Counts of the last frame whose counts have arrived.
  struct Counts {
    std::uint64_t records = 0;  ///< in total
    std::uint64_t waiting = 0;  ///< visible ones that still lack paths
    std::uint64_t left = 0;  ///< records that did not fit
    std::uint64_t traced = 0;  ///< paths traced again when the scene last moved
    std::uint32_t frame = 0;  ///< as frame() counts them
  };

  /// `scene`: as loaded; `traced`: the same for rays. `origin`: of the frame's positions, in the scene's coordinates.
  /// wholePictures: as in RenderSettings.
  IrradianceCache(gl::ProgramLibrary& programs, const gl::Capabilities& capabilities, const Scene& scene,
                  const PathScene& traced, const glm::dvec3& origin, const IrradianceCacheSettings& settings,
                  Light light, bool wholePictures = false);

  static bool isNeeded(const SceneFeatures& features, const IrradianceCacheSettings& settings, Light light);

  /// One frame: finds records for visible surfaces, and traces Settings::rays paths for those that lack some,
  /// Settings::leastRays for new ones. rounds: the paths of this many frames at once.
  void update(const Inputs& inputs, int rounds = 1);
  /// Places records for surfaces of another view, which the next update lights with its own.
  void see(const Inputs& inputs);
  /// The view whose pixels' surfaces seenAt() of shaders/irradiance_cache/seen.glsl finds, until the next update.
  void show(const Inputs& inputs);
  /// The scene moves, and `traced` with it. The next update lights all records anew. Where the picture fades in they
  /// stay in their places, outside of `moved` boxes (where surfaces were or are now, among the frame's positions), and
  /// paths end at the light shown before; a whole picture is that of a new cache. lampsAlone: of all light, at most
  /// that of sun and lamps is another. False: other programs are needed.
  bool follow(const Scene& scene, const std::vector<Bounds>& moved, bool lampsAlone);
  /// Drops everything stored, as before the first frame.
  void forget();

  /// Binds blocks 1 and 6 and unit 5 for shaders/irradiance_cache/lookup.glsl.
  void bindForLookup() const;
  static gl::ShaderFlags lookupFlags(const IrradianceCacheSettings& settings);
  /// The same for the picture itself, which also shows the parts of split cells.
  gl::ShaderFlags pictureFlags() const;
  /// For programs that trace rays among the surfaces and look up records: their flags, and what they read.
  gl::ShaderFlags rayFlags(int lanes = 1, bool glossy = false) const;
  void bindForRays() const;

  /// The contribution of each record to the lookup at a point in the frame's coordinates, with the mesh's normal.
  /// Compiles and allocates.
  std::vector<InspectedPart> inspect(const glm::vec3& position, const glm::vec3& normal) const;

  /// A record as it is looked up.
  struct Shown {
    glm::vec3 position, normal;  ///< among the frame's positions; unit, on the side that is seen
    glm::vec3 irradiance;  ///< W per square scene unit
    float blendWeight;  ///< its weight, 0 to 1: a new one fades in
    glm::ivec3 cell;  ///< of its cascade, counted from the origin
    int cascade, face;
  };
  /// Those that have found light or darkness, as of the last update. Reads back: waits for the GPU.
  std::vector<Shown> shown() const;

  // Bounds: the light that would be shown without a part of a technique (engine/measure/README.md). For
  // the surfaces that the pixels of the last update's view show; W per square scene unit, 0 where there is none. They
  // compile, allocate, and wait for the GPU.
  /// As CacheTransport::gather finds it, at each pixel instead of in cells.
  Image gatheredAtPixels(const std::vector<ReflectiveShadowMap::Outputs>& maps) const;
  /// From the exact radiance in the middle of the cells around, as a light propagation volume reads it: two bands of
  /// spherical harmonics, trilinear. cascades: of such a volume; paths: per pixel, rounded up to CACHE_LANES.
  Image readFromCells(const CascadeSettings& settings, const std::vector<Cascade>& cascades, float blendBand,
                      int paths) const;

  void collect(bool wait = false);
  const Counts& counts() const { return counts_; }
  /// After the scene has moved: light of further bounces, which is a frame late for each, still changes.
  bool settles() const { return settles_; }
  const IrradianceCacheSettings& settings() const { return settings_; }
  std::uint32_t nextFrame() const { return sees_ ? frame_ : frame_ + 1; }  ///< the next update's number
  const gl::Texture& irradiance() const { return irradiance_; }
  /// Of a submission, at most: the list of records that it works on ends there (gl/chunks.hpp).
  double mostIterations() const;
  /// Frames after which no record of a view that stands still lacks paths, at the latest.
  std::size_t mostFrames() const;
  std::size_t gpuBytes() const;

 private:
  static constexpr double kIterationsOfPath = 256.0;  ///< of a lane, approximately (gl/chunks.hpp)
  // Words of shaders/irradiance_cache/work.glsl.
  static constexpr std::size_t kWanted = 3, kWaiting = 4, kFrame = 5, kLitGroups = 6, kTraced = 36, kClaimGroups = 39,
                               kWorkWords = 43;
  static std::array<GLuint, kWorkWords> noWork();  ///< groups of all dispatches: 0 by 1 by 1

  void beginToFollow(bool fades);
  bool stillSettles();
  struct Found {
    bool relights;  ///< all records are to be lit again by what their paths hit
    float mostChange;
  };
  Found findRecords(const Inputs& inputs);
  void place(const Inputs& inputs);
  void keep(const gl::Program& program);
  void findPrefetchPoints();
  void mark(const Inputs& inputs);
  void claim(const Inputs& inputs, const std::array<const gl::Program*, 2>& programs, gl::BufferTexture& slots);
  void split(const Inputs& inputs);
  void list(int target, bool countsFading = false, bool parts = true);
  void light(int target, bool parts = true);
  void gather(const Inputs& inputs);
  void store(float mostChange);
  void storeParts();
  void makeKept();
  void relight();
  void bindRecords() const;
  /// Dispatches a program over the listed records, part after part.
  static void dispatchListed(const gl::ComputePass& pass, const gl::Program& program, const gl::Buffer& work);
  Image atPixels(int rounds, const std::function<void(const gl::Buffer& work)>& light) const;

  IrradianceCacheSettings settings_;
  gl::ProgramLibrary* programs_;
  const PathScene& scene_;
  glm::dvec3 rayOrigin_;  ///< in the frame's coordinates
  float referenceIrradiance_;  ///< of the order of the irradiance; only scales stored values
  float typicalIrradiance_;  ///< the scene's now
  float blendBand_;
  bool clearTexture_, followed_ = false;  ///< the second: since the last update
  bool cached_;  ///< paths end at records
  bool settles_ = false;
  bool smooths_ = false;  ///< noise of records, in finished pictures
  std::uint32_t followedIn_ = 0;  ///< the frame in which the scene last moved
  std::size_t slots_, capacity_;
  std::uint32_t frame_ = 0;
  bool sees_ = false;  ///< since the last update
  std::vector<Cascade> cascades_;  ///< of the previous frame
  shared::PathConstants path_{};
  std::vector<glm::vec4> emissiveBodies_;  ///< of small_lamps.hpp; empty where no light is kept by cells
  gl::ShaderFlags rays_;  ///< of the programs that trace
  const gl::Program *mark_, *claim_, *keep_, *list_, *store_;
  const gl::Program* paths_ = nullptr;  ///< only for rays
  const gl::Program* prefetch_ = nullptr;  ///< only if Settings::prefetch
  std::optional<glm::vec3> prefetchedFrom_;  ///< position of the camera in the ray caster's coordinates
  std::unique_ptr<LightGather> gather_;  ///< only for gather
  gl::Buffer cascadeConstants_,
      cascadeConstantsBefore_;  ///< the second: the cascades to which irradiance_ belongs when an update begins
  const gl::Program* keepFollowed_ = nullptr;  ///< only in scenes that move
  std::vector<Bounds> moved_;
  gl::BufferTexture movedBoxes_;
  std::unique_ptr<KeptHits> kept_;  ///< only in scenes that move, once they have
  gl::Buffer constants_, pathConstants_, lit_, prefetchPoints_;
  std::array<gl::Buffer, 2> records_, work_;  ///< the second of each: before the cascades moved
  gl::Buffer claiming_;  ///< as many as the picture has pixels
  gl::BufferTexture slotTable_, keys_, seen_;
  /// Parts of split cells (shaders/irradiance_cache/parts.glsl).
  struct Split {
    const gl::Program* store;
    std::array<const gl::Program*, 2> find;  ///< marks and claims
    gl::BufferTexture tiles, slots, light;  ///< of a slot; of a part, as in slotTable_ and irradiance_
    std::size_t mostTiles;

    void clear() { tiles.clear(), slots.clear(), light.clear(); }
  };
  std::unique_ptr<Split> split_;  ///< only if Settings::split
  gl::Texture irradiance_;  ///< cacheIrradiance in GLSL: as looked up
  std::unique_ptr<gl::ReadBackRing> ring_;
  Counts counts_;
};

}  // namespace lucerna
