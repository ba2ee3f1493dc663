// The walkthrough in a window, or driven by recorded input on any host: path and free camera, panel, comparison, live
// truth.
#pragma once

#include "base/clock.hpp"
#include "base/time_share.hpp"
#include "walk/gizmo.hpp"
#include "walk/input_file.hpp"
#include "walk/keys.hpp"
#include "walk/options.hpp"
#include "walk/renderdoc.hpp"
#include "walk/stage_view.hpp"
#include "walk/state.hpp"
#include "walk/ui.hpp"
#include "walk/video.hpp"

#include <chrono>

namespace lucerna::demo {

class WalkWindow {
 public:
  /// `state`: with scene, path and the first technique's renderer.
  WalkWindow(const WalkOptions& options, Host& host, const gl::Context& context, gl::ProgramLibrary& programs,
             WalkState state);
  ~WalkWindow();

  /// Until it is closed, the path ends or --frames are drawn.
  void run();

  int frames() const { return frames_; }
  double seconds() const { return seconds_; }
  WalkState& state() { return state_; }
  /// What a driven run did: controls, messages.
  nlohmann::ordered_json toJson() const;

 private:
  // A frame, in this order.
  bool takeInput();  ///< false: it is to end
  void act(Action action);
  void moveCamera(double seconds);
  void loadWantedScene();
  void makeReady();
  void make(SideState& side);
  void draw();
  void makeTruth(double frameSeconds);
  bool seekTruth();
  void judge();
  bool allSettled() const;
  void compose();
  void readPixel(const Compare::Inputs& inputs);
  void askPixel(const Compare::Inputs& inputs);
  void drawLines(const Compare::Inputs& inputs);
  void drawGlyphs(const Compare::Inputs& inputs);
  void drawGizmo(const Compare::Inputs& inputs);
  void takeShot();
  void recordVideo(double seconds);
  void beginCapture();
  void endCapture();
  void pace(Clock::time_point start);

  /// Called while something long is made: shows the old picture with what is going on; throws Stopped where Escape was
  /// pressed.
  void breathe(const std::string& what, double share = -1.0);
  void resizeTo(glm::ivec2 window);
  void drawUi(const HostInput& input, double seconds, const std::string& work, double share);
  bool drawsUi() const;
  Bitmap shownPicture(glm::ivec2 size) const;
  glm::ivec2 pictureSize() const;  ///< that is computed
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
  std::optional<Gizmo::Screen> screen_;  ///< of the last frame
  std::vector<gl::Lines::Line> glyphs_;
  std::string glyphsAre_;  ///< what glyphs_ was made of
  std::optional<Video> video_;
  std::optional<RenderDoc> renderDoc_;
  bool captures_ = false;  ///< this frame
  HostInput input_;
  glm::dvec2 cursorBefore_{0.0};
  bool leftBefore_ = false;  ///< the left button was held
  glm::ivec2 window_{0}, playedSize_{0};
  glm::ivec2 view_{0};  ///< the window less the panel: where the picture is
  gl::Texture picture_;  ///< what is presented, where that is not the renderer's own
  gl::Framebuffer pictureTarget_;
  Camera lastCamera_;
  int still_ = 0;  ///< frames since something moved
  bool touched_ = false;  ///< somebody is there: the walk does not end by itself; nor with the panel
  bool stop_ = false;
  bool presented_ = false;  ///< compose() showed the renderer's own picture
  std::optional<Camera> truthCamera_;  ///< that the truth is of
  std::uint64_t truthVersion_ = 0;  ///< of the scene that the truth is of
  TimeShare truthTime_;
  int frames_ = 0;
  double seconds_ = 0.0, sinceHint_ = 0.0;
  int framesOfTitle_ = 0;
  Clock::time_point lastBreath_{}, judged_{};
  int judgedFrame_ = 0;
};

}  // namespace lucerna::demo
