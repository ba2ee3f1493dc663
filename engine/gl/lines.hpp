// Lines between points of a scene, drawn over a picture of it; parts behind the picture's surfaces are faint.
#pragma once

#include "gl/objects.hpp"
#include "gl/program.hpp"

#include <span>
#include <vector>

namespace lucerna::gl {

class Lines {
 public:
  struct Line {
    glm::vec3 start, end;
    glm::vec4 color;  ///< written unchanged, alpha not premultiplied
  };
  /// Position of the picture in the target: pixels from the lower left.
  struct Placement {
    glm::ivec2 corner, size;  ///< only these pixels are drawn
    glm::vec2 middle, centre, scale;  ///< `centre` of the picture (0..1) lies at `middle`; its whole size is `scale`
  };
  struct View {
    glm::mat4 clipFromWorld;
    float near = 0.0f, far = 1.0f;  ///< planes of that projection
    const Texture* depth = nullptr;  ///< of the picture; null: no occlusion
  };

  explicit Lines(ProgramLibrary& programs);
  void draw(const Framebuffer& target, const Placement& placement, const View& view, std::span<const Line> lines,
            float width);
  std::size_t gpuBytes() const { return vertices_.bytes(); }

 private:
  struct Vertex {
    glm::vec3 start, end;
    glm::vec2 corner;
    glm::vec4 color;
  };
  const Program* program_;
  Texture noDepth_;
  Buffer vertices_;
  VertexArray vertexArray_;
};

}  // namespace lucerna::gl
