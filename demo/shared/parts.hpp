// Work divided into units (frames, batches, rows), so that many machines compute parts of it: `--part K/N --checkpoint
// PART` (no GL).
//
// A part is a folder. part.json says which command's units it holds; all other content belongs to the command, under
// names that no other part of the same work uses, or with the same bytes. `lucerna merge` combines parts into one
// folder of the same kind. The command with `--checkpoint FOLDER` reads what is there, computes what is missing, and
// writes its result: so the result of parts equals that of one run.
#pragma once

#include "shared/command_line.hpp"

#include <nlohmann/json.hpp>

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace lucerna::demo {

struct PartOptions {
  std::string part;  ///< "K/N": part K of N, counted from 0; empty: all
  std::string checkpoint;  ///< a folder; empty: none

  /// `units`: name of the units of work, for --help.
  void declare(Command app, const std::string& units);
  bool isPart() const { return !part.empty(); }
  struct Range {
    std::size_t first = 0, last = 0;  ///< `last` is exclusive; empty if there are more parts than units
  };
  /// Throws Error(badInput) if --part is not K/N, or --checkpoint is missing next to it.
  Range rangeOf(std::size_t units) const;
};

/// The folder of a part or of all units. Without --checkpoint nothing is stored.
class PartFolder {
 public:
  using Json = nlohmann::ordered_json;

  /// `command`: for example "bench stability"; `identity`: one line with everything that determines the units, except
  /// their selection. Creates the folder, or continues one of the same work and part. Throws Error(badInput) if it
  /// holds something else.
  PartFolder(const PartOptions& options, const std::string& command, const std::string& identity, std::size_t units);

  bool isPart() const { return isPart_; }
  std::size_t first() const { return range_.first; }
  std::size_t last() const { return range_.last; }
  std::size_t units() const { return units_; }
  /// FOLDER/NAME; only if results are stored.
  const std::optional<std::filesystem::path>& folder() const { return folder_; }

  /// A unit's stored result, if any. A damaged one is recomputed.
  std::optional<Json> load(std::size_t unit) const;
  void store(std::size_t unit, const Json& result) const;
  /// The path of a unit's file: its number with this extension, such as ".png".
  std::filesystem::path file(std::size_t unit, const std::string& extension) const;
  /// Marks all units of the part as present: otherwise merge rejects it.
  void finish() const;

 private:
  Json description(bool done) const;

  std::optional<std::filesystem::path> folder_;
  std::string command_, identity_;
  std::size_t units_;
  PartOptions::Range range_;
  bool isPart_;
};

bool isPartFolder(const std::filesystem::path& folder);
/// Whether a folder is a part folder with all of its units.
bool isFinishedPart(const std::filesystem::path& folder);

/// Merges the parts into one new folder `whole` of all units; returns its part.json. Throws Error(badInput) if parts
/// differ in command, scene or settings, are unfinished, overlap or leave gaps, or if files of the same name differ.
nlohmann::ordered_json mergeParts(std::vector<std::filesystem::path> parts, const std::filesystem::path& whole);

/// Copies the content of such a folder, except part.json, into another one; files of the same name must be equal.
void copyUnits(const std::filesystem::path& from, const std::filesystem::path& to);

}  // namespace lucerna::demo
