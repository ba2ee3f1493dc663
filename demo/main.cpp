// lucerna: one executable, one subcommand a file. Errors become one line and an exit code: 2 bad input, 3 missing
// capability, 1 a fault of ours.
#include "base/error.hpp"
#include "command_tree.hpp"
#include "commands.hpp"

#include <fmt/core.h>

#include <string>
#include <vector>

int main(int argc, char** argv) {
  CLI::App app{"Lucerna: real-time global illumination, measured.\nStart with: lucerna walk", "lucerna"};
  app.set_version_flag("--version", LUCERNA_VERSION);
  app.require_subcommand(1);
  std::vector<std::pair<CLI::App*, lucerna::demo::Work>> commands;
  const auto add = [&](const char* name, const char* description, lucerna::demo::Work (*declare)(CLI::App&)) {
    CLI::App* command = app.add_subcommand(name, description);
    commands.emplace_back(command, declare(*command));
  };
  add("walk", "Walk through a scene along its camera path; without a window, write pictures and stage times", lucerna::demo::addWalk);
  add("render", "Render one picture of a scene", lucerna::demo::addRender);
  add("radiosity", "Radiosity by hemicubes: make a model, solve it, show it", lucerna::demo::addRadiosity);
  add("info", "Host, driver, limits, extensions; a scene's counts and needs", lucerna::demo::addInfo);
  add("media", "Participating media: the catalogue; a scene JSON drafted from an MTL", lucerna::demo::addMedia);
  add("bench", "Measure: error over time, stability, what is left out; published tables and pictures made again", lucerna::demo::addBench);
  add("compare", "Errors between two HDR pictures, with heat maps", lucerna::demo::addCompare);
  add("tune", "Measure a scene, and choose the technique and settings that meet a frame time or an error", lucerna::demo::addTune);
  add("completion", "Print a completion script for a shell", lucerna::demo::addCompletion);
  add("manual", "Print the manual page, in roff", lucerna::demo::addManual);

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    std::string used;
    const CLI::App* deepest = &app;
    while (!deepest->get_subcommands().empty()) {
      deepest = deepest->get_subcommands()[0];
      used += deepest->get_name() + " ";
    }
    const std::vector<std::string> rest = deepest->remaining();
    if (deepest->get_require_subcommand_min() > 0 && !rest.empty() && rest[0][0] != '-') {
      fmt::print(stderr, "lucerna: {}: no such subcommand (lucerna {}--help lists them)\n", rest[0], used);
      return static_cast<int>(lucerna::ErrorKind::badInput);
    }
    fmt::print(stderr, "lucerna: {} (lucerna {}--help lists the options)\n", error.what(), used);
    return static_cast<int>(lucerna::ErrorKind::badInput);
  }
  try {
    for (auto& [command, work] : commands)
      if (command->parsed()) return work();
  } catch (const lucerna::Error& error) {
    fmt::print(stderr, "lucerna: {}\n", error.what());
    return error.exitCode();
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "lucerna: out of memory\n");
    return static_cast<int>(lucerna::ErrorKind::missingCapability);
  } catch (const std::exception& error) {
    fmt::print(stderr, "lucerna: {}\n", error.what());
    return static_cast<int>(lucerna::ErrorKind::fault);
  }
  return 0;
}
