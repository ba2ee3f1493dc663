#include "command_line.hpp"

#include <CLI/CLI.hpp>

#include <cstdint>
#include <optional>

namespace lucerna::demo {

Option Option::required() const {
  option_->required();
  return *this;
}

Option Option::showDefault() const {
  option_->capture_default_str();
  return *this;
}

Option Option::range(int least, int most) const {
  option_->check(CLI::Range(least, most));
  return *this;
}

Option Option::range(unsigned least, unsigned most) const {
  option_->check(CLI::Range(least, most));
  return *this;
}

Option Option::range(double least, double most) const {
  option_->check(CLI::Range(least, most));
  return *this;
}

Option Option::positive() const {
  option_->check(CLI::PositiveNumber);
  return *this;
}

Option Option::oneOf(const std::vector<std::string>& words) const {
  option_->check(CLI::IsMember(words));
  return *this;
}

Option Option::notNegative() const {
  option_->check(CLI::NonNegativeNumber);
  return *this;
}

Option Option::delimiter(char between) const {
  option_->delimiter(between);
  return *this;
}

Option Option::values(int least, int most) const {
  option_->expected(least, most);
  return *this;
}

Option Option::typeName(const std::string& name) const {
  option_->type_name(name);
  return *this;
}

Option Option::hidden() const {
  option_->group("");
  return *this;
}

std::string Option::name() const { return option_->get_name(); }
std::size_t Option::count() const { return option_->count(); }
std::string Option::last() const { return option_->results().back(); }

template <class T>
Option Command::addOption(const std::string& names, T& value, const std::string& meaning) const {
  return Option(*app_->add_option(names, value, meaning));
}

template Option Command::addOption(const std::string&, int&, const std::string&) const;
template Option Command::addOption(const std::string&, unsigned&, const std::string&) const;
template Option Command::addOption(const std::string&, std::uint64_t&, const std::string&) const;
template Option Command::addOption(const std::string&, double&, const std::string&) const;
template Option Command::addOption(const std::string&, std::string&, const std::string&) const;
template Option Command::addOption(const std::string&, std::optional<int>&, const std::string&) const;
template Option Command::addOption(const std::string&, std::optional<unsigned>&, const std::string&) const;
template Option Command::addOption(const std::string&, std::optional<double>&, const std::string&) const;
template Option Command::addOption(const std::string&, std::vector<double>&, const std::string&) const;
template Option Command::addOption(const std::string&, std::vector<std::string>&, const std::string&) const;

Option Command::addFlag(const std::string& names, bool& value, const std::string& meaning) const {
  return Option(*app_->add_flag(names, value, meaning));
}

Option Command::addOption(const std::string& names, const std::string& meaning) const {
  return Option(*app_->add_option_function<std::string>(
      names, [](const std::string&) {}, meaning));
}

Option Command::addAction(const std::string& names, const std::function<void(double)>& take) const {
  return Option(*app_->add_option_function<double>(names, take));
}

Option Command::find(const std::string& name) const { return Option(*app_->get_option(name)); }
Command Command::parent() const { return Command(*app_->get_parent()); }
std::string Command::footer() const { return app_->get_footer(); }
void Command::setFooter(const std::string& text) const { app_->footer(text); }

Subcommands::Subcommands(Command command) : command_(command) { command_.cli11().require_subcommand(1); }

Command Subcommands::add(const std::string& name, const std::string& description, Work work) {
  const Command command(*command_.cli11().add_subcommand(name, description));
  commands_.emplace_back(command, std::move(work));
  return command;
}

void Subcommands::add(const std::string& name, const std::string& description,
                      const std::function<Work(Command)>& declare) {
  const Command command(*command_.cli11().add_subcommand(name, description));
  commands_.emplace_back(command, declare(command));
}

Work Subcommands::work() const {
  return [commands = commands_] {
    for (const auto& [command, work] : commands)
      if (command.cli11().parsed()) return work();
    return 0;
  };
}

}  // namespace lucerna::demo
