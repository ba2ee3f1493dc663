// The subcommand `lucerna lab`.
#pragma once

#include <CLI/CLI.hpp>

#include <functional>

namespace lucerna::demo {

/// As commands.hpp has the others.
std::function<int()> addLab(CLI::App& app);
/// The same without museum and mystery, which render: what it needs of the engine ends with engine/gl.
std::function<int()> addLabs(CLI::App& app);

}  // namespace lucerna::demo
