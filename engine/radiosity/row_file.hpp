// Rows of the form factor matrix on disk, appended submission by submission (no GL): what a killed run leaves for the next.
//
// A header (magic, version, fingerprint, patches), then blocks, each with its own length and checksum. A block that was cut short or damaged
// ends the file: it and what follows is computed again.
#pragma once

#include "radiosity/hemicubes.hpp"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>

namespace lucerna {

class RowFile {
 public:
  /// Opens or makes the file; calls `take` for each whole block there is, in order. Throws Error(badInput) when the file is no row file, of
  /// another version, or of another scene or settings (`fingerprint`); it is left as it was then.
  RowFile(const std::filesystem::path& file, std::uint64_t fingerprint, std::uint32_t patches, const std::function<void(const FormFactorRows&)>& take);
  ~RowFile();
  /// Of the file there is; nothing where it is none of ours or of another version.
  static std::optional<std::uint64_t> fingerprintOf(const std::filesystem::path& file);
  RowFile(const RowFile&) = delete;
  RowFile& operator=(const RowFile&) = delete;

  /// Rows must follow those before. On a full disk the file is cut back to its last whole block and Error(badInput) says so.
  void append(const FormFactorRows& rows);
  /// All rows that are in it, block by block, in order. Throws Error(badInput) where they no longer are.
  void forEach(const std::function<void(const FormFactorRows&)>& take);

 private:
  /// The block at the file's position, whose first row is `expected`, if it is whole; ends at `end`.
  std::optional<FormFactorRows> readBlock(std::uint32_t expected, std::uint64_t& end);

  std::filesystem::path file_;
  int descriptor_ = -1;
  std::uint32_t patches_ = 0;
  std::uint64_t end_ = 0;  ///< of the last whole block
};

}  // namespace lucerna
