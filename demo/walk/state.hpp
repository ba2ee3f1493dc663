// The window's entire state, which the panel changes: the scene, the view, two techniques, how they are compared.
// Plain data: window.cpp acts on it once a frame, panel.cpp displays it.
#pragma once

#include "shared/commands.hpp"
#include "shared/glyphs.hpp"
#include "scene/key_frames.hpp"
#include "scene/motion.hpp"
#include "walk/compare.hpp"
#include "walk/free_camera.hpp"
#include "walk/scene_views.hpp"
#include "walk/hemicube_view.hpp"
#include "walk/live_reference.hpp"
#include "walk/lpv_steps.hpp"
#include "walk/solving.hpp"

#include <array>
#include <deque>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace lucerna::demo {

/// What a side of the comparison shows.
enum class Shows { technique, reference, picture };
constexpr std::array<std::string_view, 3> kShowsNames{"a technique", "the reference", "a stored picture"};

/// Lights of a scene, as far as the panel changes them.
struct LightState {
  std::optional<DirectionalLight> sun;
  std::vector<SpotLight> spots;
  std::vector<PointLight> points;
  glm::vec3 sky{0.0f};  ///< factor of the environment
  float emission = 1.0f;  ///< factor of all emissive materials
};

/// A or B.
struct SideState {
  PictureOptions options;  ///< requested
  Shows shows = Shows::technique;
  std::string pictureFile;

  // Built state. The renderer belongs to `built`; it stays visible until one for `options` is ready.
  std::unique_ptr<Renderer> renderer;
  PictureOptions built;
  std::string builtAs, failedAs;  ///< textOf() of options, with the scene's version
  LightState lights;  ///< of the renderer
  SceneChange missed;  ///< changes of the scene that the renderer could not follow, or that take their time
  std::string failure;  ///< why the options could not be applied; empty: they could
  double buildSeconds = 0.0;
  std::optional<gl::Texture> picture;
  std::string pictureShown;  ///< the file of `picture`
  bool settled = false;  ///< the picture stays the same until something moves
  std::uint64_t pictureVersion = 0, judgedPicture = 0, judgedReference = 0;
  Judgement judgement;
};

/// A camera path and the current position on it.
struct PathState {
  std::optional<Spline> spline;
  int first = 0, last = 0;  ///< views
  bool follows = true, paused = false, loops = false;
  double seconds = 0.0, speed = 1.0;
  double duration() const { return SplinePlayback(last - first + 1).duration(); }
};

/// The time of a scene that moves.
struct TimeState {
  bool held = false, loops = true;
  double seconds = 0.0, speed = 1.0;
};

/// What undo and redo step through.
struct Edit {
  std::array<PictureOptions, 2> options;
  LightState lights;
};

struct WalkState {
  // Scene
  std::unique_ptr<Scene> scene;
  std::uint64_t sceneVersion = 1;  ///< incremented when lights or materials change
  std::string sceneText;  ///< of the panel's text field
  std::optional<std::filesystem::path> sceneToLoad;
  bool floor = true;  ///< add the studio's floor under loaded scenes without light of their own
  float emissionFactor = 1.0f;
  bool movesLamps = false;  ///< by axes drawn in the picture
  std::vector<Material> materialsAsLoaded;

  TimeState time;
  bool timeRuns() const;  ///< and with it the scene: no reference is one of now

  // Camera
  PathState path;
  std::optional<FreeCamera> camera;
  bool orbits = false;  ///< the mouse moves around a point, not the view
  std::vector<KeyFrame> keyFrames;  ///< recorded
  std::string keyFramesFile = "key_frames.txt";

  // Techniques
  std::array<SideState, 2> sides;
  int shown = 0;  ///< visible side, if the layout is one picture
  int edited = 0;  ///< side edited by the settings section
  std::vector<Edit> undo, redo;  ///< the latest last
  std::string settingsFilter;
  SolvingState solving;

  // Comparison
  Layout layout = Layout::one;
  Show show = Show::picture;
  float split = 0.5f, zoom = 1.0f, errorScale = 0.0f;  ///< errorScale 0: a tenth of the mean
  glm::vec2 centre{0.5f};
  bool magnifier = false;
  float exposure = 1.0f;
  bool autoExposure = false;
  float renderScale = 1.0f;  ///< picture's side over the window's; 2: four samples per pixel
  bool coarseInMotion = true;  ///< motion_scale.hpp, if this is not measured or recorded
  float motionScale = 1.0f;  ///< that of the last frame

