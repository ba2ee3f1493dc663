// lucerna: one executable, one subcommand a file. Errors become one line and an exit code: 2 bad input, 3 missing
// capability, 1 a fault of ours.
#include "base/error.hpp"
#include "cluster.hpp"
#include "command_tree.hpp"
#include "commands.hpp"
#include "gl/context.hpp"
#include "labs/command.hpp"
#include "merge.hpp"

#include <fmt/core.h>

#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <string>
#include <system_error>
#include <vector>

namespace {

/// One line of an error, whatever files and options put into it; the driver's log of a program keeps its lines.
void printError(std::string message) {
  const bool keepsLines = message.starts_with("program ");
  for (char& c : message)
    if ((static_cast<unsigned char>(c) < ' ' && !(keepsLines && c == '\n')) || c == '\x7f') c = ' ';
  fmt::print(stderr, "lucerna: {}\n", message);
}

/// A full disk behind standard output is only reported here.
int flushed(int code) {
  if (std::fflush(stdout) == 0 && !std::ferror(stdout) && std::cout.flush()) return code;
  printError(fmt::format("cannot write to standard output: {}", std::strerror(errno)));
  return code != 0 ? code : static_cast<int>(lucerna::ErrorKind::missingCapability);
}

/// One kind in one place: numbers of options that are not finite, or beyond any use, are refused before a command sees
/// them.
void checkNumbers(const CLI::App& app) {
  constexpr double kMost = 1e12;
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_type_name().find("FLOAT") == std::string::npos) continue;
    for (const std::string& text : option->results()) {
      const double value = std::strtod(text.c_str(), nullptr);
      if (!(std::abs(value) <= kMost))
        lucerna::throwBadInput("{}: '{}' is not a number from {:g} to {:g}", option->get_name(), text, -kMost, kMost);
    }
  }
  for (const CLI::App* command : app.get_subcommands()) checkNumbers(*command);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Lucerna: real-time global illumination, measured.\nStart with: lucerna walk", "lucerna"};
  app.set_version_flag("--version", LUCERNA_VERSION);
  app.require_subcommand(1);
  std::vector<std::pair<CLI::App*, lucerna::demo::Work>> commands;
  const auto add = [&](const char* name, const char* description, lucerna::demo::Work (*declare)(CLI::App&)) {
    CLI::App* command = app.add_subcommand(name, description);
    commands.emplace_back(command, declare(*command));
  };
  add("walk", "Walk through a scene along its camera path; without a window, write pictures and stage times",
      lucerna::demo::addWalk);
  add("render", "Render one picture of a scene", lucerna::demo::addRender);
  add("merge", "Parts of a path traced picture's samples (render --samples) as one picture", lucerna::demo::addMerge);
  add("cluster", "A path traced picture by many machines: a folder that they share, Slurm, or this machine alone",
      lucerna::demo::addCluster);
  add("radiosity", "Radiosity by hemicubes: make a model, solve it, show it", lucerna::demo::addRadiosity);
  add("info", "Host, driver, limits, extensions; a scene's counts and needs", lucerna::demo::addInfo);
  add("media", "Participating media: the catalogue; a scene JSON drafted from an MTL", lucerna::demo::addMedia);
  add("bench", "Measure: error over time, stability, what is left out; published tables and pictures made again",
      lucerna::demo::addBench);
  add("compare", "Errors between two HDR pictures, with heat maps", lucerna::demo::addCompare);
  add("tune", "Measure a scene, and choose the technique and settings that meet a frame time or an error",
      lucerna::demo::addTune);
  add("lab", "Teaching labs that check and grade themselves", lucerna::demo::addLab);
  add("completion", "Print a completion script for a shell", lucerna::demo::addCompletion);
  add("manual", "Print the manual page, in roff", lucerna::demo::addManual);

  try {
    app.parse(argc, argv);
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
      printError(fmt::format("{}: no such subcommand (lucerna {}--help lists them)", rest[0], used));
      return static_cast<int>(lucerna::ErrorKind::badInput);
    }
    printError(fmt::format("{} (lucerna {}--help lists the options)", error.what(), used));
    return static_cast<int>(lucerna::ErrorKind::badInput);
  }
  try {
    checkNumbers(app);
    for (auto& [command, work] : commands)
      if (command->parsed()) {
        const int code = flushed(work());
        const std::string errors = lucerna::gl::takePendingErrors();
        if (errors.empty()) return code;
        printError(fmt::format("internal error: OpenGL reports {} at the end of the command", errors));
        return static_cast<int>(lucerna::ErrorKind::fault);
      }
  } catch (const lucerna::Error& error) {
    printError(error.what());
    return error.exitCode();
  } catch (const lucerna::Stopped& stopped) {
    printError(stopped.what());
    return lucerna::demo::exitCode();
  } catch (const std::bad_alloc&) {
    printError("out of memory");
    return static_cast<int>(lucerna::ErrorKind::missingCapability);
  } catch (const std::system_error& error) {
    // The system's own refusals: standard output that is full, threads that cannot be made.
    printError(error.what());
    return static_cast<int>(lucerna::ErrorKind::missingCapability);
  } catch (const std::exception& error) {
    printError(error.what());
    return static_cast<int>(lucerna::ErrorKind::fault);
  }
  return 0;
}
