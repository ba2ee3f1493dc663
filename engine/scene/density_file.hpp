// Density grids from files (no GL), for heterogeneous media. x runs fastest, then y, then z in every format:
//   .nrrd  NRRD, header and data in one file: "dimension: 3", "sizes", "type" uint8, uint16 or float, "encoding: raw", "endian: little". Other
//          header fields are skipped: where the box lies in the world is the scene's to say.
//   .ktx2  Khronos texture, one level, layer and face, not supercompressed: VK_FORMAT_R8_UNORM, R16_UNORM or R32_SFLOAT.
//   .raw   nothing but the values; the scene gives the size, 1, 2 or 4 bytes a value are told by the file's size.
// Integers become 0..1, float is taken as it is: finite, 0 or more.
#pragma once

#include "scene/medium.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>

namespace lucerna {

/// At most this many cells: 128 MiB of float, the least that a GL 4.3 driver takes as one shader storage block.
inline constexpr std::uint64_t kMaxDensityCells = std::uint64_t{1} << 25;

/// The box stays the unit cube. `size` is needed for .raw; where another format has it too, it must agree. Throws Error(badInput) naming the file.
DensityGrid readDensityGrid(const std::filesystem::path& file, std::optional<glm::ivec3> size = std::nullopt);

}  // namespace lucerna
