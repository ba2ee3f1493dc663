// Work that is cut into units (frames, batches, rows), so that many machines make parts of it: `--part K/N --checkpoint
// PART` (no GL).
//
// A part is a folder. part.json says which command's units it holds; what else lies in it is the command's own, under
// names that no other part of the same work uses, or with the same bytes. `lucerna merge` puts parts together as one
// folder of the same kind, and the command with `--checkpoint FOLDER` takes from it what is there, makes what is
// missing, and writes its result: so the result of parts is that of one run.
#pragma once

#include "command_line.hpp"

#include <nlohmann/json.hpp>

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace lucerna::demo {

struct PartOptions {
  std::string part;  ///< "K/N": part K of N, from 0; empty: all
  std::string checkpoint;  ///< a folder; empty: none

  /// `units`: what the work is cut into, for --help.
  void declare(Command app, const std::string& units);
  bool isPart() const { return !part.empty(); }
  struct Range {
    std::size_t first = 0, last = 0;  ///< `last` not counted; empty where there are more parts than units
  };
  /// Throws Error(badInput) where --part is no K/N, or --checkpoint is missing beside it.
  Range rangeOf(std::size_t units) const;
};

/// The folder of a part or of all units. Without --checkpoint nothing is kept.
class PartFolder {
 public:
  using Json = nlohmann::ordered_json;

  /// `command`: such as "bench stability"; `identity`: a line with all that decides the units, except which there are.
  /// Makes the folder, or goes on with one of the same work and part. Throws Error(badInput) where it holds something
  /// else.
  PartFolder(const PartOptions& options, const std::string& command, const std::string& identity, std::size_t units);

  bool isPart() const { return isPart_; }
  std::size_t first() const { return range_.first; }
  std::size_t last() const { return range_.last; }
  std::size_t units() const { return units_; }
  /// FOLDER/NAME; only where something is kept.
  const std::optional<std::filesystem::path>& folder() const { return folder_; }

  /// A unit's result, if it is kept. One that is damaged is made again.
  std::optional<Json> load(std::size_t unit) const;
  void store(std::size_t unit, const Json& result) const;
  /// Where a unit's file lies: its number with this extension, such as ".png".
  std::filesystem::path file(std::size_t unit, const std::string& extension) const;
  /// All units of the part are there: without that, merge refuses it.
  void finish() const;

 private:
  Json description(bool done) const;

  std::optional<std::filesystem::path> folder_;
  std::string command_, identity_;
  std::size_t units_;
  PartOptions::Range range_;
  bool isPart_;
};

/// Whether a folder is one of these.
bool isPartFolder(const std::filesystem::path& folder);

/// The parts as one folder of all units, made anew at `whole`; returns its part.json. Throws Error(badInput) where
/// parts are of another command, scene or settings, are not finished, hold units that another one holds, or leave some
/// out, or where files of one name differ.
nlohmann::ordered_json mergeParts(std::vector<std::filesystem::path> parts, const std::filesystem::path& whole);

/// Copies what such a folder holds, but for part.json, into another one; files of one name must be the same.
void copyUnits(const std::filesystem::path& from, const std::filesystem::path& to);

}  // namespace lucerna::demo
