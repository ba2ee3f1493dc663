// Camera paths, and what is interpolated between their keys.
#include "fuzz.hpp"

#include "scene/key_frames.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return lucerna::fuzz::parse([&] {
    lucerna::KeyFrames keys =
        lucerna::readKeyFrames(lucerna::fuzz::write("fuzz.txt", lucerna::fuzz::textOf(data, size)));
    for (const lucerna::KeyFrameMove& move : keys.moves)
      if (move.times.empty() || move.times.size() != move.offsets.size() ||
          !std::is_sorted(move.times.begin(), move.times.end()))
        std::abort();
    if (keys.camera.empty()) return;
    const lucerna::Spline path(std::move(keys.camera));
    for (double t = 0.0; t <= 1.0; t += 0.25) {
      const lucerna::Camera camera = path.at(t);
      if (!(std::abs(glm::length(camera.direction) - 1.0) < 1e-6) ||
          !(std::abs(glm::dot(camera.direction, camera.up)) < 1e-6))
        std::abort();
    }
  });
}
