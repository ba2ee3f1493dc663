// PLY, text and binary.
#include "fuzz.hpp"

#include "scene/model_parts.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return lucerna::fuzz::parse([&] {
    lucerna::Scene scene;
    scene.file = "fuzz.ply";
    lucerna::readPly(scene, {data, size});
  });
}
