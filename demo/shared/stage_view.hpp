// Displays a stage's intermediate picture instead of the frame: shadow maps, targets of reflective shadow maps,
// normals, depth.
#pragma once

#include "gl/objects.hpp"
#include "gl/program.hpp"
#include "frame/stage_picture.hpp"
#include "scene/scene.hpp"

namespace lucerna::demo {

class StageView {
 public:
  explicit StageView(gl::ProgramLibrary& programs) : programs_(programs), noAttributes_("stage view") {}

  /// Draws it; the picture is valid until the next call. factor: scales light, relative to a brightness that suits the
  /// picture.
  const gl::Texture& record(const StagePicture& picture, int layer, float factor, const Bounds& bounds);
  /// The same with light as it is.
  const gl::Texture& recordUnscaled(const StagePicture& picture, int layer, const Bounds& bounds);
  static int layersOf(const StagePicture& picture) { return picture.texture->size().z; }

 private:
  void draw(const StagePicture& picture, int layer, float factor, const Bounds& bounds);

  gl::ProgramLibrary& programs_;
  gl::VertexArray noAttributes_;
  gl::Texture copy_, result_;
  gl::Framebuffer target_;
  std::string measured_;  ///< picture and layer to which usualFactor_ belongs
  float usualFactor_ = 1.0f;
};

}  // namespace lucerna::demo
