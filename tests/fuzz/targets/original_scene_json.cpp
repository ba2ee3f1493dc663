// The scene JSON of the path tracing original: media by material beside an OBJ of the same stem.
#include "fuzz.hpp"

#include "scene/scene_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const bool prepared = [] {
    lucerna::fuzz::write("m.obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\nusemtl b c\nf 3 2 1\n");
    lucerna::fuzz::write("m.mtl", "newmtl a\nKd 0.5 0.5 0.5\nnewmtl b c\nNi 1.3\n");
    return true;
  }();
  static_cast<void>(prepared);
  return lucerna::fuzz::parse(
      [&] { lucerna::loadSceneFile(lucerna::fuzz::write("m.json", lucerna::fuzz::textOf(data, size))); });
}
