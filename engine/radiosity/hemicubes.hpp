// Form factors by hemicubes on the GPU, many a submission.
//
// Input: a RadiosityMesh. Output: rows of the form factor matrix, F[i][j] = the share of what patch i sends out that reaches patch j's
// front = the part of its hemisphere that j fills, cosine-weighted. A rasteriser in compute shaders draws and adds them up without an item
// buffer to sort (shaders/radiosity/hemicube.glsl); it has no near plane, and on software renderers all their cores.
// Sources: shaders/REFERENCES.md [CohenGreenberg1985], [BaumRushmeierWinget1989], [Olano1997].
#pragma once

#include "gl/context.hpp"
#include "gl/objects.hpp"
#include "gl/program.hpp"
#include "radiosity/hemicube_map.hpp"
#include "radiosity/patches.hpp"

#include <cstdint>
#include <vector>

namespace lucerna {

struct HemicubeSettings {
  int resolution = 64;                     ///< pixels a side of the full face; even
  DeltaMap map = DeltaMap::exact;
  bool randomRoll = true;                  ///< each turned about its normal by a hash of seed and patch; else towards the first corner
  std::uint32_t seed = 1;
  int exactPixels = 12;                    ///< what covers at least as many pixels takes its closed form; 0: never
  float nearDistance = 3.0f;               ///< receivers are divided until (distance / size of a part) is this; 0: never
  int mostParts = 8;                       ///< a side of a receiver, at most
  std::size_t batchBytes = 0;              ///< of GPU memory a batch may take in one buffer; 0: what suits the renderer
};

/// Consecutive rows of the matrix; entries in the order of patches.
struct FormFactorRows {
  int first = 0;                       ///< patch of the first row
  std::vector<std::uint32_t> counts;   ///< entries a row
  std::vector<float> fronts, backs;    ///< shares of the hemisphere that show fronts and backs, by pixels; the rest is open
  std::vector<std::uint32_t> patches;  ///< of each entry
  std::vector<float> factors;          ///< of each entry, > 0
};

class Hemicubes {
 public:
  /// Throws Error(missingCapability) where the driver's storage blocks cannot hold the corners or one hemicube.
  Hemicubes(gl::ProgramLibrary& programs, const gl::Capabilities& capabilities, const RadiosityMesh& mesh, const HemicubeSettings& settings);

  int batchSize() const { return batch_; }
  int patchCount() const { return patchCount_; }
  /// 1 for patches that shine and are small beside the scene: factors to them are closed forms, however few pixels they cover.
  const std::vector<std::uint32_t>& smallSources() const { return smallSources_; }
  /// At most batchSize() rows from `first` on; waits for them.
  FormFactorRows rows(int first, int count);
  std::size_t gpuBytes() const;

 private:
  struct Frame {
    glm::vec4 origin, u, v, n;
  };
  Frame frameOf(int patch) const;

  const RadiosityMesh* mesh_;
  HemicubeSettings settings_;
  int patchCount_ = 0, batch_ = 0;
  std::vector<std::uint32_t> smallSources_;
  const gl::Program *depth_, *depthLarge_, *sum_, *sumLarge_, *exact_;
  gl::Buffer corners_, sources_, deltaFactors_, frames_, keys_, factors_, exactList_, shares_, largeList_;
};

}  // namespace lucerna