  // Debug view
  std::string stage;  ///< one of the shown side's Renderer::stagePictures(); empty: the frame
  int stageLayer = 0;
  float stageFactor = 0.0f;  ///< exponent of two, scales flux
  CountView countView = CountView::none;
  float countWhite = 32.0f;
  std::unique_ptr<CountViews> countViews;
  bool lpvStepsWanted = false;
  std::unique_ptr<LpvSteps> lpvSteps;  ///< of the view at which they were asked for
  int lpvStep = -1;  ///< shown instead of the picture; negative: none
  std::unique_ptr<HemicubeView> hemicube;  ///< shown instead of the picture
  bool hemicubeWanted = false, hemicubeByClick = false;  ///< of the middle pixel; of one that is clicked on
  std::optional<glm::dvec2> hemicubePlace;  ///< in the window
  Glyphs glyphs = Glyphs::none;
  int glyphCascade = MAX_CASCADES - 1, glyphLevel = 1, glyphMost = 400;

  // Reference
  bool liveReferenceOn = false;
  float referenceShare = 0.1f;  ///< of a frame's time
  bool referenceDenoised = false;  ///< its picture, not what is judged against
  std::unique_ptr<LiveReference> reference;

  // Window
  bool panel = true, help = false, hint = true;
  bool asksToEnd = false;
  bool drawsAtRest = false;  ///< also when nothing changes any more, for timings
  bool swapAtRefresh = true;
  int frameLimit = 0;  ///< frames per second; 0: none
  float budgetMs = 16.7f;
  std::filesystem::path shotFolder = ".";
  bool shotWanted = false, meterWanted = false, reloadWanted = false, endWanted = false;
  bool records = false;  ///< a video
  bool canRecord = false;  ///< ffmpeg is installed
  std::string recording;  ///< the video being recorded, and its length; empty: none
  bool canCapture = false, captureWanted = false;  ///< capture a frame for RenderDoc
  std::deque<std::string> messages;  ///< newest last
  double messageAge = 0.0;  ///< seconds
  std::vector<float> frameMs;  ///< recent frames
  std::string rendererName;

  // The inspected pixel, and what lit it.
  bool inspectsByClick = false, drawsAnswer = true;
  std::optional<glm::dvec2> inspectedPlace;  ///< in the window, to be queried in this frame
  std::optional<PixelInspection> answer;
  int inspectedSide = 0;
  bool answerIsNew = false;
  int pointedShare = -1;  ///< index of the share under the cursor

  // Pixel under the cursor, for the magnifier.
  std::optional<glm::ivec2> pixel;  ///< from the picture's top left
  struct PixelValues {
    std::optional<glm::vec3> a, b, reference, error;
  } values;

  void say(std::string message) {
    messages.push_back(std::move(message));
    if (messages.size() > 50) messages.pop_front();
    messageAge = 0.0;
  }
  SideState& side() { return sides[static_cast<std::size_t>(shown)]; }
  const SideState& side() const { return sides[static_cast<std::size_t>(shown)]; }
  /// Whether a side is on the screen.
  bool isVisible(int side) const { return layout != Layout::one || side == shown; }
};

LightState lightsOf(const WalkState& state);
void setLights(WalkState& state, const LightState& lights);
/// Scales all emissive materials, relative to how they were loaded.
void setEmission(WalkState& state, float factor);
/// What differs between the lights of one scene.
SceneChange changeOf(const LightState& before, const LightState& now);
/// The options as text: equal texts give equal pictures.
std::string textOf(const PictureOptions& options);
/// Switches to another technique with its defaults: settings and deviations of the previous one do not apply.
void chooseTechnique(PictureOptions& options, const std::string& technique);
/// `lucerna render ...` or `walk` with these options.
std::string commandLine(const std::string& command, const std::string& scene, const PictureOptions& options);
/// Sets KEY=VALUE, replacing any earlier assignment of the key; an empty value removes it.
void assign(std::vector<std::string>& assignments, const std::string& key, const std::string& value);
/// The argument of --camera.
std::string cameraText(const Scene& scene, const Camera& camera);

}  // namespace lucerna::demo
