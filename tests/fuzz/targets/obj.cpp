// OBJ, and MTL in the same text: a file that names itself as its library.
#include "fuzz.hpp"

#include "scene/model_parts.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return lucerna::fuzz::parse([&] {
    lucerna::Scene scene;
    scene.file = lucerna::fuzz::write("fuzz.obj", lucerna::fuzz::textOf(data, size));
    lucerna::readObj(scene, {data, size});
  });
}
