// Where a stopped run of the radiosity original goes on: a file beside its OUT, named OUT.sweep (no GL).
//
// OUT itself is the published format and holds whole sweeps only, in whole numbers. The checkpoint adds what it cannot: the sweep under way and,
// where values are floats, their fractions. It belongs to OUT as it was when it was written, or as it was about to be written: both digests are kept,
// so that a run killed between the two writes goes on as well. It is removed when the run has ended.
#pragma once

#include "radiosity/original_solver.hpp"

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace lucerna {

/// FNV-1a, 64 bits.
std::uint64_t digestOf(std::span<const std::uint8_t> bytes);

struct OriginalCheckpoint {
  std::uint64_t before = 0, after = 0;  ///< digests of OUT
  std::uint64_t settings = 0;           ///< of what decides the result: another setting or renderer cannot go on with it
  OriginalProgress progress;
};

std::uint64_t digestOf(const OriginalRadiosity::Settings& settings, double nearPlane, const std::string& renderer);

std::filesystem::path checkpointOf(const std::filesystem::path& out);

/// Written whole or not at all, and on the disk when it returns. Throws Error(badInput).
void writeCheckpoint(const std::filesystem::path& file, const OriginalCheckpoint& checkpoint);

/// Throws Error(badInput) naming the file when it is truncated, of another version, or damaged.
OriginalCheckpoint readCheckpoint(const std::filesystem::path& file);

}  // namespace lucerna
