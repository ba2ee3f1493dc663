// Camera paths, and what is interpolated between their keys.
#include "fuzz.hpp"

#include "scene/key_frames.hpp"

#include <cmath>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return lucerna::fuzz::parse([&] {
    const lucerna::Spline path(
        lucerna::readKeyFrames(lucerna::fuzz::write("fuzz.txt", lucerna::fuzz::textOf(data, size))));
    for (double t = 0.0; t <= 1.0; t += 0.25) {
      const lucerna::Camera camera = path.at(t);
      if (!(std::abs(glm::length(camera.direction) - 1.0) < 1e-6) ||
          !(std::abs(glm::dot(camera.direction, camera.up)) < 1e-6))
        std::abort();
    }
  });
}
