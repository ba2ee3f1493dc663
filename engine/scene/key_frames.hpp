// Key frames read from a text file (no GL): a camera path with the natural cubic spline through it, and things of the
// scene that are carried along.
//
// File: one key per line, words and numbers separated by blanks; '#' starts a comment.
//   p X Y Z  d X Y Z  u X Y Z  [r X Y Z]  [f DEGREES]  [a ASPECT]
// is a key of the camera: p position, d viewing direction, u up, f vertical field of view; r (right) and a (aspect) are
// accepted and ignored, as they follow from the others and from the picture's size. This is the format of the LPV
// original's public demo.
//   move NAME  t SECONDS  p X Y Z
// is a key of all meshes and lamps of that name: at this time of the scene they are moved by p from where the scene has
// them. A name with blanks stands in double quotes. Times of a name rise.
#pragma once

#include "scene/scene.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace lucerna {

struct KeyFrame {
  glm::dvec3 position{0.0};
  glm::dvec3 direction{0.0, 0.0, -1.0};
  glm::dvec3 up{0.0, 1.0, 0.0};
  std::optional<double> verticalFov;  ///< radians
};

/// The keys of what is carried.
struct KeyFrameMove {
  std::string name;  ///< of meshes and lamps
  int line = 0;  ///< of its first key
  std::vector<double> times;  ///< rising, seconds
  std::vector<glm::dvec3> offsets;  ///< one a time, scene units
};

struct KeyFrames {
  std::vector<KeyFrame> camera;  ///< none, or at least two
  std::vector<KeyFrameMove> moves;
};

/// Reads a key-frame file. Throws Error(badInput) naming file and line if a number is missing, a word unknown, a
/// direction zero, up parallel to direction or a time not after the one before; and if there is no key, or a single one
/// of the camera.
KeyFrames readKeyFrames(const std::filesystem::path& file);

/// Natural cubic spline through key frames (position, direction and up separately; knots at 0, 1, 2, ...):
/// second derivative 0 at both ends, first and second derivatives continuous at the keys.
class Spline {
 public:
  static constexpr int kViewsPerSegment = 200;  ///< as in [LPV2015]

  explicit Spline(std::vector<KeyFrame> keys, int viewsPerSegment = kViewsPerSegment);

  int viewCount() const { return segmentCount() * viewsPerSegment_ + 1; }
  /// View number i in 0 .. viewCount() - 1; direction and up are unit and perpendicular.
  Camera view(int i) const { return at(static_cast<double>(i) / viewsPerSegment_); }
  /// The view at parameter t in 0 .. number of keys - 1 (clamped).
  Camera at(double t) const;
  int segmentCount() const { return static_cast<int>(keys_.size()) - 1; }

 private:
  std::vector<KeyFrame> keys_;
  std::vector<KeyFrame> tangents_;  ///< first derivatives at the keys
  int viewsPerSegment_;
};

/// Chooses the view to show: the walk keeps its duration by skipping views if rendering is slow.
/// One view every `secondsPerView` (1/60 s as in the original's 17 ms); ends after the last view.
class SplinePlayback {
 public:
  SplinePlayback(int viewCount, double secondsPerView = 1.0 / 60.0)
      : viewCount_(viewCount), secondsPerView_(secondsPerView) {}
  /// The view due at `seconds` after the start, or nothing once the walk is over.
  std::optional<int> viewAt(double seconds) const;
  double duration() const { return viewCount_ * secondsPerView_; }

 private:
  int viewCount_;
  double secondsPerView_;
};

}  // namespace lucerna
