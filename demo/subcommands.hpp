// Commands that have commands of their own, such as `lucerna bench error`.
#pragma once

#include "subcommands.hpp"

#include <functional>
#include <string>
#include <utility>
#include <vector>

// Only sources that declare options include <CLI/CLI.hpp>: it costs each of them four seconds.
namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace lucerna::demo {

/// What a command does once the command line is parsed; its exit code.
using Work = std::function<int()>;

class Subcommands {
 public:
  /// One of them must be named.
  explicit Subcommands(CLI::App& app);

  /// Its options are declared on what is returned.
  CLI::App* add(const std::string& name, const std::string& description, Work work);
  /// `declare` declares the options and returns the work.
  void add(const std::string& name, const std::string& description, const std::function<Work(CLI::App&)>& declare);
  /// The work of the one that was named.
  Work work() const;

 private:
  CLI::App* app_;
  std::vector<std::pair<CLI::App*, Work>> commands_;
};

}  // namespace lucerna::demo
