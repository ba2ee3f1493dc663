// Lamps moved in the picture: three axes at each lamp, dragged along one at a time. The lamp moves when it is let go,
// as a slider's number takes effect then.
#pragma once

#include "gl/lines.hpp"
#include "scene/scene.hpp"

#include <glm/glm.hpp>

#include <optional>
#include <utility>
#include <vector>

namespace lucerna::demo {

class Gizmo {
 public:
  /// Where places of the scene are in the window: pixels from the top left; none behind the camera.
  struct Screen {
    gl::Lines::Placement placement;
    gl::Lines::View view;
    glm::dvec3 origin{0.0};  ///< of the view
    int height = 0;  ///< of the target
    std::optional<glm::vec2> at(const glm::dvec3& place) const;
  };
  /// The left button and the cursor, before anything else takes them. True: they are the gizmo's.
  bool take(Scene& scene, const Screen& screen, const glm::vec2& cursor, bool held);
  /// A lamp was let go somewhere else, since the last call.
  bool takeMoved() { return std::exchange(moved_, false); }
  std::vector<gl::Lines::Line> lines(const Scene& scene, const glm::dvec3& origin) const;

 private:
  struct Grip {
    std::size_t lamp = 0;  ///< spots, then points
    int axis = 0;
    glm::vec2 start{0.0f};  ///< cursor
    double distance = 0.0;  ///< dragged, scene units
  };
  std::optional<Grip> grip_;
  bool heldBefore_ = false, moved_ = false;
};

}  // namespace lucerna::demo
