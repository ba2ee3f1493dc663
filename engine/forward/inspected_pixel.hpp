// Data of the inspected pixel (what lit it), between the shaders that record it (shaders/forward/inspected.glsl,
// inspected_parts.glsl) and the answer (frame/pixel_inspection.hpp). Created on request, and dropped with the answer.
#pragma once

#include "gl/objects.hpp"
#include "shared/inspected.h"

#include <vector>

namespace lucerna {

using InspectedPart = shared::InspectedPart;

/// Vectors recorded by shading, at the indices of shared/inspected.h.
class InspectedTerms {
 public:
  static constexpr std::size_t kCount = 1024;  ///< radiosity has as many lights as the scene
  InspectedTerms() : buffer_("inspected terms", kCount * sizeof(glm::vec4), nullptr, gl::Usage::dynamicCopy) {
    buffer_.clear();
  }
  void bind() const { buffer_.bindStorage(INSPECTED_BINDING); }
  void read() { values_ = buffer_.read<glm::vec4>(); }
  glm::vec3 operator[](std::size_t place) const { return glm::vec3(values_[place]); }
  float fourth(std::size_t place) const { return values_[place].w; }

 private:
  gl::Buffer buffer_;
  std::vector<glm::vec4> values_;
};

/// Contributions recorded by a technique's lookup.
class InspectedParts {
 public:
  /// Capacity `count`; parts beyond it are only counted.
  explicit InspectedParts(std::size_t count)
      : buffer_("inspected parts", (1 + count) * sizeof(InspectedPart), nullptr, gl::Usage::dynamicCopy) {
    buffer_.clear();
  }
  void bind() const { buffer_.bindStorage(INSPECTED_PARTS_BINDING); }
  std::vector<InspectedPart> read() const;

 private:
  gl::Buffer buffer_;
};

}  // namespace lucerna
