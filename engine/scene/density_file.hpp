// Density grids from files (no GL), for heterogeneous media. x runs fastest, then y, then z in every format:
//   .nrrd  NRRD, header and data in one file: "dimension: 3", "sizes", "type" uint8, uint16 or float,
//          "encoding: raw", "endian: little". Other header fields are ignored: the scene places the box in the world.
//   .ktx2  Khronos texture, one level, layer and face, not supercompressed: VK_FORMAT_R8_UNORM, R16_UNORM or
//          R32_SFLOAT.
//   .raw   only the values; the scene gives the size; 1, 2 or 4 bytes per value follow from the file's size.
// Integers become 0..1, floats are unchanged: finite, 0 or more.
#pragma once

#include "scene/medium.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>

namespace lucerna {

/// At most this many cells: 128 MiB of float, the smallest limit of a storage block among GL 4.3 drivers.
inline constexpr std::uint64_t kMaxDensityCells = std::uint64_t{1} << 25;

/// The box stays the unit cube. `size` is required for .raw; for other formats it must agree. Throws Error(badInput)
/// naming the file.
DensityGrid readDensityGrid(const std::filesystem::path& file, std::optional<glm::ivec3> size = std::nullopt);

}  // namespace lucerna
