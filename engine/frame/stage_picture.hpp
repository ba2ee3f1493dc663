// Intermediate results of the frame's stages, for debug views.
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
    irradiance,  ///< of the irradiance cache: a slice of cells per layer, faces and cascades one after the other
    coefficients,  ///< spherical harmonics of light in cells: one slice per layer, cascades one after the other
    samples  ///< alpha: how many samples of a pixel are in the picture; 16 are white
  };
  Kind kind;
  std::string name;
  const gl::Texture* texture;  ///< 2D, an array of layers or 3D; the red channel's, if green and blue are separate
  const gl::Texture* green = nullptr;
  const gl::Texture* blue = nullptr;

  bool isLight() const { return kind == Kind::flux || kind == Kind::irradiance || kind == Kind::coefficients; }
};

}  // namespace lucerna
