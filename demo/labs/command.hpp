// The subcommand `lucerna lab`.
#pragma once

#include <CLI/CLI.hpp>

#include <functional>

namespace lucerna::demo {

/// As commands.hpp has the others.
std::function<int()> addLab(CLI::App& app);

}  // namespace lucerna::demo
