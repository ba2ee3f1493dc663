// How the samples of a reference are cut into batches (reference.hpp), for those who make them one by one (no GL).
#pragma once

#include <cstdint>

namespace lucerna::measure {

/// Samples of each of the SamplingGoal::kBatches batches that make at least `samples`.
std::uint32_t batchSize(std::uint64_t samples);

}  // namespace lucerna::measure
