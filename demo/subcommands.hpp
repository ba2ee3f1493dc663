// Commands that have commands of their own, such as `lucerna bench error`.
#pragma once

#include <CLI/CLI.hpp>

#include <functional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace lucerna::demo {

/// What a command does once the command line is parsed; its exit code.
using Work = std::function<int()>;

class Subcommands {
 public:
  /// One of them must be named.
  explicit Subcommands(CLI::App& app) : app_(&app) { app.require_subcommand(1); }

  /// Its options are declared on what is returned.
  CLI::App* add(const std::string& name, const std::string& description, Work work) {
    CLI::App* command = app_->add_subcommand(name, description);
    commands_.emplace_back(command, std::move(work));
    return command;
  }
  /// `declare` declares the options and returns the work.
  template <class Declare>
  requires std::is_invocable_r_v<Work, Declare, CLI::App&>
  void add(const std::string& name, const std::string& description, const Declare& declare) {
    CLI::App* command = app_->add_subcommand(name, description);
    commands_.emplace_back(command, declare(*command));
  }
  /// The work of the one that was named.
  Work work() const {
    return [commands = commands_] {
      for (const auto& [command, work] : commands)
        if (command->parsed()) return work();
      return 0;
    };
  }

 private:
  CLI::App* app_;
  std::vector<std::pair<CLI::App*, Work>> commands_;
};

}  // namespace lucerna::demo
