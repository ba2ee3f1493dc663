// The walkthrough in a window, or driven by recorded input on any host: input, camera, renderers of both sides, what is
// presented. Overlay, ReferenceWork and Recorder do the rest.
#pragma once

#include "base/clock.hpp"
#include "walk/input_file.hpp"
#include "walk/keys.hpp"
#include "walk/options.hpp"
#include "walk/motion_scale.hpp"
#include "walk/overlay.hpp"
#include "walk/recorder.hpp"
#include "walk/reference_work.hpp"
#include "shared/stage_view.hpp"
#include "walk/state.hpp"
#include "walk/ui.hpp"

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
  bool takeStep();  ///< acts on input_; false: the walk ends
  void steer(bool pointing);
  void act(Action action);
  void stepThrough(std::vector<Edit>& from, std::vector<Edit>& to);
  void noteEdits();
  void moveScene(double seconds);
  bool relight();
  void follow(const SceneChange& change);
  void moveCamera(double seconds);
  void loadWantedScene();
  void makeReady();
  std::string wantedOf(const PictureOptions& options) const;  ///< of builtAs, were it up to date
  void make(SideState& side);
  void takeBack(SideState& side);
  bool mayVary() const;
  std::unique_ptr<Renderer> preview(const Scene& scene, PictureOptions& options);
  bool isWanted() const;
  bool drawBetween();
  void measureLpvSteps();
  bool showsLpvStep() const;
  void draw();
  void makeReference(double frameSeconds);
  bool allSettled() const;
  void compose();
  void showDebugView(Compare::Inputs& inputs);
  void makeHemicube(const Compare::Inputs& inputs);
  void readPixel(const Compare::Inputs& inputs);
  void inspectPixel(const Compare::Inputs& inputs);
  void pace(Clock::time_point start);
  bool rests() const;
  double distanceOfCentre() const;

  /// Called during long work: shows the old picture and a note of what is being done. Throws Stopped if Escape was
  /// pressed.
  void breathe(const std::string& what, double share = -1.0);
  /// Called between the passes by which radiosity is solved: draws a frame. False: to stop.
  bool goesOnSolving(const RadiosityStage& stage);
  void resizeTo(glm::ivec2 window);
  void buildUi(double seconds);
  void drawUi(double seconds);
  bool drawsUi() const;
  Recorder::Shown shownPicture() const { return {picture_, view_}; }
  glm::ivec2 pictureSize() const;  ///< size of the computed picture
  /// Gives the renderers that size; whether any had another one.
  bool resizePictures();
  bool mayBeCoarse() const;
  const gl::Texture* radianceOf(int side) const;
  void changed() {
    still_ = 0;
    restSeconds_ = 0.0;
  }

  const WalkOptions& options_;
  Host& host_;
  const gl::Context& context_;
  gl::ProgramLibrary& programs_;
  WalkState state_;
  Overlay overlay_;
  ReferenceWork reference_;
  Recorder recorder_;
  std::optional<Ui> ui_;
  std::optional<InputPlayer> player_;
  std::optional<Compare> compare_;
  std::optional<StageView> stageView_;
  std::unique_ptr<SolutionWatch> solutions_;
  HostInput input_;  ///< the step that is acted on
  HostInput walking_;  ///< keys of movement that were held in any step of this frame
  std::optional<double> orbitDistance_;  ///< of the point that the mouse moves around, while a button is held
  Edit lastEdit_;
  LightState shownLights_;  ///< of the scene that renderers were last made of
  double followSeconds_ = 0.0;  ///< that the last change of lights took to follow, or to make renderers anew
  glm::dvec2 cursorBefore_{0.0};
  bool leftBefore_ = false;  ///< the left button was held in the last frame
  glm::ivec2 window_{0}, playedSize_{0};
  glm::ivec2 view_{0};  ///< the window without the panel: the area of the picture
  gl::Texture picture_;  ///< what is presented, unless it is the renderer's own picture
  gl::Framebuffer pictureTarget_;
  Camera lastCamera_;
  int still_ = 0;  ///< frames since anything moved, or the picture's size changed
  double restSeconds_ = 0.0;  ///< since anything moved
  MotionScale motionScale_;
  int quiet_ = 0;  ///< frames since there was input
  bool touched_ = false;  ///< there was input, so the walk does not end by itself
  bool stop_ = false;
  const SideState* made_ = nullptr;  ///< the side that is being made, of a technique that is solved
  std::string madeAs_;  ///< as SideState::builtAs
  bool drawsBetween_ = false;  ///< a frame while it is being made
  bool hasSolved_ = false;  ///< in this frame
  double frameBetween_ = 0.0;  ///< seconds that the last such frame took
  bool presented_ = false;  ///< compose() presented the renderer's own picture
  int frames_ = 0;
  double seconds_ = 0.0, sinceHint_ = 0.0;
  int framesOfTitle_ = 0;
  Clock::time_point lastBreath_{};
};

}  // namespace lucerna::demo
