// lucerna manual: generates the manual page lucerna(1) in roff from the command line's own tree; man(7) documents the
// requests.
#include "base/error.hpp"
#include "shared/programs.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <sstream>

namespace lucerna::demo {

namespace {

/// Escapes plain text for roff: no escapes, no requests at the beginning of a line, hyphens that can be searched for
/// and copied.
std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    const bool lineStart = result.empty() || result.back() == '\n';
    if (lineStart && (c == '.' || c == '\'')) result += "\\&";
    if (c == '\\') result += "\\e";
    else if (c == '-') result += "\\-";
    else if (c == '^') result += "\\(ha";
    else if (c == '~') result += "\\(ti";
    else if (c == '`') result += "\\(ga";
    else result += c;
  }
  return result;
}

std::string bold(const std::string& text) { return "\\fB" + escaped(text) + "\\fR"; }
std::string italic(const std::string& text) { return "\\fI" + escaped(text) + "\\fR"; }

/// A tagged paragraph: the tag is roff, the text is plain.
std::string tagged(const std::string& tag, const std::string& text) {
  return ".TP\n" + tag + "\n" + escaped(text) + "\n";
}

std::string optionText(const OptionEntry& option, bool positional) {
  std::string tag;
  for (const std::string& name : option.names)
    tag += (tag.empty() ? "" : ", ") + (positional ? italic(name) : bold(name));
  if (!positional && option.takesValue()) tag += " " + italic(option.type);
  std::string details;
  if (!option.range.empty()) details = option.range;
  if (!option.defaultValue.empty()) details += (details.empty() ? "" : "; ") + ("default " + option.defaultValue);
  return tagged(tag, option.description + (details.empty() ? "" : " (" + details + ")"));
}

std::string synopsis(const CommandEntry& command) {
  std::string text = bold("lucerna " + command.path);
  for (const OptionEntry& option : command.options)
    if (option.required) text += " " + bold(option.names.front()) + " " + italic(option.type);
  for (const OptionEntry& positional : command.positionals) {
    const std::string name = italic(positional.names.front()) + (positional.repeats ? "..." : "");
    text += " " + (positional.required ? name : "[" + name + "]");
  }
  return text + " [" + italic("OPTIONS") + "]";
}

/// A footer's lines: "  key   meaning", "* key   meaning" become tagged paragraphs, others paragraphs.
std::string footerText(const std::string& footer) {
  std::string text;
  std::istringstream lines(footer);
  for (std::string line; std::getline(lines, line);) {
    if (line.empty()) continue;
    const bool entry = line.starts_with("  ") || line.starts_with("* ");
    const auto end = entry ? line.find(' ', 2) : std::string::npos;
    if (end == std::string::npos) text += ".PP\n" + escaped(line) + "\n";
    else
      text += tagged((line[0] == '*' ? "* " : "") + bold(line.substr(2, end - 2)),
                     line.substr(line.find_first_not_of(' ', end)));
  }
  return text;
}

/// Options declared by CommonOptions, and --help: described once.
bool isCommon(const OptionEntry& option) {
  const std::string& name = option.names.back();
  return name == "--help" || name == "--host" || name == "--json" || name == "--quiet";
}

const char* kEnvironment[][2] = {
    {"LUCERNA_DATA",
     "The folder that holds shaders, assets and keyFrames. Without it: share/lucerna beside the executable, "
     "../share/lucerna, then lucerna "
     "in the folders of XDG_DATA_DIRS."},
    {"LUCERNA_SHADERS", "Another folder of shaders, for example while editing them."},
    {"LUCERNA_REFERENCES",
     "Where path-traced references are cached, and rows of an interrupted radiosity solution (default: lucerna in "
     "XDG_CACHE_HOME or ~/.cache)."},
    {"LUCERNA_DUMP_PROGRAMS",
     "A folder for the sources of all shader programs and their driver requirements, for validators and other "
     "compilers."},
    {"LUCERNA_FINISH_PASSES",
     "1: before every pass the program waits for the GPU and writes \"pass NAME\" to standard error; the last name is "
     "that of a pass that does not end."},
    {"LUCERNA_GL_MINIMA", "1: the driver's limits are treated as the minima that OpenGL 4.3 guarantees, for testing."},
    {"LUCERNA_VERBOSE", "If not empty: more messages on standard error."},
    {"DISPLAY, WAYLAND_DISPLAY", "If one of them is set, walk opens a window."},
};

