// glTF, text and binary, before Assimp reads it, and what is read of its materials and lights.
#include "fuzz.hpp"

#include "scene/gltf_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return lucerna::fuzz::parse([&] {
    const lucerna::Json root = lucerna::checkedGltf("fuzz.gltf", {data, size});
    lucerna::gltfLightsWithRange(root);
    for (std::size_t material = 0; material < 3; ++material) lucerna::gltfMaterial(root, "fuzz.gltf", material);
  });
}
