// Loops on all cores.
#pragma once

#include <cstddef>
#include <functional>

namespace lucerna {

/// Runs work(begin, end) on parts of 0..count, on all cores; small counts on this thread. `work` must not throw.
void onAllCores(std::size_t count, const std::function<void(std::size_t begin, std::size_t end)>& work);

}  // namespace lucerna
