#include "forward/object_motion.hpp"

#include "gl/pass.hpp"

#include <array>

namespace lucerna {

ObjectMotion::ObjectMotion(gl::ProgramLibrary& programs, const SceneFeatures& features) {
  const auto load = [&](const char* name, bool masked) {
    return &programs.loadRaster(name, "forward/object_motion.vert", "forward/object_motion.frag",
                                {{"ALPHA_MASK", masked}, {"EMITTERS", features.emission}});
  };
  programs_.opaque = load("motion opaque", false);
  if (features.alphaMasks) programs_.masked = load("motion masked", true);
}

void ObjectMotion::draw(const GpuScene& scene, const gl::Texture& depth, const glm::dmat4& clip,
                        const glm::dmat4& clipBefore) {
  if (!texture_) {
    texture_.emplace("motion of objects", gl::Format::rgba16f, depth.size2d());
    target_.emplace("motion of objects", std::array<const gl::Texture*, 1>{&*texture_}, &depth);
  }
  for (const gl::Program* program : {programs_.opaque, programs_.masked}) {
    if (!program) continue;
    program->use();
    program->set("clipFromWorldCentred", glm::mat4(clip));
    program->set("clipFromWorldBefore", glm::mat4(clipBefore));
  }
  gl::RasterState state;
  state.depth = gl::Depth::equalReadOnly;
  const gl::RasterPass pass("motion of objects", *target_, state);
  pass.clearColor(0, glm::vec4(0.0f));
  scene.drawMoved(programs_);
}

}  // namespace lucerna
