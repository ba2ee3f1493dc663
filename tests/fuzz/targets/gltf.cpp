// glTF, text and binary, with numbers inside the file, as loaded and at other times.
#include "fuzz.hpp"

#include "scene/model_parts.hpp"
#include "scene/motion.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return lucerna::fuzz::parse([&] {
    lucerna::Scene scene;
    scene.file = lucerna::fuzz::folder() / "fuzz.gltf";
    lucerna::readGltf(scene, {data, size});
    lucerna::finishMotion(scene);
    for (const double seconds : {-1.0, 0.5, 1e9}) lucerna::poseAt(scene, seconds);
  });
}
