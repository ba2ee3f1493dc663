// Checkpoint of a stopped run of the radiosity original: a file beside its OUT, named OUT.sweep (no GL).
//
// OUT has the published format: complete sweeps only, in whole numbers. The checkpoint adds the current sweep and,
// if values are floats, their fractions. It belongs to OUT as it was, or as it was about to be written: both digests
// are stored, so that a run killed between the two writes resumes too. It is removed at the end of the run.
#pragma once

#include "radiosity/original/solver.hpp"

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace lucerna {

/// FNV-1a, 64 bits.
std::uint64_t digestOf(std::span<const std::uint8_t> bytes);

struct OriginalCheckpoint {
  std::uint64_t before = 0, after = 0;  ///< digests of OUT
  std::uint64_t settings = 0;  ///< of everything that decides the result: other settings or renderers cannot resume it
  OriginalProgress progress;
};

std::uint64_t digestOf(const OriginalRadiosity::Settings& settings, double nearPlane, const std::string& renderer);

std::filesystem::path checkpointOf(const std::filesystem::path& out);

/// Written completely or not at all, and on disk on return. Throws Error(badInput).
void writeCheckpoint(const std::filesystem::path& file, const OriginalCheckpoint& checkpoint);

/// Throws Error(badInput) naming the file if it is truncated, of another version, or damaged.
OriginalCheckpoint readCheckpoint(const std::filesystem::path& file);

}  // namespace lucerna
