// Settings of hemicubes (no GL).
#pragma once

#include "base/named_values.hpp"
#include "gl/chunks.hpp"
#include "radiosity/hemicube_map.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace lucerna {

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
  /// Automatic: if all hemicubes take raster this many seconds, the others are measured too.
  double worthMeasuring = 10.0;
  int resolution = 64;  ///< pixels per side of the full face; even
  DeltaMap map = DeltaMap::exact;
  bool randomRoll = true;  ///< each turned about its normal by a hash of seed and patch; else towards the first corner
  std::uint32_t seed = 1;
  /// The hash is of the patch's corners instead of its number, which motion of other patches changes.
  bool rollsByPlace = false;
  /// Hemicubes per patch, each turned differently, whose mean counts: antialiasing. 1 without randomRoll.
  int rolls = 1;
  int exactPixels = 12;  ///< patches that cover this many pixels get their closed form; 0: never
  float nearDistance = 3.0f;  ///< receivers are divided until (distance / size of a part) is this; 0: never
  int mostParts = 8;  ///< most parts per side of a receiver
  /// Loop iterations of a first submission (gl/chunks.hpp). The rows are the same, bit by bit.
  double unmeasuredIterations = gl::kUnmeasuredIterations;
  double secondsOfChunk = 0.25;  ///< of a submission, after the first; the rows are the same, bit by bit
  std::size_t batchBytes = 0;  ///< of GPU memory per batch and buffer; 0: automatic
};

}  // namespace lucerna
