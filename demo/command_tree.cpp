#include "command_tree.hpp"

#include "offers.hpp"

#include <CLI/App.hpp>

namespace lucerna::demo {

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
  entry.values = offered(Option(option));
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

}  // namespace lucerna::demo
