// Lines between places of a scene, drawn over a picture of it: what lies behind the picture's surfaces is faint.
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
    glm::vec4 color;  ///< as it is written, alpha not multiplied in
  };
  /// Where in the target the picture is: pixels from the lower left.
  struct Placement {
    glm::ivec2 corner, size;  ///< only these pixels are drawn
    glm::vec2 middle, centre, scale;  ///< `centre` of the picture (0..1) lies at `middle`; all of it takes `scale`
  };
  struct View {
    glm::mat4 clipFromWorld;
    float near = 0.0f, far = 1.0f;  ///< planes of that projection
    const Texture* depth = nullptr;  ///< of the picture; null: nothing hides anything
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
