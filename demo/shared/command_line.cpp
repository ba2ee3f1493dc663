#include "shared/command_line.hpp"

#include "base/error.hpp"
#include "base/nearest_words.hpp"
#include "gl/context.hpp"
#include "shared/command_tree.hpp"
#include "shared/commands.hpp"
#include "shared/completions.hpp"
#include "shared/programs.hpp"
#include "shared/shipped_scenes.hpp"

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace lucerna::demo {

namespace {

/// CLI11's own message names the largest number of the type, in 309 digits. What is no number is refused elsewhere.
CLI::Validator numberThat(bool (*isRight)(double), const std::string& wrong, const std::string& name) {
  return {[isRight, wrong](std::string& text) {
            char* end = nullptr;
            const double value = std::strtod(text.c_str(), &end);
            return *end != '\0' || isRight(value) ? std::string() : fmt::format("{} {}", text, wrong);
          },
          name};
}

}  // namespace

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
  option_->check(numberThat([](double value) { return value > 0.0; }, "is not above 0", "POSITIVE"));
  return *this;
}

Option Option::oneOf(const std::vector<std::string>& words) const {
  option_->check(CLI::IsMember(words));
  return *this;
}

Option Option::notNegative() const {
  option_->check(numberThat([](double value) { return value >= 0.0; }, "is below 0", "NONNEGATIVE"));
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

Option Option::scene() const {
  option_->transform(sceneFileOf);
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

Option Command::find(const std::string& name) const { return Option(*app_->get_option(name)); }
Command Command::parent() const { return Command(*app_->get_parent()); }
void Command::hide() const { app_->group(""); }

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

// ---------------------------------------------------------------------------------------------------- completions

namespace {

constexpr const char* kName = "completions";

}  // namespace

Option addCompletions(Option option, const std::vector<std::string>& values) {
  try {
    option.cli11().get_validator(kName)->description(joined(values));
  } catch (const CLI::OptionNotFound&) {
    CLI::Validator validator([](std::string&) { return std::string(); }, joined(values), kName);
    option.cli11().check(validator.active(false));
  }
  return option;
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text.append(text.empty() ? "" : " ").append(word);
  return text;
}

std::vector<std::string> completionsOf(Option option) {
  std::vector<std::string> values;
  try {
    std::istringstream text(std::as_const(*option.cli11().get_validator(kName)).active(true).get_description());
    for (std::string value; text >> value;) values.push_back(value);
  } catch (const CLI::OptionNotFound&) {}
  return values;
}

// ---------------------------------------------------------------------------------------------------- the tree of
// commands

namespace {

OptionEntry entryOf(CLI::Option& option) {
  OptionEntry entry;
  if (option.get_positional()) {
    entry.names = {option.get_name(true)};
  } else {
    for (const std::string& name : option.get_snames()) entry.names.push_back("-" + name);
    for (const std::string& name : option.get_lnames()) entry.names.push_back("--" + name);
  }
  entry.description = option.get_description();
  entry.defaultValue = option.get_default_str();
  entry.required = option.get_required();
  entry.repeats = option.get_items_expected_max() > 1;
  entry.values = completionsOf(Option(option));
  if (option.get_items_expected_max() > 0) {
    // "INT:INT in [1 - 8]": the type, then the validators' description.
    const std::string text = option.get_type_name();
    const auto colon = text.find(':');
    entry.type = text.substr(0, colon);
    if (colon != std::string::npos) entry.range = text.substr(colon + 1);
  }
  return entry;
}

void append(std::vector<CommandEntry>& commands, CLI::App& app, const std::string& path) {
  CommandEntry command;
  command.path = path;
  command.description = app.get_description();
  command.footer = app.get_footer();
  for (CLI::Option* option : app.get_options([](const CLI::Option* o) { return !o->get_group().empty(); }))
    (option->get_positional() ? command.positionals : command.options).push_back(entryOf(*option));
  const std::vector<CLI::App*> children =
      app.get_subcommands([](const CLI::App* a) { return !a->get_group().empty(); });
  for (const CLI::App* child : children) command.subcommands.emplace_back(child->get_name(), child->get_description());
  commands.push_back(std::move(command));
  for (CLI::App* child : children)
    append(commands, *child, path.empty() ? child->get_name() : path + " " + child->get_name());
}

}  // namespace

std::vector<CommandEntry> commandTree(Command program) {
  std::vector<CommandEntry> commands;
  append(commands, program.cli11(), "");
  return commands;
}

// ---------------------------------------------------------------------------------------------------- a program

namespace {

/// Prints an error on one line, whatever files and options put into it; a driver's log of a program keeps its lines.
void printError(std::string message) {
  const bool keepsLines = message.starts_with("program ");
  for (char& c : message)
    if ((static_cast<unsigned char>(c) < ' ' && !(keepsLines && c == '\n')) || c == '\x7f') c = ' ';
  fmt::print(stderr, "lucerna: {}\n", message);
}

/// A full disk behind standard output is reported only here.
int flushed(int code) {
  if (std::fflush(stdout) == 0 && !std::ferror(stdout) && std::cout.flush()) return code;
  printError(fmt::format("cannot write to standard output: {}", std::strerror(errno)));
  return code != 0 ? code : static_cast<int>(ErrorKind::missingCapability);
}

/// Checks in one place: numbers in options that are not finite, or absurdly large, are rejected before a command sees
/// them.
void checkScenes(const CLI::App& app) {
  for (const CLI::Option* option : app.get_options())
    if (option->get_name() == "SCENE")
      for (const std::string& text : option->results()) checkSceneName(text);
  for (const CLI::App* command : app.get_subcommands()) checkScenes(*command);
}

void checkNumbers(const CLI::App& app) {
  constexpr double kMost = 1e12;
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_type_name().find("FLOAT") == std::string::npos) continue;
    for (const std::string& text : option->results()) {
      const double value = std::strtod(text.c_str(), nullptr);
      if (!(std::abs(value) <= kMost))
        throwBadInput("{}: '{}' is not a number from {:g} to {:g}", option->get_name(), text, -kMost, kMost);
    }
  }
  for (const CLI::App* command : app.get_subcommands()) checkNumbers(*command);
}

/// The command line's words, and those of LUCERNA_OPTIONS after them. "help COMMAND" is "COMMAND --help".
std::vector<std::string> argumentsOf(int argc, char** argv) {
  std::vector<std::string> arguments(argv + 1, argv + argc);
  if (!arguments.empty() && arguments[0] == "help") {
    arguments.erase(arguments.begin());
    arguments.emplace_back("--help");
    return arguments;
  }
  const char* more = std::getenv("LUCERNA_OPTIONS");
  if (!more || (!arguments.empty() && arguments[0] == "tree")) return arguments;
  std::istringstream words(more);
  for (std::string word; words >> word;) arguments.push_back(word);
  unsetenv("LUCERNA_OPTIONS");  // of this command, not of programs that it starts
  return arguments;
}

std::string nearestSubcommands(const CLI::App& app, const std::string& word) {
  std::vector<std::string> names = subcommandsElsewhere(app.get_name());
  for (const CLI::App* child : app.get_subcommands([](const CLI::App* a) { return !a->get_group().empty(); }))
    names.push_back(child->get_name());
  return nearestList(word, {names.begin(), names.end()}, 3);
}

std::string nearestOptions(const CLI::App& app, const std::string& word) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return nearestList(word.substr(0, word.find('=')), {names.begin(), names.end()}, 3);
}

