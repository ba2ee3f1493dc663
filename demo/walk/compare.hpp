// The window's view of one or two pictures: whole, with a wipe or side by side, as they are or as errors, with a common
// exposure, tone map and zoom.
#pragma once

#include "gl/lines.hpp"
#include "gl/objects.hpp"
#include "gl/program.hpp"

#include <array>
#include <optional>
#include <string_view>

namespace lucerna::demo {

enum class Layout { one, wipe, sideBySide };
constexpr std::array<std::string_view, 3> kLayoutNames{"one picture", "wipe", "side by side"};

/// The displayed quantity of a picture; same order as in shaders/walk/compose.frag.
enum class Show { picture, signedError, relativeError, zScore, flip, values };
constexpr std::array<std::string_view, 5> kShowNames{"picture", "signed error", "relative error", "z-score", "FLIP"};

class Compare {
 public:
  struct Side {
    const gl::Texture* radiance = nullptr;  ///< linear, bottom row first
    Show show = Show::picture;
    const gl::Texture* flip = nullptr;  ///< if show is flip
    glm::vec4 bar{0.0f};  ///< where its colour scale is drawn: lower corner, size, in the target's pixels; 0: nowhere
  };
  struct Inputs {
    Side left, right;  ///< right is not read if the layout is one
    Layout layout = Layout::one;
    float split = 0.5f;  ///< position of the wipe
    float zoom = 1.0f;
    glm::vec2 centre{0.5f};  ///< point of the picture, (0,0) bottom left
    bool interpolates = false;  ///< the pictures are coarser than the target for a while
    float exposure = 1.0f;
    const gl::Texture *reference = nullptr, *standardError = nullptr;  ///< if errors are shown
    float errorScale = 1.0f;  ///< radiance
    std::optional<glm::vec2> magnifier;  ///< position in the target, from the top left
  };

  explicit Compare(gl::ProgramLibrary& programs);
  /// Draws into the left part of the target, over its full height.
  void record(const gl::Framebuffer& target, glm::ivec2 size, const Inputs& inputs) const;

  /// Exposure that maps the picture's geometric mean luminance to middle grey; none for a black picture. Waits for the
  /// GPU.
  std::optional<float> meteredExposure(const gl::Texture& radiance) const;

  /// Position of the left or the right picture in the target.
  static gl::Lines::Placement placementOf(const Inputs& inputs, glm::ivec2 target, bool right);
  // Positions are those of the cursor, from the top left. Whole numbers are a pixel's upper left corner, and mean that
  // pixel.

  /// Whether the target's pixel at that position belongs to the right picture.
  static bool isRight(const Inputs& inputs, glm::ivec2 target, glm::vec2 cursor);
  /// The pixel of the picture (from the top left) at the centre of that pixel; none outside the picture.
  static std::optional<glm::ivec2> pictureAt(const Inputs& inputs, glm::ivec2 target, glm::vec2 cursor);

 private:
  const gl::Program *compose_, *meter_;
  gl::VertexArray noAttributes_;
  gl::Texture black_, meterPicture_;
  gl::Framebuffer meterTarget_;
};

}  // namespace lucerna::demo
