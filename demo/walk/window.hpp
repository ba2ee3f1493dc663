// The walkthrough in a window, or driven by recorded input on any host: camera path and free camera, panel, comparison
// and live reference.
#pragma once

#include "base/clock.hpp"
#include "base/time_share.hpp"
#include "walk/gizmo.hpp"
#include "walk/input_file.hpp"
#include "walk/keys.hpp"
#include "walk/options.hpp"
#include "walk/renderdoc.hpp"
#include "shared/stage_view.hpp"
#include "walk/state.hpp"
#include "walk/ui.hpp"
#include "walk/video.hpp"

#include <chrono>

namespace lucerna::demo {

class WalkWindow {
 public:
  /// `state` must hold a scene, a path and the first technique's renderer.
  WalkWindow(const WalkOptions& options, Host& host, const gl::Context& context, gl::ProgramLibrary& programs,
             WalkState state);
  ~WalkWindow();

  /// Runs until the window is closed, the path ends or --frames are drawn.
  void run();

  int frames() const { return frames_; }
  double seconds() const { return seconds_; }
  WalkState& state() { return state_; }
  /// Reports what a run by recorded input did: controls touched, messages shown.
  nlohmann::ordered_json toJson() const;

 private:
  // The steps of a frame, in this order.
  bool takeInput();  ///< false: the walk ends
  void act(Action action);
  void moveCamera(double seconds);
  void loadWantedScene();
  void makeReady();
  void make(SideState& side);
  void draw();
  void makeReference(double frameSeconds);
  bool seekReference();
  void judge();
  bool allSettled() const;
  void compose();
  void readPixel(const Compare::Inputs& inputs);
  void inspectPixel(const Compare::Inputs& inputs);
  void drawLines(const Compare::Inputs& inputs);
  void drawGlyphs(const Compare::Inputs& inputs);
  void drawGizmo(const Compare::Inputs& inputs);
  void takeShot();
  void recordVideo(double seconds);
  void beginCapture();
  void endCapture();
  void pace(Clock::time_point start);

  /// Called during long work: shows the old picture and a note of what is being done. Throws Stopped if Escape was
  /// pressed.
  void breathe(const std::string& what, double share = -1.0);
  void resizeTo(glm::ivec2 window);
  void drawUi(const HostInput& input, double seconds, const std::string& work, double share);
  bool drawsUi() const;
  Bitmap shownPicture(glm::ivec2 size) const;
  glm::ivec2 pictureSize() const;  ///< size of the computed picture
  const gl::Texture* radianceOf(int side) const;
  void changed() { still_ = 0; }

  const WalkOptions& options_;
  Host& host_;
  const gl::Context& context_;
  gl::ProgramLibrary& programs_;
  WalkState state_;
  std::optional<Ui> ui_;
  std::optional<InputPlayer> player_;
  std::optional<Compare> compare_;
  std::optional<StageView> stageView_;
  std::optional<gl::Lines> lines_;
  Gizmo gizmo_;
  std::optional<Gizmo::Screen> screen_;  ///< in the last frame
  std::vector<gl::Lines::Line> glyphs_;
  std::string glyphsAre_;  ///< what glyphs_ was made from
  std::optional<Video> video_;
  std::optional<RenderDoc> renderDoc_;
  bool captures_ = false;  ///< in this frame
  HostInput input_;
  glm::dvec2 cursorBefore_{0.0};
  bool leftBefore_ = false;  ///< the left button was held in the last frame
  glm::ivec2 window_{0}, playedSize_{0};
  glm::ivec2 view_{0};  ///< the window without the panel: the area of the picture
  gl::Texture picture_;  ///< what is presented, unless it is the renderer's own picture
  gl::Framebuffer pictureTarget_;
  Camera lastCamera_;
  int still_ = 0;  ///< frames since anything moved
  bool touched_ = false;  ///< there was input, so the walk does not end by itself
  bool stop_ = false;
  bool presented_ = false;  ///< compose() presented the renderer's own picture
  std::optional<Camera> referenceCamera_;  ///< the camera of the reference
  std::uint64_t referenceVersion_ = 0;  ///< version of the reference's scene
  TimeShare referenceTime_;
  int frames_ = 0;
  double seconds_ = 0.0, sinceHint_ = 0.0;
  int framesOfTitle_ = 0;
  Clock::time_point lastBreath_{}, judged_{};
  int judgedFrame_ = 0;
};

}  // namespace lucerna::demo
