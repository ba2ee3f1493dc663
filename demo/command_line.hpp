// What commands declare their options on. CLI11 parses them: its header and each type of an option cost a source that
// sees them seconds, so that command_line.cpp alone does.
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

/// What a command does once the command line is parsed; its exit code.
using Work = std::function<int()>;

/// An option of a command; a handle.
class Option {
 public:
  explicit Option(CLI::Option& option) : option_(&option) {}

  // What it takes; each returns the option. Values out of it are refused while parsing.
  Option required() const;
  Option showDefault() const;  ///< help shows what the variable holds now
  Option range(int least, int most) const;
  Option range(unsigned least, unsigned most) const;
  Option range(double least, double most) const;
  Option positive() const;
  Option oneOf(const std::vector<std::string>& words) const;
  Option notNegative() const;
  Option delimiter(char between) const;  ///< of a list that is one argument
  Option values(int least, int most) const;  ///< how many
  Option typeName(const std::string& name) const;
  Option hidden() const;  ///< from help, manual and completions

  // After parsing.
  std::string name() const;
  std::size_t count() const;  ///< how often it was given
  std::string last() const;  ///< its last value; it was given

  CLI::Option& cli11() const { return *option_; }

 private:
  CLI::Option* option_;
};

/// A command, or the program itself; a handle.
class Command {
 public:
  explicit Command(CLI::App& app) : app_(&app) {}

  /// A positional argument ("SCENE") or an option ("-o,--output"), kept in `value`, which outlives parsing. Types: the
  /// instantiations in command_line.cpp.
  template <class T>
  Option addOption(const std::string& names, T& value, const std::string& meaning) const;
  Option addFlag(const std::string& names, bool& value, const std::string& meaning) const;
  /// One that is kept nowhere: Option::last() has it.
  Option addOption(const std::string& names, const std::string& meaning) const;
  /// One that is taken at once.
  Option addAction(const std::string& names, const std::function<void(double)>& take) const;
  Option find(const std::string& name) const;
  Command parent() const;  ///< the one whose command it is
  std::string footer() const;  ///< what help says below the options
  void setFooter(const std::string& text) const;

  CLI::App& cli11() const { return *app_; }

 private:
  CLI::App* app_;
};

/// Commands that a command has, such as `lucerna bench error`.
class Subcommands {
 public:
  /// One of them must be named.
  explicit Subcommands(Command command);

  /// Its options are declared on what is returned.
  Command add(const std::string& name, const std::string& description, Work work);
  /// `declare` declares the options and returns the work.
  void add(const std::string& name, const std::string& description, const std::function<Work(Command)>& declare);
  /// The work of the one that was named.
  Work work() const;

 private:
  Command command_;
  std::vector<std::pair<Command, Work>> commands_;
};

}  // namespace lucerna::demo
