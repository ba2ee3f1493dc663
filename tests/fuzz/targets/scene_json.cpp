// Our scene JSON, as loaded and at other times, beside a model, a density grid and a picture that it may name.
#include "fuzz.hpp"

#include "scene/motion.hpp"
#include "scene/scene_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const bool prepared = [] {
    lucerna::fuzz::write(
        "m.obj",
        "mtllib m.mtl\no o\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nusemtl a\nf 1 2 3\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
    lucerna::fuzz::write("m.mtl", "newmtl a\nKd 0.5 0.5 0.5\n");
    lucerna::fuzz::write("d.raw", std::string(8, '\x20'));
    lucerna::fuzz::write("p.pfm", "PF\n1 1\n-1\n" + std::string(12, '\0'));
    lucerna::fuzz::write("k.txt", "p 4 2 4 d -1 -0.3 -1 u 0 1 0\np 3 2 5 d -0.8 -0.3 -1 u 0 1 0\n");
    return true;
  }();
  static_cast<void>(prepared);
  return lucerna::fuzz::parse([&] {
    lucerna::Scene scene = lucerna::loadSceneFile(lucerna::fuzz::write("m.json", lucerna::fuzz::textOf(data, size)));
    lucerna::finishMotion(scene);
    for (const double seconds : {-1.0, 0.5, 1e9}) lucerna::poseAt(scene, seconds);
  });
}
