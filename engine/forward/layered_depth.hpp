// Depth maps in the layers of one texture, several filled by one draw (a geometry shader instance per view). Used for
// the sun's cascades, the spot lights (each kind a 2D array) and the omnidirectional lights (an array of cube maps).
#pragma once

#include "forward/depth_target.hpp"

#include <span>
#include <string>
#include <vector>

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
    bool operator==(const Shape&) const = default;
  };
  LayeredDepth(gl::ProgramLibrary& programs, const GpuScene& scene, const std::string& name, const Shape& shape);

  using View = DepthTarget::View;
  /// Draws the scene from every view, one per layer: what has changed since the last time. Geometry in front of a near
  /// plane is kept, at depth 0.
  void record(const GpuScene& scene, std::span<const View> views);
  void forget();
  /// Depth in [0,1], comparison on: sampler2DArrayShadow or samplerCubeArrayShadow. Points outside a 2D map are lit.
  const gl::Texture& depth() const { return depth_; }
  int size() const { return shape_.size; }
  const Shape& shape() const { return shape_; }
  std::size_t gpuBytes() const;

 private:
  Shape shape_;
  SurfacePrograms programs_;
  gl::Texture depth_;
  std::vector<DepthTarget> targets_;  ///< of each draw
};

}  // namespace lucerna
