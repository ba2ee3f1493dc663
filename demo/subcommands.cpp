#include "subcommands.hpp"

#include <CLI/CLI.hpp>

namespace lucerna::demo {

Subcommands::Subcommands(CLI::App& app) : app_(&app) { app.require_subcommand(1); }

CLI::App* Subcommands::add(const std::string& name, const std::string& description, Work work) {
  CLI::App* command = app_->add_subcommand(name, description);
  commands_.emplace_back(command, std::move(work));
  return command;
}

void Subcommands::add(const std::string& name, const std::string& description,
                      const std::function<Work(CLI::App&)>& declare) {
  CLI::App* command = app_->add_subcommand(name, description);
  commands_.emplace_back(command, declare(*command));
}

Work Subcommands::work() const {
  return [commands = commands_] {
    for (const auto& [command, work] : commands)
      if (command->parsed()) return work();
    return 0;
  };
}

}  // namespace lucerna::demo
