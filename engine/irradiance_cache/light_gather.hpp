// Light that records gather at once and without steps: one bounce of sun and lamps from their reflective shadow maps,
// the light of emissive surfaces, of the sky, and of further bounces.
//
// Maps and emissive surfaces are gathered through light trees. Sky and surfaces lit by earlier bounces are found by
// cosine-distributed rays through the scene's hierarchy. Light of earlier bounces is kept at points all over
// the scene (bounce_cache.hpp), so it depends on lights and geometry alone. Source: README.md in this folder, section
// "cache.transport=gather". Errors: Error(missingCapability) where a buffer exceeds the driver's limits.
#pragma once

#include "gl/context.hpp"
#include "gl/program.hpp"
#include "irradiance_cache/light_tree.hpp"
#include "irradiance_cache/settings.hpp"
#include "rays/path_scene.hpp"

#include <optional>
#include <vector>

namespace lucerna {

/// Stored light: everything but the direct light of sun and lamps. `direct`: of emissive surfaces and the sky,
/// scattered once.
enum class CachedLight { all, direct, indirect };

class LightGather {
 public:
  /// What there is to gather.
  struct Parts {
    bool maps = false;  ///< the lights' maps
    bool emission = false;  ///< emissive surfaces, in trees
    bool hemisphere = false;  ///< the rays: sky, emissive surfaces near by, further bounces
    bool bounces = false;  ///< points that keep the light of earlier bounces
    bool mapsOfBounces = false;  ///< they gather from the lights' maps too
    bool any() const { return maps || emission || hemisphere; }
  };
  static Parts partsOf(const SceneFeatures& features, const IrradianceCacheSettings& settings, CachedLight light);

  /// `scene`: as loaded. `origin`: of the frame's positions, in the scene's coordinates. common: flags of
  /// irradiance_cache/common.glsl.
  LightGather(gl::ProgramLibrary& programs, const gl::Capabilities& capabilities, const Scene& scene,
              const glm::dvec3& origin, const IrradianceCacheSettings& settings, CachedLight light,
              const PathScene& paths, const gl::ShaderFlags& common);

  /// Trees, and the light of earlier bounces, where the maps are new. Uniform blocks of the records must be bound;
  /// storage blocks 0 and 1 are left bound to others.
  void update(const std::vector<ReflectiveShadowMap::Outputs>& maps, bool mapsAreNew);
  /// For the records in storage block 0 whose numbers are in block 1, at most `most`: adds all their light, then they
  /// are final. `groups`: at `offset`, the indirect dispatch of each part of CACHE_PART_GROUPS of them.
  void gather(const std::vector<ReflectiveShadowMap::Outputs>& maps, const gl::Buffer& groups, std::size_t offset,
              std::size_t most);
  void forget() { stale_ = true; }
  /// Of a lane that gathers from a light tree, at most: nodes and texels that it visits, and its ray.
  static double iterationsOfLane(int depth, int top, int layers);
  float bounceCell() const { return bounceCell_; }  ///< scene units; 0 without points of bounces
  double mostIterations() const;  ///< of a submission, at most
  std::size_t gpuBytes() const;

 private:
  struct Targets;
  void makeEmission(gl::ProgramLibrary& programs, const gl::Capabilities& capabilities, const Scene& scene,
                    const glm::dvec3& origin);
  void makeBounces(gl::ProgramLibrary& programs, const gl::Capabilities& capabilities, const Scene& scene,
                   const glm::dvec3& origin, int bounceCells, const gl::ShaderFlags& around);
  void gatherTree(const gl::Program& program, const ReflectiveShadowMap::Outputs& map, const LightTree& tree,
                  const Targets& targets, bool last) const;
  void gatherHemisphere(const gl::Program& program, const Targets& targets, bool last) const;
  /// One bounce more from the points' light in light_[1 - to]; first: their own light.
  void bounce(int to, bool first);
  ReflectiveShadowMap::Outputs emissionMap() const;

  Parts parts_;
  bool ownEmission_ = false;  ///< records store the direct light of emissive surfaces
  GatherVisibility visibility_;
  gl::ProgramLibrary* programs_;
  const gl::Capabilities* capabilities_;
  const PathScene* paths_;
  bool stale_ = true;
  bool probed_ = false;  ///< points in gaps have been taken out
  const gl::Program *sun_ = nullptr, *lamp_ = nullptr, *emission_ = nullptr, *hemisphere_ = nullptr;
  std::vector<LightTree> trees_;  ///< one per map
  float rayEnd_ = 0.0f;  ///< by which a ray ends before a map's point, scene units
  // Emissive surfaces.
  gl::Texture emissionPosition_, emissionNormal_, emissionFlux_;
  std::optional<LightTree> emissionTree_;
  float areaOverDensity_ = 0.0f;
  // Points that keep the light of earlier bounces.
  std::size_t points_ = 0;
  int passes_ = 0;
  glm::vec3 bounceMinimum_{0.0f};  ///< in the coordinates of `paths_`
  float bounceCell_ = 0.0f;
  glm::ivec3 bounceCells_{1};
  const gl::Program *trace_ = nullptr, *bounce_ = nullptr;
  gl::Buffer pointData_, list_, links_;
  gl::BufferTexture slots_, places_, light_[2];  ///< irradiance at the points; the first holds the result
};

}  // namespace lucerna
