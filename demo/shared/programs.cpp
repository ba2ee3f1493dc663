#include "shared/programs.hpp"

#include "base/error.hpp"
#include "shared/shell.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string_view>

namespace lucerna::demo {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(OptionEntry, names, description, type, range, defaultValue, values, required,
                                   repeats)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(CommandEntry, path, description, footer, options, positionals, subcommands)

namespace {

namespace fs = std::filesystem;

struct Other {
  std::string_view command, subcommand;  ///< subcommand empty: all that are not listed
  const char* program;
  const char* description;  ///< for --help; null: of a subcommand
};
constexpr std::array kOthers{
    Other{"bench", "tables", "lucerna-originals", nullptr},
    Other{"bench", "pictures", "lucerna-originals", nullptr},
    Other{"lab", "museum", "lucerna-originals", nullptr},
    Other{"lab", "mystery", "lucerna-originals", nullptr},
    Other{"check", "", "lucerna-bench",
          "How this machine's GPU and driver do: right pictures, hangs, times; a page for a bug report"},
    Other{"bench", "", "lucerna-bench",
          "Measure: error over time, stability, unneeded features; reproduce published tables and pictures"},
    Other{"tune", "", "lucerna-bench",
          "Measure a scene, and choose the technique and settings that meet a frame time or an error"},
    Other{"lab", "", "lucerna-labs", "Teaching labs that check and grade themselves"}};

fs::path beside(const char* program) { return fs::read_symlink("/proc/self/exe").parent_path() / program; }

std::vector<CommandEntry> treeOf(const char* program) {
  const fs::path file = beside(program);
  if (!fs::exists(file)) return {};
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen((bench::shellWord(file.string()) + " tree").c_str(), "r"),
                                                   pclose);
  std::string text;
  std::array<char, 4096> part{};
  while (pipe) {
    const std::size_t count = std::fread(part.data(), 1, part.size(), pipe.get());
    if (count == 0) break;
    text.append(part.data(), count);
  }
  return nlohmann::json::parse(text).get<std::vector<CommandEntry>>();
}

bool isBelow(const std::string& path, std::string_view command) {
  return path == command || path.starts_with(std::string(command) + " ");
}

}  // namespace

int startOther(int argc, char** argv) {
  const int first = argc > 1 && argv[1] == std::string_view("help") ? 2 : 1;
  const std::string_view command = argc > first ? argv[first] : "",
                         subcommand = argc > first + 1 ? argv[first + 1] : "";
  const auto other = std::find_if(kOthers.begin(), kOthers.end(), [&](const Other& o) {
    return o.command == command && (o.subcommand.empty() || o.subcommand == subcommand);
  });
  if (other == kOthers.end()) return 0;
  const fs::path file = beside(other->program);
  execv(file.c_str(), argv);
  fmt::print(stderr, "lucerna: {}: {} ({}); in a build folder: cmake --build . --target {}\n", command, file.string(),
             std::strerror(errno), other->program);
  return static_cast<int>(ErrorKind::missingCapability);
}

std::string descriptionOf(const std::string& command) {
  for (const Other& other : kOthers)
    if (other.command == command && other.description) return other.description;
  CHECK(false, "{} is no other program's command", command);
}

std::vector<std::string> subcommandsElsewhere(std::string_view command) {
  std::vector<std::string> names;
  for (const Other& other : kOthers)
    if (other.command == command && !other.subcommand.empty()) names.emplace_back(other.subcommand);
  return names;
}

void addOther(Subcommands& commands, const std::string& name) {
  commands.add(name, descriptionOf(name), Work([] { return 0; }));
}

std::vector<CommandEntry> treeOfAll(Command program) {
  std::vector<CommandEntry> all = commandTree(program), result;
  const std::vector<CommandEntry> others[] = {treeOf("lucerna-bench"), treeOf("lucerna-labs"),
                                              treeOf("lucerna-originals")};
  for (CommandEntry& entry : all) {
    const std::size_t first = result.size();
    for (const std::vector<CommandEntry>& tree : others)
      for (const CommandEntry& other : tree) {
        const bool isKnown =
            std::any_of(result.begin(), result.end(), [&](const CommandEntry& r) { return r.path == other.path; });
        if (!entry.path.empty() && isBelow(other.path, entry.path) && !isKnown) result.push_back(other);
        // Commands of several programs have the subcommands of all.
        if (isKnown && other.path == entry.path)
          for (const auto& subcommand : other.subcommands) {
            auto& known = result[first].subcommands;
            if (std::find(known.begin(), known.end(), subcommand) == known.end()) known.push_back(subcommand);
          }
      }
    if (result.size() == first) result.push_back(std::move(entry));
  }
  return result;
}

void addTree(Subcommands& commands, Command program) {
  commands.add("tree", "The commands as JSON, for `lucerna completion` and `manual`", [program](Command tree) {
    tree.hide();
    return [program] {
      fmt::print("{}\n", nlohmann::json(commandTree(program)).dump());
      return 0;
    };
  });
}

}  // namespace lucerna::demo
