// Rows of the form factor matrix on disk, appended per submission (no GL), so that a killed run can be resumed.
//
// A header (magic, version, fingerprint, patches), then blocks, each with its own length and checksum. A truncated or
// damaged block ends the file: it and everything after it is recomputed.
#pragma once

#include "radiosity/form_factor_rows.hpp"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>

namespace lucerna {

class RowFile {
 public:
  /// Opens or creates the file; calls `take` for each complete block, in order. Throws Error(badInput) if the file is
  /// not a row file, of another version, or of another scene or settings (`fingerprint`); it is then left unchanged.
  /// `first`: the file's first row; files with other values than 0 are parts, which joinRowFiles() joins.
  RowFile(const std::filesystem::path& file, std::uint64_t fingerprint, std::uint32_t patches,
          const std::function<void(const FormFactorRows&)>& take, std::uint32_t first = 0);
  ~RowFile();
  /// Of the existing file; empty if it is not a row file or of another version.
  static std::optional<std::uint64_t> fingerprintOf(const std::filesystem::path& file);
  RowFile(const RowFile&) = delete;
  RowFile& operator=(const RowFile&) = delete;

  static constexpr double kBytesPerEntry = 8.0;  ///< and 12 per row
  /// Rows must follow the previous ones. If the disk is full the file is cut back to its last complete block, and
  /// Error(badInput) is thrown.
  void append(const FormFactorRows& rows);
  /// Passes all rows to `take`, block by block, in order. Throws Error(badInput) if they are gone.
  void forEach(const std::function<void(const FormFactorRows&)>& take);

 private:
  /// The block at the file's position, whose first row is `expected`, if it is complete; sets `end` to its end.
  std::optional<FormFactorRows> readBlock(std::uint32_t expected, std::uint64_t& end);

  std::filesystem::path file_;
  int descriptor_ = -1;
  std::uint32_t patches_ = 0, first_ = 0;
  std::uint64_t end_ = 0;  ///< of the last complete block
};

/// Joins files of parts, given with their first rows and in that order, into one file `whole`, with the same bytes of
/// rows as from one run. Throws Error(badInput) if one belongs to another scene or settings, or if rows are missing or
/// repeated; nothing is then written.
void joinRowFiles(const std::vector<std::pair<std::uint32_t, std::filesystem::path>>& parts,
                  const std::filesystem::path& whole);

}  // namespace lucerna
