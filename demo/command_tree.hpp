// The command line as a list of commands, read from CLI11's own tree: what the manual page and the completions are made
// of.
#pragma once

#include "command_line.hpp"

#include <string>
#include <vector>

namespace lucerna::demo {

struct OptionEntry {
  std::vector<std::string> names;  ///< "-o", "--output"; of a positional its placeholder alone, such as "SCENE"
  std::string description;
  std::string type;  ///< TEXT, INT, UINT, FLOAT; empty for a flag
  std::string range;  ///< what is accepted, as CLI11 says it; empty: not limited
  std::string defaultValue;  ///< empty: none that is shown
  std::vector<std::string> values;  ///< what completions offer (offers.hpp)
  bool required = false, repeats = false;

  bool takesValue() const { return !type.empty(); }
  bool takesNumber() const { return takesValue() && type != "TEXT"; }
  /// A value that may be a file or a folder: text of which nothing else is known.
  bool takesFile() const { return type == "TEXT" && values.empty(); }
  bool operator==(const OptionEntry&) const = default;
};

struct CommandEntry {
  std::string path;  ///< "" for the program itself, else such as "bench error"
  std::string description, footer;
  std::vector<OptionEntry> options, positionals;
  std::vector<std::pair<std::string, std::string>> subcommands;  ///< name, description

  bool isLeaf() const { return subcommands.empty(); }
};

/// The program first, then its commands in their order, each followed by its own. What is in no group is hidden and
/// left out.
std::vector<CommandEntry> commandTree(Command program);

/// The subcommands that print it, as commands.hpp has the others.
Work addCompletion(Command app);
Work addManual(Command app);

}  // namespace lucerna::demo
