// STL, text and binary.
#include "fuzz.hpp"

#include "scene/model_parts.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return lucerna::fuzz::parse([&] {
    lucerna::Scene scene;
    scene.file = "fuzz.stl";
    lucerna::readStl(scene, {data, size});
  });
}
