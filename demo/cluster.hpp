// lucerna cluster plan|run|status|join: work that is cut by --part, made by many machines that share a folder.
#pragma once

#include <CLI/CLI.hpp>

#include <functional>

namespace lucerna::demo {

std::function<int()> addCluster(CLI::App& app);

}  // namespace lucerna::demo
