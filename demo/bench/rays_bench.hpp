// `lucerna bench rays` as a function, for `bench all`.
#pragma once

#include "shared/commands.hpp"

#include <string>

namespace lucerna::demo::bench {

struct RaysOptions {
  std::string camera;
  int rays = 1 << 18;  ///< per kind
  int repeats = 7;  ///< after one warm-up
  double splitBudget;  ///< references that spatial splits may add, as a fraction

  RaysOptions();
};

struct RaysResult {
  std::string text;  ///< for a terminal
  nlohmann::ordered_json json;  ///< `rows`: one per kind of ray
};

/// Throws Error(badInput) for invalid options, and if the camera sees nothing. Stops when interrupted.
RaysResult measureRays(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene,
                       const RaysOptions& options, bool quiet);

}  // namespace lucerna::demo::bench
