// Form factors by hemicubes on the GPU, many per submission.
//
// Input: a RadiosityMesh. Output: rows of the form factor matrix, F[i][j] = the fraction of patch i's exitance that
// reaches patch j's front = the part of its hemisphere that j fills, cosine-weighted. Visibility comes from a
// rasteriser in compute shaders, from rays or from an item buffer (shaders/radiosity/hemicube.glsl); none of them has a
// near plane. Sources: shaders/REFERENCES.md [CohenGreenberg1985], [BaumRushmeierWinget1989], [Olano1997].
#pragma once

#include "base/named_values.hpp"
#include "gl/context.hpp"
#include "gl/objects.hpp"
#include "gl/pieces.hpp"
#include "gl/program.hpp"
#include "gl/read_back.hpp"
#include "radiosity/hemicube_map.hpp"
#include "radiosity/patches.hpp"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

namespace lucerna {

class RayScene;

/// Visibility of a hemicube's pixels. Rows differ by what lies within rounding of a pixel's centre, with the item
/// buffer within 1/512 pixel.
enum class HemicubeVisibility {
  automatic,  ///< measured at start, if the whole work takes longer than measuring
  itemBuffer,  ///< patches' numbers drawn to layers by the GPU's rasteriser
  raster,  ///< a rasteriser in compute shaders
  rays  ///< one through each pixel's centre
};
constexpr std::array<std::string_view, 4> namesOf(HemicubeVisibility) {
  return {"auto", "item-buffer", "raster", "rays"};
}

struct HemicubeSettings {
  HemicubeVisibility visibility = HemicubeVisibility::automatic;
  double worthMeasuring =
      10.0;  ///< automatic: if all hemicubes take raster this many seconds, the others are measured too
  int resolution = 64;  ///< pixels per side of the full face; even
  DeltaMap map = DeltaMap::exact;
  bool randomRoll = true;  ///< each turned about its normal by a hash of seed and patch; else towards the first corner
  std::uint32_t seed = 1;
  int rolls =
      1;  ///< hemicubes per patch, each turned differently, whose mean counts: antialiasing; 1 without randomRoll
  int exactPixels = 12;  ///< patches that cover this many pixels get their closed form; 0: never
  float nearDistance = 3.0f;  ///< receivers are divided until (distance / size of a part) is this; 0: never
  int mostParts = 8;  ///< most parts per side of a receiver
  double unmeasuredTurns =
      gl::kUnmeasuredTurns;  ///< of a first submission (gl/pieces.hpp); the rows are the same, bit by bit
  std::size_t batchBytes = 0;  ///< of GPU memory per batch and buffer; 0: automatic
};

/// Consecutive rows of the matrix; entries in the order of patches.
struct FormFactorRows {
  int first = 0;  ///< patch of the first row
  std::vector<std::uint32_t> counts;  ///< entries per row
  std::vector<float> fronts,
      backs;  ///< fractions of the hemisphere that show fronts and backs, by pixels; the rest is open
  std::vector<std::uint32_t> patches;  ///< of each entry
  std::vector<float> factors;  ///< of each entry, > 0
};

/// Results of a batch, read back.
struct DrawnHemicubes {
  int first = 0, count = 0, patchCount = 0;
  std::vector<float> factors;  ///< raster: hemicube-major, by pixels; below 0 if a back was seen
  std::vector<glm::uvec2> kept;  ///< rays, item buffer, which leave `factors` empty: hemicube * patchCount + patch,
                                 ///< unordered; bits of such a factor
  std::vector<glm::uvec2> exact;  ///< place in `factors` or `kept`; bits of the closed form, which replaces the pixels'
};
/// Without GL: another thread can do it while the next batch is drawn.
FormFactorRows rowsOf(DrawnHemicubes drawn);
/// The mean of hemicubes of the same patches, at least one.
FormFactorRows meanRowsOf(std::vector<DrawnHemicubes> drawn);

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
