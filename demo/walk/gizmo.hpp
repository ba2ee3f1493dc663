// Moves lamps in the picture: three axes at each lamp, dragged one at a time.
#pragma once

#include "gl/lines.hpp"
#include "scene/scene.hpp"

#include <glm/glm.hpp>

#include <optional>
#include <vector>

namespace lucerna::demo {

class Gizmo {
 public:
  /// Projects points of the scene to the window: pixels from the top left; none behind the camera.
  struct Screen {
    gl::Lines::Placement placement;
    gl::Lines::View view;
    glm::dvec3 origin{0.0};  ///< of the view
    int height = 0;  ///< of the target
    std::optional<glm::vec2> at(const glm::dvec3& place) const;
  };
  /// Receives the left button and the cursor before anything else. True: the gizmo uses them.
  bool take(Scene& scene, const Screen& screen, const glm::vec2& cursor, bool held);
  std::vector<gl::Lines::Line> lines(const Scene& scene, const glm::dvec3& origin) const;

 private:
  struct Grip {
    std::size_t lamp = 0;  ///< spots, then points
    int axis = 0;
    glm::vec2 start{0.0f};  ///< cursor
    glm::dvec3 place{0.0};  ///< of the lamp, before
  };
  std::optional<Grip> grip_;
  bool heldBefore_ = false;
};

}  // namespace lucerna::demo
