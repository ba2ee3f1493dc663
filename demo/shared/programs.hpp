// Several programs of one house: `lucerna` starts the one beside it that has a command, as git does.
//
//   lucerna             walk, render, merge, cluster, radiosity, info, media, compare, completion, manual
//   lucerna-bench       bench, check, tune
//   lucerna-labs        lab, without museum and mystery
//   lucerna-originals   bench tables, bench pictures, lab museum, lab mystery
#pragma once

#include "shared/command_tree.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace lucerna::demo {

/// Becomes the program beside this one that has the command. Returns 0 if this one has it; otherwise that program is
/// missing: prints an error that names the target to build, and returns the exit code.
int startOther(int argc, char** argv);

/// For --help of `lucerna`.
std::string descriptionOf(const std::string& command);
/// Subcommands of a command that are another program's.
std::vector<std::string> subcommandsElsewhere(std::string_view command);
/// Declares a command of another program, for --help alone.
void addOther(Subcommands& commands, const std::string& name);

/// commandTree() with the commands of all other programs that are there.
std::vector<CommandEntry> treeOfAll(Command program);

/// The hidden command `tree` of the other programs: commandTree() as JSON.
void addTree(Subcommands& commands, Command program);

}  // namespace lucerna::demo
