// Random numbers and the folder of the labs, for labs and mysteries.
#pragma once

#include <glm/glm.hpp>

#include <cstdint>
#include <filesystem>

namespace lucerna::demo::labs {

/// splitmix64 [Steele2014]: the same numbers on every machine.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::uint64_t word();
  double uniform();  ///< in [0,1), 53 bits
  double uniform(double least, double most) { return least + (most - least) * uniform(); }
  glm::dvec3 direction();  ///< uniform on the sphere

 private:
  std::uint64_t state_;
};

/// demo/labs in the data folder: the installed labs.
std::filesystem::path labsFolder();

}  // namespace lucerna::demo::labs
