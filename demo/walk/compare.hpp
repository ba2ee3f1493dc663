// What the window shows of one or two pictures of a view: whole, wipe or side by side, as they are or as errors, under
// one exposure, tone map and zoom.
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

/// What of a picture is shown; the order is that of shaders/walk/compose.frag.
enum class Show { picture, signedError, relativeError, zScore, flip, values };
constexpr std::array<std::string_view, 5> kShowNames{"picture", "signed error", "relative error", "z-score", "FLIP"};

class Compare {
 public:
  struct Side {
    const gl::Texture* radiance = nullptr;  ///< linear, bottom row first
    Show show = Show::picture;
    const gl::Texture* flip = nullptr;  ///< where show is flip
  };
  struct Inputs {
    Side left, right;  ///< right is not read where the layout is one
    Layout layout = Layout::one;
    float split = 0.5f;  ///< of a wipe
    float zoom = 1.0f;
    glm::vec2 centre{0.5f};  ///< of the picture, (0,0) bottom left
    float exposure = 1.0f;
    const gl::Texture *reference = nullptr, *standardError = nullptr;  ///< where errors are shown
    float errorScale = 1.0f;  ///< radiance
    std::optional<glm::vec2> magnifier;  ///< place in the target, from the top left
  };

  explicit Compare(gl::ProgramLibrary& programs);
  /// Into the left part of the target, of the target's height.
  void record(const gl::Framebuffer& target, glm::ivec2 size, const Inputs& inputs) const;

  /// Exposure that puts the picture's geometric mean luminance at middle grey; none for a black picture. Waits for the
  /// GPU.
  std::optional<float> meteredExposure(const gl::Texture& radiance) const;

  /// Where in the target the left picture, or the right one, is drawn.
  static gl::Lines::Placement placementOf(const Inputs& inputs, glm::ivec2 target, bool right);
  // Places are of the cursor, from the top left: whole numbers are a pixel's upper left corner, and mean that pixel.

  /// Whether the pixel of the target at that place is of the right picture.
  static bool isRight(const Inputs& inputs, glm::ivec2 target, glm::vec2 cursor);
  /// The pixel of the picture (from the top left) in the middle of that pixel; none beside it.
  static std::optional<glm::ivec2> pictureAt(const Inputs& inputs, glm::ivec2 target, glm::vec2 cursor);

 private:
  const gl::Program *compose_, *meter_;
  gl::VertexArray noAttributes_;
  gl::Texture black_, meterPicture_;
  gl::Framebuffer meterTarget_;
};

}  // namespace lucerna::demo
