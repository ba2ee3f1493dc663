#include "base/parallel.hpp"

#include <algorithm>
#include <thread>
#include <vector>

namespace lucerna {

void onAllCores(std::size_t count, const std::function<void(std::size_t begin, std::size_t end)>& work) {
  const std::size_t cores = std::clamp<std::size_t>(std::thread::hardware_concurrency(), 1, 64);
  if (count < 256 || cores == 1) return work(0, count);
  std::vector<std::jthread> threads;
  for (std::size_t k = 1; k < cores; ++k)
    threads.emplace_back([&, k] { work(count * k / cores, count * (k + 1) / cores); });
  work(0, count / cores);
}

}  // namespace lucerna
