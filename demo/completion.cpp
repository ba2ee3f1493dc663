// lucerna completion bash|zsh|fish: generates a completion script from the command line's own tree.
#include "base/error.hpp"
#include "shared/programs.hpp"
#include "shared/completions.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace lucerna::demo {

namespace {

std::string names(const CommandEntry& command) {
  std::string text;
  for (const auto& [name, description] : command.subcommands) text += (text.empty() ? "" : " ") + name;
  return text;
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size())
    text.replace(at, what.size(), by);
  return text;
}

/// In single quotes, for any of the three shells.
std::string inQuotes(const std::string& text) { return "'" + replaced(text, "'", "'\\''") + "'"; }

bool areKeys(const OptionEntry& option) {
  return std::any_of(option.values.begin(), option.values.end(), [](const std::string& v) { return v.back() == '='; });
}

/// Lists have one line per option: the description up to the first semicolon.
std::string shortened(const std::string& description) { return description.substr(0, description.find(';')); }

// ---------------------------------------------------------------------------------------------------- bash

const char* kBashFunctions = R"(
_lucerna() {
  # Bash divides words at '=': put them together again.
  local words=() word i
  for ((i = 1; i <= COMP_CWORD; ++i)); do
    word=${COMP_WORDS[i]}
    if ((${#words[@]})) && { [[ $word == '=' ]] || [[ ${words[-1]} == *= && -n $word ]]; }; then
      words[-1]+=$word
    else
      words+=("$word")
    fi
  done
  local current=${words[-1]} option='' prefix='' path='' position=0
  unset 'words[-1]'

  # The command, and which of its positional arguments is being typed.
  for word in "${words[@]}"; do
    if [[ -n $option ]]; then option=
    elif [[ -n $(_lucerna_commands "$path") && " $(_lucerna_commands "$path") " == *" $word "* ]]; then
      path+="${path:+ }$word"
    elif [[ $word == -*=* ]]; then :
    elif [[ $word == -* ]]; then [[ -n $(_lucerna_values "$path" "$word") ]] && option=$word
    else ((++position))
    fi
  done

  local values
  if [[ -n $option ]]; then values=$(_lucerna_values "$path" "$option")
  elif [[ $current == --*=* ]]; then
    prefix=${current%%=*}=
    values=$(_lucerna_values "$path" "${current%%=*}")
    current=${current#*=}
  elif [[ $current == -* ]]; then values=$(_lucerna_options "$path")
  elif [[ -n $(_lucerna_commands "$path") ]]; then values=$(_lucerna_commands "$path")
  else values=$(_lucerna_positional "$path" "$position")
  fi

  case $values in
    '' | '<none>') COMPREPLY=() ;;
    '<file>')
      compopt -o filenames 2>/dev/null
      mapfile -t COMPREPLY < <(compgen -f -- "$current")
      return ;;
    *) mapfile -t COMPREPLY < <(compgen -W "$values" -P "$prefix" -- "$current") ;;
  esac
  # Readline replaces what follows the last '='.
  if [[ $COMP_WORDBREAKS == *=* && $prefix$current == *=* ]]; then
    local known=$prefix$current
    known=${known%"${known##*=}"}
    COMPREPLY=("${COMPREPLY[@]#"$known"}")
  fi
  [[ ${#COMPREPLY[@]} -eq 1 && ${COMPREPLY[0]} == *= ]] && compopt -o nospace 2>/dev/null
  return 0
}
complete -F _lucerna lucerna
)";

/// What bash's functions return for a value: the values, or <file>, or <none> if there is nothing to offer.
std::string bashValues(const OptionEntry& option) {
  if (!option.values.empty()) return joined(option.values);
  return option.takesFile() ? "<file>" : "<none>";
}

std::string bash(const std::vector<CommandEntry>& commands) {
  std::string text =
      "# bash completion for lucerna; made by `lucerna completion bash`.\n\n# The commands of a "
      "command.\n_lucerna_commands() {\n  case $1 in\n";
  for (const CommandEntry& command : commands)
    if (!command.isLeaf())
      text += fmt::format("    {}) echo {} ;;\n", inQuotes(command.path), inQuotes(names(command)));
  text += "  esac\n}\n\n_lucerna_options() {\n  case $1 in\n";
  for (const CommandEntry& command : commands) {
    std::string all;
    for (const OptionEntry& option : command.options) all += (all.empty() ? "" : " ") + joined(option.names);
    text += fmt::format("    {}) echo {} ;;\n", inQuotes(command.path), inQuotes(all));
  }
  text += "  esac\n}\n\n# What may follow an option; nothing after a flag.\n_lucerna_values() {\n  case \"$1:$2\" in\n";
  for (const CommandEntry& command : commands)
    for (const OptionEntry& option : command.options) {
      if (!option.takesValue()) continue;
      std::string patterns;
      for (const std::string& name : option.names)
        patterns += (patterns.empty() ? "" : " | ") + inQuotes(command.path + ":" + name);
      text += fmt::format("    {}) echo {} ;;\n", patterns, inQuotes(bashValues(option)));
    }
  text +=
      "  esac\n}\n\n# What a positional argument may be, by its number from 0.\n_lucerna_positional() {\n  case "
      "\"$1:$2\" in\n";
  for (const CommandEntry& command : commands)
    for (std::size_t i = 0; i < command.positionals.size(); ++i)
      text += fmt::format("    {}{}) echo {} ;;\n", inQuotes(command.path + ":"),
                          command.positionals[i].repeats ? "*" : std::to_string(i),
                          inQuotes(bashValues(command.positionals[i])));
  return text + "  esac\n}\n" + kBashFunctions;
}

// ---------------------------------------------------------------------------------------------------- zsh

std::string zshAction(const OptionEntry& option) {
  if (option.takesFile()) return "_files";
  if (option.values.empty()) return " ";
  const std::string values = joined(option.values);
  if (areKeys(option)) return "{compadd -S \"\" -- " + values + "}";
  return "(" + values + ")";
}

/// Within an argument of _arguments, ':' and brackets end a part.
std::string zshText(const std::string& text) {
  return replaced(replaced(replaced(replaced(text, "\\", "\\\\"), ":", "\\:"), "[", "\\["), "]", "\\]");
}

std::string zshFunction(const std::string& path) {
  return "_lucerna" + (path.empty() ? "" : "_" + replaced(path, " ", "_"));
}

std::string zsh(const std::vector<CommandEntry>& commands) {
  std::string text = "#compdef lucerna\n# zsh completion for lucerna; made by `lucerna completion zsh`.\n";
  for (const CommandEntry& command : commands) {
    text += "\n" + zshFunction(command.path) + "() {\n";
    if (!command.isLeaf()) text += "  local context state line\n  typeset -A opt_args\n";
    text += "  _arguments";
    if (!command.isLeaf()) text += " -C";
    const auto add = [&](const std::string& argument) { text += fmt::format(" \\\n    {}", inQuotes(argument)); };
    for (const OptionEntry& option : command.options)
      for (const std::string& name : option.names) {
        const std::string value =
            option.takesValue() ? fmt::format(":{}:{}", zshText(option.type), zshAction(option)) : "";
        add(fmt::format("{}{}{}[{}]{}", option.repeats ? "*" : "", name,
                        value.empty()            ? ""
                        : name.starts_with("--") ? "="
                                                 : "+",
                        zshText(shortened(option.description)), value));
      }
    for (const OptionEntry& positional : command.positionals)
      add(fmt::format("{}{}:{}",
                      positional.repeats    ? "*:"
                      : positional.required ? ":"
                                            : "::",
                      zshText(positional.names.front()), zshAction(positional)));
    if (command.isLeaf()) {
      text += "\n}\n";
      continue;
    }
    text +=
        " \\\n    '1: :->command' \\\n    '*:: :->rest'\n  case $state in\n    command)\n      local -a commands=(\n";
    for (const auto& [name, description] : command.subcommands)
      text += "        " + inQuotes(name + ":" + zshText(shortened(description))) + "\n";
    text += "      )\n      _describe command commands ;;\n    rest)\n      case $line[1] in\n";
    for (const auto& [name, description] : command.subcommands)
      text += fmt::format("        {}) {} ;;\n", name,
                          zshFunction(command.path.empty() ? name : command.path + " " + name));
    text += "      esac ;;\n  esac\n}\n";
  }
  return text +
         "\nif [[ $zsh_eval_context[-1] == loadautofunc ]]; then _lucerna \"$@\"; else compdef _lucerna lucerna; fi\n";
}

// ---------------------------------------------------------------------------------------------------- fish

/// In single quotes fish knows two escapes.
std::string inFishQuotes(const std::string& text) {
  return "'" + replaced(replaced(text, "\\", "\\\\"), "'", "\\'") + "'";
}

std::string fish(const std::vector<CommandEntry>& commands) {
  std::string paths;
  for (const CommandEntry& command : commands)
    if (!command.path.empty()) paths += " " + inFishQuotes(" " + command.path);
  std::string text =
      "# fish completion for lucerna; made by `lucerna completion fish`.\n\n# Whether the words before the cursor are "
      "of this command.\nfunction __lucerna_at\n"
      "    set -l path ''\n    for word in (commandline -opc)[2..-1]\n        if contains -- \"$path $word\"" +
      paths +
      "\n            set path \"$path $word\"\n        end\n    end\n    test \"$path\" = \"$argv[1]\"\nend\n\n";
  for (const CommandEntry& command : commands) {
    const std::string start =
        "complete -c lucerna -n " +
        inFishQuotes("__lucerna_at " + inFishQuotes(command.path.empty() ? "" : " " + command.path));
    for (const auto& [name, description] : command.subcommands)
      text += start + " -f -a " + name + " -d " + inFishQuotes(shortened(description)) + "\n";
    for (const OptionEntry& option : command.options) {
      text += start;
      for (const std::string& name : option.names)
        text += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
      if (option.takesFile()) text += " -r -F";
      else if (option.takesValue()) text += " -x";
      if (!option.values.empty()) text += " -a " + inFishQuotes(joined(option.values));
      text += " -d " + inFishQuotes(shortened(option.description)) + "\n";
    }
    for (const OptionEntry& positional : command.positionals)
      if (!positional.values.empty())
        text += start + " -a " + inFishQuotes(joined(positional.values)) + " -d " +
                inFishQuotes(positional.names.front()) + "\n";
  }
  return text;
}

}  // namespace

Work addCompletion(Command app) {
  auto shell = std::make_shared<std::string>();
  addCompletions(app.addOption("SHELL", *shell, "bash, zsh or fish").required(), {"bash", "zsh", "fish"});
  app.setFooter("For the current shell only: source <(lucerna completion bash)");
  return [app, shell] {
    const std::vector<CommandEntry> commands = treeOfAll(app.parent());
    if (*shell == "bash") fmt::print("{}", bash(commands));
    else if (*shell == "zsh") fmt::print("{}", zsh(commands));
    else if (*shell == "fish") fmt::print("{}", fish(commands));
    else throwBadInput("SHELL {}: unknown; expected one of bash, zsh, fish", *shell);
    return 0;
  };
}

}  // namespace lucerna::demo
