// Form factors by hemicubes on the GPU, many per submission.
//
// Input: a RadiosityMesh. Output: rows of the form factor matrix, F[i][j] = the fraction of patch i's exitance that
// reaches patch j's front = the part of its hemisphere that j fills, cosine-weighted. Visibility comes from a
// rasteriser in compute shaders, from rays or from an item buffer (shaders/radiosity/hemicube.glsl); none of them has a
// near plane. Sources: shaders/REFERENCES.md [CohenGreenberg1985], [BaumRushmeierWinget1989], [Olano1997].
#pragma once

#include "gl/context.hpp"
#include "gl/program.hpp"
#include "gl/read_back.hpp"
#include "radiosity/form_factor_rows.hpp"
#include "radiosity/hemicube_settings.hpp"
#include "radiosity/patches.hpp"

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace lucerna {

class HemicubeBatch;
class HemicubeMethod;
class RayScene;

/// Raster or rays, whichever has less to do as counted from patches and pixels: the same answer on every machine,
/// unlike automatic's clock.
HemicubeVisibility visibilityByCount(const RadiosityMesh& mesh, int resolution);

class Hemicubes {
 public:
  /// Throws Error(missingCapability) if the driver's storage blocks cannot hold the corners or one hemicube. `rays`: of
  /// sceneOf(mesh), if the caller already has them; must outlive this.
  Hemicubes(gl::ProgramLibrary& programs, const gl::Capabilities& capabilities, const RadiosityMesh& mesh,
            const HemicubeSettings& settings, const RayScene* rays = nullptr);

  ~Hemicubes();
  Hemicubes(const Hemicubes&) = delete;
  Hemicubes& operator=(const Hemicubes&) = delete;

  /// The requested or chosen one; never automatic.
  HemicubeVisibility visibility() const { return settings_.visibility; }
  /// Measurements of automatic, milliseconds per hemicube; else empty.
  struct Cost {
    HemicubeVisibility visibility;
    double milliseconds;
  };
  const std::vector<Cost>& costs() const { return costs_; }
  int batchSize() const;
  int patchCount() const;
  /// 1 for emissive patches that are small compared with the scene: factors to them are closed forms, however few
  /// pixels they cover.
  const std::vector<std::uint32_t>& smallSources() const;
  /// Rows of `count` hemicubes from `first`, at most batchSize(); waits for them.
  FormFactorRows rows(int first, int count);
  /// Estimated loop iterations of the largest submission so far (gl/chunks.hpp).
  double largestIterations() const { return chunks_.largestIterations(); }
  /// Rows first..end - 1, chunk by chunk: while the GPU draws one, another thread makes rows of the previous one and
  /// passes them to `take`, in order and never two at once. `goOn` is called on this thread after each chunk, with the
  /// patches drawn so far; false stops.
  void stream(int first, int end, const std::function<void(const FormFactorRows&)>& take,
              const std::function<bool(int done)>& goOn = {});
  /// What each pixel of a patch's first hemicube sees, in the layout of shaders/radiosity/hemicube.glsl: the patch + 1,
  /// or 0. Not by raster, whose pixels name no patches.
  std::vector<std::uint32_t> seenByPixels(int patch);
  glm::dmat3 axesOf(int patch) const;  ///< of that hemicube: u, v and the patch's normal
  std::size_t gpuBytes() const;  ///< of the chosen method

 private:
  DrawnHemicubes draw(int first, int count, int roll);  ///< one submission; waits for it
  std::vector<DrawnHemicubes> drawRolls(int first, int count);  ///< one submission per roll
  int chunkSize() const;
  double millisecondsEach();
  double seenBy(int patch);
  static std::vector<Cost> measure(gl::ProgramLibrary& programs, const gl::Capabilities& capabilities,
                                   const RadiosityMesh& mesh, HemicubeSettings settings, const RayScene* rays);
  static bool seesAsRaster(gl::ProgramLibrary& programs, const gl::Capabilities& capabilities,
                           const RadiosityMesh& mesh, HemicubeSettings settings, const RayScene* rays,
                           Hemicubes& drawn);

  HemicubeSettings settings_;
  std::vector<Cost> costs_;
  std::unique_ptr<RayScene> ownRays_;
  const RayScene* rays_ = nullptr;  ///< if pixels or small sources are seen by rays
  std::unique_ptr<HemicubeBatch> batch_;
  std::unique_ptr<HemicubeMethod> method_;
  const gl::Program *sum_ = nullptr, *sumLarge_ = nullptr, *exact_ = nullptr;
  gl::Staging staging_{"hemicube results"};
  gl::ChunkSize chunks_;  ///< hemicubes per submission
};

}  // namespace lucerna
