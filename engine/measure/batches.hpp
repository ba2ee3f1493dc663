// Divides the samples of a reference into batches (reference.hpp), for callers that make them one by one (no GL).
#pragma once

#include <cstdint>

namespace lucerna::measure {

/// Samples per batch, so that SamplingGoal::kBatches batches have at least `samples`.
std::uint32_t batchSize(std::uint64_t samples);

}  // namespace lucerna::measure
