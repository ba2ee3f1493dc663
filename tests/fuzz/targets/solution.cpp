// Radiosity solutions. The scene's fingerprint and the checksum are put right, so that the fuzzer comes past them.
#include "fuzz.hpp"

#include "base/hash.hpp"
#include "radiosity/solution.hpp"
#include "scene/fingerprint.hpp"

#include <cstring>

namespace {

// Where they stand in the header, and its size: engine/radiosity/solution_file.cpp.
constexpr std::size_t kScene = 24, kChecksum = 56, kHeader = 104;

lucerna::Scene triangle() {
  lucerna::Scene scene;
  scene.materials.resize(1);
  return scene;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const lucerna::Scene scene = triangle();
  std::string bytes(lucerna::fuzz::textOf(data, size));
  if (bytes.size() >= kHeader) {
    lucerna::Hash print;
    lucerna::addScene(print, scene);
    const std::uint64_t sceneValue = print.value(),
                        sum = lucerna::Hash::of(bytes.data() + kHeader, bytes.size() - kHeader);
    std::memcpy(bytes.data() + kScene, &sceneValue, 8);
    std::memcpy(bytes.data() + kChecksum, &sum, 8);
  }
  return lucerna::fuzz::parse([&] {
    const lucerna::RadiositySolution solution =
        lucerna::loadSolution(lucerna::fuzz::write("fuzz.solution", bytes), scene);
    lucerna::checkSettings("fuzz.solution", solution, {});
  });
}
