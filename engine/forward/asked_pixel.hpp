// The one pixel that is asked what lit it, between the shaders that write it down (shaders/forward/asked.glsl,
// asked_parts.glsl) and the answer (render/pixel_answer.hpp). Made when somebody asks, and dropped with the answer.
#pragma once

#include "gl/objects.hpp"
#include "shared/asked.h"

#include <vector>

namespace lucerna {

using AskedPart = shared::AskedPart;

/// What shading wrote: vectors at the places of shared/asked.h.
class AskedTerms {
 public:
  static constexpr std::size_t kCount = 1024;  ///< lights of radiosity are as many as the scene has
  AskedTerms() : buffer_("asked terms", kCount * sizeof(glm::vec4), nullptr, gl::Usage::dynamicCopy) {
    buffer_.clear();
  }
  void bind() const { buffer_.bindStorage(ASKED_BINDING); }
  void read() { values_ = buffer_.read<glm::vec4>(); }
  glm::vec3 operator[](std::size_t place) const { return glm::vec3(values_[place]); }
  float fourth(std::size_t place) const { return values_[place].w; }

 private:
  gl::Buffer buffer_;
  std::vector<glm::vec4> values_;
};

/// What a technique's lookup wrote.
class AskedParts {
 public:
  /// Room for `count`; what a lookup tells beyond it is counted alone.
  explicit AskedParts(std::size_t count)
      : buffer_("asked parts", (1 + count) * sizeof(AskedPart), nullptr, gl::Usage::dynamicCopy) {
    buffer_.clear();
  }
  void bind() const { buffer_.bindStorage(ASKED_PARTS_BINDING); }
  std::vector<AskedPart> read() const;

 private:
  gl::Buffer buffer_;
};

}  // namespace lucerna
