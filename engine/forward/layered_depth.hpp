// Depth maps in the layers of one texture, several filled by one draw (a geometry shader instance per view). Used for
// the sun's cascades, the spot lights (each kind a 2D array) and the omnidirectional lights (an array of cube maps).
#pragma once

#include "forward/gpu_scene.hpp"
#include "gl/pass.hpp"

#include <span>
#include <string>

namespace lucerna {

class LayeredDepth {
 public:
  struct Shape {
    gl::TextureKind kind;  ///< array or cubeArray
    int size;  ///< texels per side
    int layers;  ///< of cube maps: 6 each
    int layersPerDraw;  ///< filled by one draw of the scene; divides `layers`
    bool lamps = false;  ///< surfaces that hold a lamp do not shade it
    bool followed = false;  ///< read as depths, by the receiver's plane; else compared, with an offset by slope
  };
  LayeredDepth(gl::ProgramLibrary& programs, const GpuScene& scene, const std::string& name, const Shape& shape);

  /// A view's matrix for positions relative to `place`.
  struct View {
    glm::mat4 clipFromPlace;
    glm::vec3 place;
  };
  /// Draws the scene from every view, one per layer. Geometry in front of a near plane is kept, at depth 0.
  void record(const GpuScene& scene, std::span<const View> views) const;
  /// Depth in [0,1], comparison on: sampler2DArrayShadow or samplerCubeArrayShadow. Points outside a 2D map are lit.
  const gl::Texture& depth() const { return depth_; }
  int size() const { return shape_.size; }
  std::size_t gpuBytes() const { return depth_.bytes(); }

 private:
  std::string name_;
  Shape shape_;
  SurfacePrograms programs_;
  gl::Texture depth_;
  gl::Framebuffer framebuffer_;
};

}  // namespace lucerna
