// How OpenGL reads a scene's texture beyond its picture.
#pragma once

#include "gl/objects.hpp"
#include "scene/scene.hpp"

namespace lucerna {

inline gl::Wrap wrapOf(TextureWrap wrap) {
  switch (wrap) {
    case TextureWrap::edge: return gl::Wrap::edge;
    case TextureWrap::mirror: return gl::Wrap::mirror;
    case TextureWrap::repeat: break;
  }
  return gl::Wrap::repeat;
}

inline gl::Sampling withWraps(gl::Sampling sampling, const TextureWraps& wraps) {
  sampling.wrap = wrapOf(wraps.u);
  sampling.vertical = wrapOf(wraps.v);
  return sampling;
}

}  // namespace lucerna
