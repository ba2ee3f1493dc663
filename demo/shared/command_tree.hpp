// The command line as a list of commands, read from CLI11's own tree; source of the manual page and the completions.
#pragma once

#include "shared/command_line.hpp"

#include <string>
#include <vector>

namespace lucerna::demo {

struct OptionEntry {
  std::vector<std::string> names;  ///< "-o", "--output"; for a positional only its placeholder, such as "SCENE"
  std::string description;
  std::string type;  ///< TEXT, INT, UINT, FLOAT; empty for a flag
  std::string range;  ///< accepted values, as described by CLI11; empty: any
  std::string defaultValue;  ///< empty: none shown
  std::vector<std::string> values;  ///< offered by completions (completions.hpp)
  bool required = false, repeats = false;

  bool takesValue() const { return !type.empty(); }
  bool takesNumber() const { return takesValue() && type != "TEXT"; }
  /// Whether the value may be a file or a folder: text about which nothing else is known.
  bool takesFile() const { return type == "TEXT" && values.empty(); }
  bool operator==(const OptionEntry&) const = default;
};

struct CommandEntry {
  std::string path;  ///< "" for the program itself, otherwise for example "bench error"
  std::string description, footer;
  std::vector<OptionEntry> options, positionals;
  std::vector<std::pair<std::string, std::string>> subcommands;  ///< name, description

  bool isLeaf() const { return subcommands.empty(); }
};

/// The program first, then its commands in order, each followed by its subcommands. Commands without a group are hidden
/// and left out.
std::vector<CommandEntry> commandTree(Command program);

/// The subcommand that prints completion scripts; declared like those in commands.hpp.
Work addCompletion(Command app);
Work addManual(Command app);

}  // namespace lucerna::demo
