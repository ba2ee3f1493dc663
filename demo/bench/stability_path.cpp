// Stiff and extreme cases of the path tracer.
#include "bench/stability.hpp"

namespace lucerna::demo::bench {

void addPathCases(std::vector<StabilityCase>&) {}

}  // namespace lucerna::demo::bench
