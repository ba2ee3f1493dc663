// `lucerna bench rays` as a function, for `bench all`.
#pragma once

#include "commands.hpp"

#include <string>

namespace lucerna::demo::bench {

struct RaysOptions {
  std::string camera;
  int rays = 1 << 18;  ///< of each kind
  int repeats = 7;  ///< after one to warm up
  double splitBudget;  ///< references that spatial splits may add, a fraction

  RaysOptions();
};

struct RaysResult {
  std::string text;  ///< for a terminal
  nlohmann::ordered_json json;  ///< `rows`: one a kind of ray
};

/// Throws Error(badInput) for options that cannot be, and where the camera sees nothing. Stops when interrupted.
RaysResult measureRays(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene,
                       const RaysOptions& options, bool quiet);

}  // namespace lucerna::demo::bench