/// Of "help": the words but the last, --help, must name a command.
void checkCommand(CLI::App& app, const std::vector<std::string>& words) {
  CLI::App* command = &app;
  for (std::size_t i = 0; i + 1 < words.size(); ++i) {
    const auto found = command->get_subcommands([&](const CLI::App* a) { return a->get_name() == words[i]; });
    if (found.empty())
      throwBadInput("help {}: no such command; nearest: {} (lucerna --help lists them)", words[i],
                    nearestSubcommands(*command, words[i]));
    command = found.front();
  }
}

}  // namespace

int runProgram(const Program& program, int argc, char** argv,
               const std::function<void(Command, Subcommands&)>& declare) {
  CLI::App app{program.description, program.name};
  app.set_version_flag("--version", program.version);
  Subcommands commands{Command(app)};
  declare(Command(app), commands);
  try {
    std::vector<std::string> arguments = argumentsOf(argc, argv);
    if (argc > 1 && argv[1] == std::string_view("help")) checkCommand(app, arguments);
    std::ranges::reverse(arguments);  // as CLI11 takes them
    app.parse(arguments);
  } catch (const Error& error) {
    printError(error.what());
    return error.exitCode();
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return flushed(app.exit(error));  // --help, --version
    std::string used;
    const CLI::App* deepest = &app;
    while (!deepest->get_subcommands().empty()) {
      deepest = deepest->get_subcommands()[0];
      used += deepest->get_name() + " ";
    }
    const std::vector<std::string> rest = deepest->remaining();
    if (deepest->get_require_subcommand_min() > 0 && !rest.empty() && rest[0][0] != '-') {
      printError(fmt::format("{}: no such subcommand; nearest: {} (lucerna {}--help lists them)", rest[0],
                             nearestSubcommands(*deepest, rest[0]), used));
      return static_cast<int>(ErrorKind::badInput);
    }
    if (const auto option = std::ranges::find_if(rest, [](const std::string& r) { return r.starts_with("--"); });
        option != rest.end()) {
      printError(fmt::format("{}: no such option; nearest: {} (lucerna {}--help lists them)", *option,
                             nearestOptions(*deepest, *option), used));
      return static_cast<int>(ErrorKind::badInput);
    }
    printError(fmt::format("{} (lucerna {}--help lists the options)", error.what(), used));
    return static_cast<int>(ErrorKind::badInput);
  }
  try {
    checkNumbers(app);
    checkScenes(app);
    const int code = flushed(commands.work()());
    const std::string errors = gl::takePendingErrors();
    if (errors.empty()) return code;
    printError(fmt::format("internal error, found at the end of the command: {}", errors));
    return static_cast<int>(ErrorKind::fault);
  } catch (const Error& error) {
    printError(error.what());
    return error.exitCode();
  } catch (const Stopped& stopped) {
    printError(stopped.what());
    return exitCode();
  } catch (const std::bad_alloc&) {
    printError("out of memory");
    return static_cast<int>(ErrorKind::missingCapability);
  } catch (const std::system_error& error) {
    // Errors of the system itself: standard output is full, threads cannot be created.
    printError(error.what());
    return static_cast<int>(ErrorKind::missingCapability);
  } catch (const std::exception& error) {
    printError(error.what());
    return static_cast<int>(ErrorKind::fault);
  }
  return 0;
}

}  // namespace lucerna::demo