const char* kExitCodes[][2] = {
    {"0", "Success."},
    {"1", "An internal error; of bench stability: a row failed; of check: something is wrong."},
    {"2", "Invalid input: a file, an option or a value."},
    {"3", "Something is missing on this machine: a driver, memory, a package, the data."},
    {"130, 143", "Interrupted by Ctrl-C, by SIGTERM; finished work is kept."},
};

std::string manual(Command program) {
  const std::vector<CommandEntry> commands = treeOfAll(program);
  // The date of the release rather than of the build: the same sources give the same page.
  std::string text = fmt::format(
      ".\\\" Made by `lucerna manual` from the command line's own tree.\n.TH LUCERNA 1 {} \"lucerna {}\" \"User "
      "Commands\"\n",
      LUCERNA_RELEASE_DATE, LUCERNA_VERSION);
  text += ".SH NAME\nlucerna \\- real\\-time global illumination, measured\n.SH SYNOPSIS\n.nf\n";
  for (const CommandEntry& command : commands)
    if (command.isLeaf()) text += synopsis(command) + "\n";
  text += ".fi\n.SH DESCRIPTION\n" +
          escaped(
              "Lucerna is an OpenGL 4.3 demo engine for real-time global illumination. It walks through a scene, "
              "renders pictures of it by light propagation volumes, "
              "reflective shadow maps, radiosity and path tracing, and measures each technique's time and error. No "
              "GPU is required: Mesa's software renderer is enough.") +
          "\n";
  text += ".SH OPTIONS OF EVERY COMMAND\n";
  const auto walk =
      std::find_if(commands.begin(), commands.end(), [](const CommandEntry& c) { return c.path == "walk"; });
  for (const OptionEntry& option : walk->options)
    if (isCommon(option)) text += optionText(option, false);
  text += ".SH COMMANDS\n";
  std::map<std::string, std::string> footers;  // printed once: text, and the command that has it
  for (const CommandEntry& command : commands) {
    if (!command.isLeaf()) continue;
    // Every command has --help at least.
    if (command.options.empty()) throw Error(ErrorKind::fault, fmt::format("lucerna {} has no options", command.path));
    text += ".SS \"lucerna " + escaped(command.path) + "\"\n" + escaped(command.description) + ".\n";
    for (const OptionEntry& positional : command.positionals) text += optionText(positional, true);
    for (const OptionEntry& option : command.options)
      if (!isCommon(option)) text += optionText(option, false);
    if (command.footer.empty()) continue;
    const auto [known, isNew] = footers.emplace(command.footer, command.path);
    text += isNew ? footerText(command.footer)
                  : ".PP\nSettings and deviations are those of " + bold("lucerna " + known->second) + ".\n";
  }
  text += ".SH ENVIRONMENT\n";
  for (const auto& [name, meaning] : kEnvironment) text += tagged(bold(name), meaning);
  text += ".SH EXIT STATUS\n";
  for (const auto& [code, meaning] : kExitCodes) text += tagged(bold(code), meaning);
  text +=
      ".SH FILES\n" + tagged(italic("share/lucerna/assets"), "Scenes that come with the program.") +
      tagged(italic("share/lucerna/shaders"), "The shaders; REFERENCES.md lists the published work they implement.") +
      tagged(italic("share/lucerna/keyFrames"), "Camera paths.");
  text += ".SH EXAMPLES\n.nf\n";
  for (const char* example :
       {"lucerna walk", "lucerna walk my_scene.obj --record out --frames 12 --size 640x360",
        "lucerna render my_scene.obj --technique path --spp 64 -o picture.exr", "lucerna bench error --out report"})
    text += escaped(example) + "\n";
  return text + ".fi\n";
}

}  // namespace

Work addManual(Command app) {
  return [app] {
    fmt::print("{}", manual(app.parent()));
    return 0;
  };
}

}  // namespace lucerna::demo
