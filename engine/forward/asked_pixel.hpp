// Data of the queried pixel (what lit it), between the shaders that record it (shaders/forward/asked.glsl,
// asked_parts.glsl) and the answer (render/pixel_answer.hpp). Created on request, and dropped with the answer.
#pragma once

#include "gl/objects.hpp"
#include "shared/asked.h"

#include <vector>

namespace lucerna {

using AskedPart = shared::AskedPart;

/// Vectors recorded by shading, at the indices of shared/asked.h.
class AskedTerms {
 public:
  static constexpr std::size_t kCount = 1024;  ///< radiosity has as many lights as the scene
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

/// Contributions recorded by a technique's lookup.
class AskedParts {
 public:
  /// Capacity `count`; parts beyond it are only counted.
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
