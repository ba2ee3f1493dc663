// Form factors by hemicubes on the GPU, many per submission.
//
// Input: a RadiosityMesh. Output: rows of the form factor matrix, F[i][j] = the fraction of patch i's exitance that
// reaches patch j's front = the part of its hemisphere that j fills, cosine-weighted. Visibility comes from a
// rasteriser in compute shaders, from rays or from an item buffer (shaders/radiosity/hemicube.glsl); none of them has a
// near plane. Sources: shaders/REFERENCES.md [CohenGreenberg1985], [BaumRushmeierWinget1989], [Olano1997].
#pragma once

#include "gl/context.hpp"
#include "gl/objects.hpp"
#include "gl/pieces.hpp"
#include "gl/program.hpp"
#include "gl/read_back.hpp"
#include "radiosity/form_factor_rows.hpp"
#include "radiosity/hemicube_settings.hpp"
#include "radiosity/patches.hpp"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

namespace lucerna {

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
  int batchSize() const { return batch_; }
  int patchCount() const { return patchCount_; }
  /// 1 for emissive patches that are small compared with the scene: factors to them are closed forms, however few
  /// pixels they cover.
  const std::vector<std::uint32_t>& smallSources() const { return smallSources_; }
  /// Rows of `count` hemicubes from `first`, at most batchSize(); waits for them.
  FormFactorRows rows(int first, int count);
  /// Submissions so far, and the estimated turns of the largest (gl/pieces.hpp).
  double largestTurns() const { return pieces_.largestTurns(); }
  /// Rows first..end - 1, piece by piece: while the GPU draws one, another thread makes rows of the previous one and
  /// passes them to `take`, in order and never two at once. `goOn` is called on this thread after each piece, with the
  /// patches drawn so far; false stops.
  void stream(int first, int end, const std::function<void(const FormFactorRows&)>& take,
              const std::function<bool(int done)>& goOn = {});
  std::size_t gpuBytes() const;  ///< of the chosen method

 private:
  DrawnHemicubes draw(int first, int count, int roll);  ///< one submission; waits for it
  std::vector<DrawnHemicubes> drawRolls(int first, int count);  ///< one submission per roll
  int rolls() const { return settings_.randomRoll ? settings_.rolls : 1; }
  int pieceSize() const;
  struct Frame {
    glm::vec4 origin, u, v, n;
  };
  struct ItemBuffer {
    gl::Texture items, depth;
    gl::Framebuffer target;
    gl::VertexArray noAttributes;
    const gl::Program *draw, *sum;
  };
  bool listsKept() const { return settings_.visibility != HemicubeVisibility::raster; }
  Frame frameOf(int patch, int roll) const;
  void choose(gl::ProgramLibrary& programs, const gl::Capabilities& capabilities);
  bool seesAsRaster(gl::ProgramLibrary& programs, const gl::Capabilities& capabilities, Hemicubes& drawn) const;
  void begin(const gl::Program& program, int first, int count) const;

  const RadiosityMesh* mesh_;
  HemicubeSettings settings_;
  int patchCount_ = 0, batch_ = 0;
  std::vector<std::uint32_t> smallSources_;
  std::vector<Cost> costs_;
  const gl::Program *depth_ = nullptr, *depthLarge_ = nullptr, *sum_ = nullptr, *sumLarge_ = nullptr, *exact_ = nullptr,
                    *traceRays_ = nullptr;
  std::unique_ptr<RayScene> ownRays_;
  const RayScene* rays_ = nullptr;  ///< if pixels or small sources are seen by rays
  std::optional<ItemBuffer> itemBuffer_;
  gl::BufferTexture corners_, deltaFactors_, keys_;
  gl::Buffer sources_, frames_, factors_, keptList_, exactList_, largeList_;
  gl::Staging staging_{"hemicube results"};
  gl::PieceSize pieces_;  ///< hemicubes per submission
  int sourceCount_ = 0;
};

}  // namespace lucerna
