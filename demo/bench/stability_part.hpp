// Rows of `lucerna bench stability` in parts (parts.hpp).
#pragma once

#include "bench/stability.hpp"
#include "parts.hpp"

namespace lucerna::demo::bench {

/// Of the rows of `technique`, or of all, those of a part; kept ones are taken from where they lie. Stops when
/// interrupted.
std::vector<StabilityRow> runStability(const StabilityContext& context, const std::string& technique, bool quiet,
                                       const PartOptions& part);

}  // namespace lucerna::demo::bench
