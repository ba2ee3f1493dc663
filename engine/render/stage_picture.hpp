// What a stage of the frame has made, to be looked at (debug views).
#pragma once

#include "gl/objects.hpp"

#include <string>

namespace lucerna {

/// Valid until the next frame.
struct StagePicture {
  enum class Kind {  // as in shaders/walk/stage.frag
    position,
    normal,
    flux,
    depth,
    irradiance,  ///< of receivers: a slice of cells a layer, faces and cascades one after the other
    coefficients  ///< spherical harmonics of light in cells: a slice a layer, cascades one after the other
  };
  Kind kind;
  std::string name;
  const gl::Texture* texture;  ///< 2D, an array of layers or 3D; red's, where green and blue lie in others
  const gl::Texture* green = nullptr;
  const gl::Texture* blue = nullptr;

  bool isLight() const { return kind == Kind::flux || kind == Kind::irradiance || kind == Kind::coefficients; }
};

}  // namespace lucerna
