// Declaring the options of commands. CLI11 parses them. Its header and each option type cost seconds of compile time
// per source, so only command_line.cpp includes it.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace lucerna::demo {

/// The work of a command after parsing; returns its exit code.
using Work = std::function<int()>;

/// An option of a command; a handle.
class Option {
 public:
  explicit Option(CLI::Option& option) : option_(&option) {}

  // Constraints on the value; each call returns the option. Values that violate them are rejected while parsing.
  Option required() const;
  Option showDefault() const;  ///< help shows the variable's current value
  Option range(int least, int most) const;
  Option range(unsigned least, unsigned most) const;
  Option range(double least, double most) const;
  Option positive() const;
  Option oneOf(const std::vector<std::string>& words) const;
  Option notNegative() const;
  Option delimiter(char between) const;  ///< for a list in one argument
  Option values(int least, int most) const;  ///< number of values
  Option typeName(const std::string& name) const;
  Option scene() const;  ///< a scene file, or the name of a shipped scene, which becomes its file

  // Valid after parsing.
  std::string name() const;
  std::size_t count() const;  ///< number of times it was given
  std::string last() const;  ///< its last value; requires count() > 0

  CLI::Option& cli11() const { return *option_; }

 private:
  CLI::Option* option_;
};

/// A command, or the program itself; a handle.
class Command {
 public:
  explicit Command(CLI::App& app) : app_(&app) {}

  /// A positional argument ("SCENE") or an option ("-o,--output"), stored in `value`, which must outlive parsing.
  /// Types: the instantiations in command_line.cpp.
  template <class T>
  Option addOption(const std::string& names, T& value, const std::string& meaning) const;
  Option addFlag(const std::string& names, bool& value, const std::string& meaning) const;
  /// An option without a variable: Option::last() returns its value.
  Option addOption(const std::string& names, const std::string& meaning) const;
  Option find(const std::string& name) const;
  Command parent() const;  ///< the command that contains it
  void hide() const;  ///< from help, manual and completions
  std::string footer() const;  ///< shown in help below the options
  void setFooter(const std::string& text) const;

  CLI::App& cli11() const { return *app_; }

 private:
  CLI::App* app_;
};

/// Subcommands of a command, such as `lucerna bench error`.
class Subcommands {
 public:
  /// One of them is required on the command line.
  explicit Subcommands(Command command);

  /// Declare its options on the returned command.
  Command add(const std::string& name, const std::string& description, Work work);
  /// `declare` declares the options and returns the work.
  void add(const std::string& name, const std::string& description, const std::function<Work(Command)>& declare);
  /// The work of the subcommand that was given.
  Work work() const;

 private:
  Command command_;
  std::vector<std::pair<Command, Work>> commands_;
};

struct Program {
  const char *name, *version, *description;
};
/// Parses the command line and runs the named subcommand of those that `declare` adds. Returns the exit code; prints
/// any error as one line. Exit codes: 2 bad input, 3 missing capability, 1 internal error.
int runProgram(const Program& program, int argc, char** argv,
               const std::function<void(Command program, Subcommands& commands)>& declare);

}  // namespace lucerna::demo
