// glTF, text and binary, with numbers inside the file.
#include "fuzz.hpp"

#include "scene/model_parts.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return lucerna::fuzz::parse([&] {
    lucerna::Scene scene;
    scene.file = lucerna::fuzz::folder() / "fuzz.gltf";
    lucerna::readGltf(scene, {data, size});
  });
}
