// Turns errors into one line and an exit code: 2 bad input, 3 missing capability, 1 internal error.
#include "run_commands.hpp"

#include "base/error.hpp"
#include "commands.hpp"
#include "gl/context.hpp"

#include <CLI/App.hpp>
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
  return code != 0 ? code : static_cast<int>(lucerna::ErrorKind::missingCapability);
}

/// Checks in one place: numbers in options that are not finite, or absurdly large, are rejected before a command sees
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

int lucerna::demo::runCommands(Command program, const Work& work, int argc, char** argv) {
  CLI::App& app = program.cli11();
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
    const int code = flushed(work());
    const std::string errors = lucerna::gl::takePendingErrors();
    if (errors.empty()) return code;
    printError(fmt::format("internal error, found at the end of the command: {}", errors));
    return static_cast<int>(lucerna::ErrorKind::fault);
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
    // Errors of the system itself: standard output is full, threads cannot be created.
    printError(error.what());
    return static_cast<int>(lucerna::ErrorKind::missingCapability);
  } catch (const std::exception& error) {
    printError(error.what());
    return static_cast<int>(lucerna::ErrorKind::fault);
  }
  return 0;
}
