#include "base/provenance.hpp"

#include "commit.hpp"

#include <fmt/format.h>

#include <fstream>
#include <thread>

namespace lucerna {

std::string programVersion() { return fmt::format("{}, commit {}", LUCERNA_VERSION, LUCERNA_COMMIT); }

std::string cpuName() {
  std::ifstream stream("/proc/cpuinfo");
  std::string line, name = "unknown processor";
  while (std::getline(stream, line))
    if (line.starts_with("model name")) {
      name = line.substr(line.find(':') + 2);
      break;
    }
  return fmt::format("{}, {} threads", name, std::thread::hardware_concurrency());
}

}  // namespace lucerna
