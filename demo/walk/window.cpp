#include "walk/window.hpp"

#include "inspect.hpp"
#include "base/clock.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/log.hpp"
#include "base/statistics.hpp"
#include "gl/build_watch.hpp"
#include "gl/draw.hpp"
#include "gl/pass.hpp"
#include "gl/read_pictures.hpp"
#include "lpv/lpv_frame.hpp"
#include "radiosity/radiosity_frame.hpp"
#include "render/techniques.hpp"
#include "scene/motion.hpp"
#include "scene/studio.hpp"
#include "walk/labels.hpp"
#include "walk/panel.hpp"
#include "shared/paths.hpp"
#include "walk/pixel_section.hpp"
#include "walk/recent_files.hpp"
#include "shared/shipped_scenes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <thread>

namespace lucerna::demo {

namespace {

namespace fs = std::filesystem;

constexpr double kPlayedFrame =
    1.0 / 60.0;  // seconds per frame of recorded input, so that the walk is the same on every machine
constexpr double kMessageSeconds = 8.0, kHintSeconds = 8.0;
constexpr double kLongestStep = 0.25;  // seconds by which the path advances in one frame
constexpr double kRest = 0.25;  // seconds between looks at whether the program was interrupted, while nothing changes
constexpr double kSmoothSeconds = 0.3;  // slower changes of light wait until the mouse button is released
constexpr double kBetweenFrames = 1.0 / 30.0, kBetweenNotes = 0.1;  // seconds, while a solution is made
constexpr double kLongGap = 0.3;  // seconds, to be told
constexpr std::size_t kMostEdits = 100;
constexpr double kRestsFrom = 0.3;  // seconds without motion until the picture becomes whole
constexpr int kStillFrames = 3;  // still frames before the reference of a view is started
constexpr std::size_t kPlotFrames = 240;

/// Whether a technique needs minutes before its first picture.
bool solves(std::string_view technique) {
  return std::ranges::any_of(techniqueNamed(technique).settings,
                             [](const Setting& setting) { return setting.cost == SettingCost::solution; });
}

bool isPicture(const fs::path& file) {
  const std::string extension = lowerExtension(file);
  return extension == ".png" || extension == ".jpg" || extension == ".hdr" || extension == ".exr" ||
         extension == ".pfm";
}

}  // namespace

WalkWindow::WalkWindow(const WalkOptions& options, Host& host, const gl::Context& context, gl::ProgramLibrary& programs,
                       WalkState state)
    : options_(options),
      host_(host),
      context_(context),
      programs_(programs),
      state_(std::move(state)),
      overlay_(programs, state_),
      reference_(context, programs, state_),
      recorder_(state_),
      solutions_(watchSolutions([this](const RadiosityStage& stage) { return goesOnSolving(stage); }, true)),
      motionScale_(context.capabilities().softwareRenderer) {
  state_.rendererName = context.capabilities().renderer;
  if (!options.playInput.empty()) player_.emplace(options.playInput);
  playedSize_ = parseSize(options.picture.size);
  state_.swapAtRefresh = host.swapInterval().value_or(0) > 0;
}

WalkWindow::~WalkWindow() {
  if (state_.reference) state_.reference->keep();
}

// ---------------------------------------------------------------------------------------------------- input

bool WalkWindow::takeInput() {
  host_.pump();  // the system must see that the window responds
  if (player_) {
    if (player_->done() && options_.frames == 0) return false;
    while (host_.input().waits()) host_.input().take();
    if (!ui_) ui_.emplace(programs_, host_, host_.contentScale());
    player_->next(&*ui_);
    if (const auto size = player_->takeSize()) {
      playedSize_ = *size;
      host_.setWindowSize(*size);
    }
  }
  InputState& source = player_ ? player_->input() : host_.input();
  if (source.waits()) quiet_ = 0;
  walking_ = {};
  for (bool more = true; more;) {
    input_ = source.take();
    if (!takeStep()) return false;
    more = source.waits();
    if (!more || !ui_ || !drawsUi()) continue;
    buildUi(0.0);
    ui_->drop();
  }
  return true;
}

bool WalkWindow::takeStep() {
  if (input_.closeRequested || interrupted()) return false;
  const bool typing = ui_ && ui_->wantsKeyboard(), pointing = ui_ && drawsUi() && ui_->wantsMouse(input_);
  const bool listIsOpen = ui_ && ui_->showsList();
  if (typing) input_.move = glm::dvec3(0.0);
  touched_ = touched_ || !input_.keys.empty() || input_.buttons[0] || input_.buttons[1] || !input_.dropped.empty();
  for (const KeyEvent& event : input_.keys) {
    if (state_.asksToEnd && event.down && event.key == key::kEnter) state_.endWanted = true;
    const auto action = actionOf(event);
    if (!action || (listIsOpen && *action == Action::end)) continue;  // Escape closes the list
    if (!typing || *action == Action::help || *action == Action::panel) act(*action);
  }
  steer(pointing);
  for (const fs::path& file : input_.dropped) {
    if (isPicture(file)) {
      SideState& b = state_.sides[1];
      b.shows = Shows::picture;
      b.pictureFile = file.string();
      if (state_.layout == Layout::one) state_.layout = Layout::wipe;
    } else {
      state_.sceneToLoad = file;
    }
  }
  return !state_.endWanted && !stop_;
}

/// What the mouse does in the picture, and the keys that move.
void WalkWindow::steer(bool pointing) {
  const bool left = input_.holds(MouseButton::left);
  if (input_.move != glm::dvec3(0.0)) {
    walking_.move = input_.move;
    walking_.fast = input_.fast;
    state_.path.follows = false;
  }
  if (!left && !input_.holds(MouseButton::middle)) orbitDistance_.reset();
  if (pointing) {
    leftBefore_ = left;
    cursorBefore_ = input_.cursor;
    return;
  }
  const glm::vec2 pixels(glm::max(view_, glm::ivec2(1)));
  if (input_.holds(MouseButton::right) && state_.layout == Layout::wipe)
    state_.split = std::clamp(static_cast<float>(input_.cursor.x) / pixels.x, 0.0f, 1.0f);
  if (overlay_.drags(glm::vec2(input_.cursor), left)) {
    changed();
  } else if (state_.hemicubeByClick) {
    if (left && !leftBefore_) state_.hemicubePlace = input_.cursor;
  } else if (state_.inspectsByClick) {
    if (left && !leftBefore_) state_.inspectedPlace = input_.cursor;
  } else if (state_.orbits) {
    if (input_.mouseDelta != glm::dvec2(0.0) || input_.wheel.y != 0.0) {
      if (!orbitDistance_) orbitDistance_ = distanceOfCentre();
      state_.path.follows = false;
      state_.camera->orbit(input_, *orbitDistance_, view_.y);
      if (input_.wheel.y != 0.0) orbitDistance_.reset();
    }
  } else if (left && input_.mouseDelta != glm::dvec2(0.0)) {
    state_.path.follows = false;
    state_.camera->look(input_);
  }
  if (!state_.orbits) {
    if (input_.wheel.y != 0.0)
      state_.zoom = std::clamp(state_.zoom * static_cast<float>(std::exp2(0.25 * input_.wheel.y)), 1.0f, 64.0f);
    if (input_.holds(MouseButton::middle))
      state_.centre = glm::clamp(
          state_.centre - glm::vec2(1.0f, -1.0f) * glm::vec2(input_.cursor - cursorBefore_) / pixels / state_.zoom,
          0.0f, 1.0f);
  }
  if (state_.zoom == 1.0f) state_.centre = glm::vec2(0.5f);
  leftBefore_ = left;
  cursorBefore_ = input_.cursor;
}

/// How far the surface in the middle of the picture is; where there is none, the middle of the scene.
double WalkWindow::distanceOfCentre() const {
  const Camera& camera = state_.camera->camera();
  const double radius = 0.5 * std::max(glm::length(state_.scene->bounds.extent()), 1e-9);
  const double toCentre = glm::dot(state_.scene->bounds.centre() - camera.position, camera.direction);
  const double usual = toCentre > 1e-3 * radius ? toCentre : radius;
  const SideState& side = state_.side();
  if (!side.renderer || !side.renderer->depth()) return usual;
  const gl::Texture& depth = *side.renderer->depth();
  const gl::Texture one("pixel", depth.format(), glm::ivec2(1));
  gl::copyTexels(depth, depth.size2d() / 2, one, {0, 0}, {1, 1});
  const float z = one.readDepth().front();
  if (z >= 1.0f) return usual;
  const gl::Lines::View view = side.renderer->linesView(camera, state_.scene->bounds);
  const glm::dvec4 at = glm::inverse(glm::dmat4(view.clipFromWorld)) * glm::dvec4(0.0, 0.0, 2.0 * z - 1.0, 1.0);
  const double distance = glm::dot(glm::dvec3(at) / at.w + side.renderer->origin() - camera.position, camera.direction);
  return std::isfinite(distance) && distance > 0.0 ? distance : usual;
}

void WalkWindow::act(Action action) {
  WalkState& s = state_;
  const auto technique = [&](const char* name) {
    s.side().shows = Shows::technique;
    chooseTechnique(s.side().options, name);
  };
  switch (action) {
    case Action::help: s.help = !s.help; break;
    case Action::panel: s.panel = !s.panel; break;
    case Action::reload: s.reloadWanted = true; break;
    case Action::fullScreen: host_.setFullScreen(!host_.isFullScreen()); break;
    case Action::shot: s.shotWanted = true; break;
    case Action::video: s.records = !s.records; break;
    case Action::capture: s.captureWanted = true; break;
    case Action::end:
      if (s.help) s.help = false;
      else if (s.solving.isOn() && !s.asksToEnd) s.solving.cancelled = true;
      else if (s.hemicube && !s.asksToEnd) s.hemicube.reset();
      else s.asksToEnd = !s.asksToEnd;
      break;
    case Action::pause: s.path.paused = !s.path.paused; break;
    case Action::hold:
      s.time.held = !s.time.held;
      if (s.scene->motion) s.say(fmt::format("{} at {:.2f} s", s.time.held ? "held" : "goes on", s.time.seconds));
      else s.say("nothing moves in this scene");
      break;
    case Action::follow: s.path.follows = !s.path.follows; break;
    case Action::slower: s.path.speed = std::max(s.path.speed / 2.0, 1.0 / 64.0); break;
    case Action::faster: s.path.speed = std::min(s.path.speed * 2.0, 64.0); break;
    case Action::loop: s.path.loops = !s.path.loops; break;
    case Action::addKeyFrame: {
      const Camera& c = s.camera->camera();
      s.keyFrames.push_back({c.position, c.direction, c.up, c.verticalFov});
      s.say(fmt::format("{} key frames", s.keyFrames.size()));
      break;
    }
    case Action::darker: s.exposure /= 1.25f; break;
    case Action::brighter: s.exposure *= 1.25f; break;
    case Action::autoExposure: s.autoExposure = !s.autoExposure; break;
    case Action::direct: technique("direct"); break;
    case Action::rsm: technique("rsm"); break;
    case Action::lpv: technique("lpv"); break;
    case Action::cache: technique("irradiance-cache"); break;
    case Action::radiosity: technique("radiosity"); break;
    case Action::path:
      s.sides[static_cast<std::size_t>(s.layout == Layout::one ? s.shown : 1)].shows = Shows::reference;
      s.liveReferenceOn = true;
      if (s.timeRuns()) s.say("the reference is shown when time and view rest: P holds the time");
      break;
    case Action::undo: stepThrough(s.undo, s.redo); break;
    case Action::redo: stepThrough(s.redo, s.undo); break;
    case Action::orbit:
      s.orbits = !s.orbits;
      s.say(s.orbits ? "the mouse moves around what is in the middle" : "the mouse looks around");
      break;
    case Action::flicker: s.shown = 1 - s.shown; break;
    case Action::wipe: s.layout = s.layout == Layout::wipe ? Layout::one : Layout::wipe; break;
    case Action::sideBySide: s.layout = s.layout == Layout::sideBySide ? Layout::one : Layout::sideBySide; break;
    case Action::reprojection:
      for (SideState& side : s.sides)
        if (side.renderer && readWith(*findSetting("picture.reprojection"), side.renderer->settings().technique))
          assign(side.options.settings, "picture.reprojection", side.renderer->settings().reprojection ? "off" : "");
      break;
    case Action::magnifier: s.magnifier = !s.magnifier; break;
    case Action::nextView:
      s.show = static_cast<Show>((static_cast<int>(s.show) + 1) % static_cast<int>(kShowNames.size()));
      break;
    case Action::liveReference: s.liveReferenceOn = !s.liveReferenceOn; break;
    case Action::inspect: s.inspectedPlace = input_.cursor; break;
    case Action::fit:
      s.zoom = 1.0f;
      s.centre = glm::vec2(0.5f);
      break;
  }
}

void WalkWindow::stepThrough(std::vector<Edit>& from, std::vector<Edit>& to) {
  noteEdits();
  if (from.empty()) return;
  const std::string lights = changeOf(lastEdit_.lights, from.back().lights).any() ? "light" : "settings";
  to.push_back(std::exchange(lastEdit_, from.back()));
  from.pop_back();
  for (std::size_t i = 0; i < 2; ++i) state_.sides[i].options = lastEdit_.options[i];
  if (!state_.scene->motion) setLights(state_, lastEdit_.lights);
  state_.say(fmt::format("{} {}", lights, &from == &state_.undo ? "as before" : "made again"));
}

/// Finds what has been edited since, once it is done: a drag is one edit. Curves move lights of their own.
void WalkWindow::noteEdits() {
  if (input_.holdsAnyButton() || !state_.sides[0].failedAs.empty() || !state_.sides[1].failedAs.empty()) return;
  Edit now{{state_.sides[0].options, state_.sides[1].options}, lightsOf(state_)};
  if (state_.scene->motion) now.lights = lastEdit_.lights;
  const bool same = textOf(now.options[0]) == textOf(lastEdit_.options[0]) &&
                    textOf(now.options[1]) == textOf(lastEdit_.options[1]) &&
                    !changeOf(lastEdit_.lights, now.lights).any();
  if (same) return;
  state_.undo.push_back(std::exchange(lastEdit_, now));
  if (state_.undo.size() > kMostEdits) state_.undo.erase(state_.undo.begin());
  state_.redo.clear();
}

// ---------------------------------------------------------------------------------------------------- frame steps

// A scene that moves: renderers follow it, or are made anew where they cannot.
void WalkWindow::moveScene(double seconds) {
  if (!state_.scene->motion) return;
  TimeState& time = state_.time;
  const double end = state_.scene->motion->end;
  if (!time.held && frames_ > 0) time.seconds += std::min(seconds, kLongestStep) * time.speed;
  if (time.seconds > end) time.seconds = time.loops && end > 0.0 ? std::fmod(time.seconds, end) : end;
  if (time.seconds == state_.scene->time) return;
  const float exposure = state_.scene->exposure;
  const SceneChange change = poseAt(*state_.scene, time.seconds);
  shownLights_ = lightsOf(state_);
  if (state_.scene->exposure != exposure) state_.exposure = state_.scene->exposure;
  follow(change);
}

/// The lights as they were set since the last frame. Whether they have changed.
bool WalkWindow::relight() {
  const LightState now = lightsOf(state_);
  const SceneChange change = changeOf(shownLights_, now);
  const bool held = input_.holds(MouseButton::left);
  if (!change.any() || (held && followSeconds_ > kSmoothSeconds)) return false;
  shownLights_ = now;
  follow(change);
  return true;
}

/// The scene has changed: renderers follow it, or are made anew where they cannot.
void WalkWindow::follow(const SceneChange& change) {
  if (!change.any()) return;
  ++state_.sceneVersion;
  for (SideState& side : state_.sides) {
    side.judgement.clear();
    // One of other options follows too: it is shown until the one for these is made. A solution takes its time (make).
    const bool isSolved = side.renderer && radiosityOf(side.renderer->technique());
    if (isSolved || side.missed.any() || !side.renderer ||
        !side.renderer->follow(context_, programs_, *state_.scene, change)) {
      side.missed.add(change);
    } else {
      side.builtAs = wantedOf(side.built);
      side.lights = lightsOf(state_);
    }
    side.settled = false;
  }
  changed();
}

void WalkWindow::moveCamera(double seconds) {
  PathState& path = state_.path;
  if (path.follows) {
    // A viewer should miss nothing of the path, however slow the frames are. A measurement needs real time.
    const bool measures = !options_.common.json.empty() && !player_;
    const double step = measures ? seconds : std::min(seconds, kLongestStep);
    if (!path.paused && frames_ > 0) path.seconds += step * path.speed;
    const SplinePlayback playback(path.last - path.first + 1);
    auto view = playback.viewAt(path.seconds);
    if (!view && path.loops) {
      path.seconds = std::fmod(path.seconds, playback.duration());
      view = playback.viewAt(path.seconds);
    }
    if (!view) {
      stop_ = !touched_ && (!state_.panel || player_);  // no input so far, and no panel that could be used
      path.seconds = playback.duration();
      path.paused = true;
      view = path.last - path.first;
    }
    state_.camera->place(path.spline->view(path.first + *view));
  } else {
    state_.camera->move(walking_, std::min(seconds, 0.1));  // a slow frame must not fling the camera across the room
  }
  if (!state_.camera->camera().seesAs(lastCamera_)) changed();
  lastCamera_ = state_.camera->camera();
}

void WalkWindow::loadWantedScene() {
  if (!state_.sceneToLoad) return;
  const fs::path wanted = *std::exchange(state_.sceneToLoad, std::nullopt);
  try {
    checkSceneName(wanted.string());
    const fs::path file = sceneFileOf(wanted.string());
    breathe("loading " + file.filename().string());
    auto scene = std::make_unique<Scene>(loadScene(file));
    if (state_.floor && scene->studio) addFloor(*scene);
    Spline path = pathOf(*scene);
    RenderSettings settings = state_.sides[0].options.parse();
    settings.size = state_.sides[0].renderer->size();
    const bool isSolved = solves(settings.technique) && mayVary();
    PictureOptions shown = state_.sides[0].options;
    const gl::BuildWatch watch([this](const std::string& name) { breathe("compiling " + name); });
    auto renderer =
        isSolved ? preview(*scene, shown) : std::make_unique<Renderer>(context_, programs_, *scene, settings);
    // Nothing can fail from here on: the new scene replaces the old one.
    state_.reference.reset();
    state_.countViews.reset();
    state_.lpvSteps.reset();
    state_.hemicube.reset();
    for (SideState& side : state_.sides) {
      side.renderer.reset();
      side.builtAs.clear();
      side.failedAs.clear();
    }
    state_.scene = std::move(scene);
    ++state_.sceneVersion;
    state_.answer.reset();
    state_.emissionFactor = 1.0f;
    state_.materialsAsLoaded = state_.scene->materials;
    state_.undo.clear();
    state_.redo.clear();
    lastEdit_.lights = shownLights_ = lightsOf(state_);
    SideState& a = state_.sides[0];
    a.renderer = std::move(renderer);
    a.built = shown;
    a.builtAs = wantedOf(a.built);
    a.lights = lightsOf(state_);
    a.missed = {};
    state_.sceneText = file.string();
    if (host_.kind() == HostKind::window && !player_) rememberFile(file);
    state_.path.spline = std::move(path);
    state_.path.first = 0;
    state_.path.last = state_.path.spline->viewCount() - 1;
    state_.path.seconds = 0.0;
    state_.time = {};
    state_.path.follows = false;
    state_.camera.emplace(state_.scene->cameras.front(), 0.08 * glm::length(state_.scene->bounds.extent()));
    state_.exposure = state_.scene->exposure;
    host_.setTitle("Lucerna - " + state_.scene->name);
    state_.say(fmt::format("{}: {} triangles", state_.scene->name, state_.scene->triangleCount()));
    changed();
  } catch (const Error& error) { state_.say(error.what()); } catch (const Stopped&) {
    state_.say("loading stopped");
  }
}

std::string WalkWindow::wantedOf(const PictureOptions& options) const {
  return textOf(options) + fmt::format(" {}", state_.sceneVersion);
}

void WalkWindow::make(SideState& side) {
  if (side.shows == Shows::picture) {
    if (side.pictureFile != side.pictureShown) {
      side.pictureShown = side.pictureFile;
      try {
        side.picture = textureOf("stored picture", readImage(side.pictureFile));
        side.judgedReference = 0;
        ++side.pictureVersion;
      } catch (const Error& error) { state_.say(error.what()); }
    }
    if (side.picture) return;
  }
  const std::string wanted = wantedOf(side.options);
  if (side.shows != Shows::technique && side.renderer) return;
  if (wanted == side.builtAs || wanted == side.failedAs) return;
  const bool first = !state_.sides[0].renderer;
  const auto endSolving = [this] {
    hasSolved_ = hasSolved_ || made_;
    state_.solving.end();
    made_ = nullptr;
    drawsBetween_ = false;
  };
  try {
    RenderSettings settings = side.options.parse();
    settings.size = pictureSize();
    const auto start = Clock::now();
    const bool isSame = side.renderer && side.missed.any() && textOf(side.options) == textOf(side.built);
    if (!isSame) breathe("making technique " + side.options.technique);
    const gl::BuildWatch watch([this](const std::string& name) { breathe("compiling " + name); });
    if (solves(settings.technique)) {
      state_.solving.begin();
      if (mayVary()) {
        if (!side.renderer) {
          side.built = side.options;
          side.renderer = preview(*state_.scene, side.built);
          side.builtAs = wantedOf(side.built);
          side.lights = lightsOf(state_);
          side.missed = {};
        }
        made_ = &side;
        madeAs_ = wanted;
      }
    }
    std::unique_ptr<Renderer> renderer;
    if (!isSame || !side.renderer->follow(context_, programs_, *state_.scene, side.missed))
      renderer = std::make_unique<Renderer>(context_, programs_, *state_.scene, settings);
    endSolving();
    if (renderer) {
      lastBreath_ = {};  // a driver may compile its programs only now
      breathe("drawing the first picture by " + side.options.technique);
      side.renderer = std::move(renderer);
      // The first is told last, and stays.
      const std::vector<std::string>& warnings = side.renderer->warnings();
      for (auto warning = warnings.rbegin(); warning != warnings.rend(); ++warning) state_.say(*warning);
    }
    side.lights = lightsOf(state_);
    state_.hemicube.reset();
    side.missed = {};
    side.buildSeconds = secondsSince(start);
    side.failure.clear();
    side.failedAs.clear();
    side.built = side.options;
    side.builtAs = wanted;
    side.settled = false;
    side.judgement.clear();
    side.judgedReference = 0;
    if (settings.exposure && first) state_.exposure = *settings.exposure;
  } catch (const Error& error) {
    endSolving();
    if (first) throw;
    side.failedAs = wanted;
    side.failure = error.what();
    state_.say(error.what());
  } catch (const Stopped& stopped) {
    const bool isLeft = made_ && !state_.solving.cancelled;  // for what is wanted now
    endSolving();
    if (isLeft) return;
    if (first && !side.renderer) {
      logWarning("{}", stopped.what());
      stop_ = true;
      return;
    }
    takeBack(side);
    if (!side.renderer || side.builtAs != wantedOf(side.options)) side.failedAs = wantedOf(side.options);
    state_.say("stopped; settings and light as before");
  }
}

/// Settings and lights become those of the side's renderer again; the other side follows.
void WalkWindow::takeBack(SideState& side) {
  side.options = side.built;
  const SceneChange change = changeOf(lightsOf(state_), side.lights);
  if (!side.renderer || !change.any() || state_.scene->motion) return;
  setLights(state_, side.lights);
  shownLights_ = side.lights;
  follow(change);
  side.missed = {};
  side.builtAs = wantedOf(side.built);
}

/// Whether what is drawn may depend on the machine's speed, as frames do that go on while a technique is solved. What
/// is measured or played is the same on every machine.
bool WalkWindow::mayVary() const {
  return host_.kind() == HostKind::window && !player_ && options_.common.json.empty();
}

/// A renderer that draws at once, until a solution is made: by direct light, or by the cache where surfaces alone
/// shine.
std::unique_ptr<Renderer> WalkWindow::preview(const Scene& scene, PictureOptions& options) {
  chooseTechnique(options, analyse(scene).anyLight() ? "direct" : "irradiance-cache");
  RenderSettings settings = options.parse();
  settings.size = pictureSize();
  return std::make_unique<Renderer>(context_, programs_, scene, settings);
}

/// Whether what is being made is still what is asked for.
bool WalkWindow::isWanted() const {
  const bool isLit = !changeOf(shownLights_, lightsOf(state_)).any();
  return isLit && wantedOf(made_->options) == madeAs_ && made_->shows == Shows::technique && !state_.sceneToLoad &&
         !state_.reloadWanted;
}

void WalkWindow::makeReady() {
  if (changeOf(shownLights_, lightsOf(state_)).any()) return;  // once it is let go (relight)
  if (state_.reloadWanted) {
    state_.reloadWanted = false;
    const auto reload = programs_.reloadChanged();
    for (SideState& side : state_.sides)
      if (side.renderer) side.renderer->forget();  // what the previous programs made
    state_.say(fmt::format("{} programs reloaded", reload.reloaded));
    for (const std::string& failure : reload.failures) {
      state_.say(failure);
      logWarning("{}", failure);
    }
    changed();
  }
  if (std::exchange(state_.lpvStepsWanted, false)) measureLpvSteps();
  for (int i = 0; i < 2; ++i)
    if (i == 0 || state_.isVisible(i)) make(state_.sides[static_cast<std::size_t>(i)]);
}

bool WalkWindow::showsLpvStep() const {
  const SideState& shown = state_.side();
  return state_.lpvSteps && state_.lpvStep >= 0 && shown.renderer && volumeOf(shown.renderer->technique());
}

void WalkWindow::measureLpvSteps() {
  const SideState& side = state_.side();
  if (!side.renderer || !volumeOf(side.renderer->technique())) return;
  try {
    state_.lpvSteps.reset();
    state_.lpvSteps = std::make_unique<LpvSteps>(context_, programs_, *state_.scene, side.renderer->settings(),
                                                 state_.camera->camera(),
                                                 [&](int step) { breathe(fmt::format("propagating {} steps", step)); });
    state_.lpvStep = 0;
    state_.stageLayer = state_.lpvSteps->slices() / 2;
  } catch (const Error& error) { state_.say(error.what()); } catch (const Stopped&) {
    state_.say("not measured");
  }
}

const gl::Texture* WalkWindow::radianceOf(int index) const {
  const SideState& side = state_.sides[static_cast<std::size_t>(index)];
  if (side.shows == Shows::picture && side.picture) return &*side.picture;
  if (side.shows == Shows::reference && state_.reference && state_.reference->samples() > 0 && still_ >= kStillFrames)
    return &state_.reference->mean();
  return side.renderer ? &side.renderer->radiance() : nullptr;
}

// A side that is set to the reference or to a stored picture draws its technique until there is one.
void WalkWindow::draw() {
  if ((state_.autoExposure && frames_ % 8 == 0) || state_.meterWanted) {
    if (const gl::Texture* radiance = radianceOf(state_.shown); radiance && frames_ > 0) {
      if (const auto metered = compare_->meteredExposure(*radiance))
        state_.exposure = state_.meterWanted ? *metered : state_.exposure * std::pow(*metered / state_.exposure, 0.3f);
      state_.meterWanted = false;
    }
  }
  for (int i = 0; i < 2; ++i) {
    SideState& side = state_.sides[static_cast<std::size_t>(i)];
    if (!state_.isVisible(i) || !side.renderer || (side.shows == Shows::picture && side.picture)) continue;
    const bool rests = still_ > kStillFrames && side.renderer->exposure() == state_.exposure &&
                       (drawsBetween_ || (!state_.drawsAtRest && side.settled));
    if (rests) continue;
    side.renderer->setExposure(state_.exposure);
    side.renderer->render(state_.camera->camera());
    ++side.pictureVersion;
    side.settled = still_ > kStillFrames && side.renderer->isSettled();
  }
}

bool WalkWindow::allSettled() const {
  for (int i = 0; i < 2; ++i) {
    const SideState& side = state_.sides[static_cast<std::size_t>(i)];
    if (state_.isVisible(i) && side.shows == Shows::technique && !side.settled) return false;
  }
  return true;
}

void WalkWindow::makeReference(double frameSeconds) {
  const double now =
      player_ ? kPlayedFrame * frames_ : std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
  reference_.doShare(frameSeconds, {still_ >= kStillFrames && state_.motionScale == 1.0f, allSettled(), now,
                                    [this](const std::string& what) { breathe(what); }});
}

void WalkWindow::readPixel(const Compare::Inputs& inputs) {
  state_.values = {};
  state_.pixel.reset();
  if (!state_.magnifier || input_.cursor.x < 0.0) return;
  if (input_.cursor.x < view_.x) state_.pixel = Compare::pictureAt(inputs, view_, glm::vec2(input_.cursor));
  if (!state_.pixel) return;
  const auto read = [&](const gl::Texture* texture) -> std::optional<glm::vec3> {
    if (!texture || texture->size2d() != inputs.left.radiance->size2d()) return {};
    const gl::Texture one("pixel", texture->format(), glm::ivec2(1));
    gl::copyTexels(*texture, {state_.pixel->x, texture->size().y - 1 - state_.pixel->y}, one, {0, 0}, {1, 1});
    return glm::vec3(one.readRgba().front());
  };
  state_.values.a = read(radianceOf(0));
  if (state_.layout != Layout::one || state_.shown == 1) state_.values.b = read(radianceOf(1));
  if (state_.reference && state_.liveReferenceOn && still_ >= kStillFrames && state_.reference->samples() > 0) {
    state_.values.reference = read(&state_.reference->mean());
    state_.values.error = read(&state_.reference->standardError());
  }
}

void WalkWindow::inspectPixel(const Compare::Inputs& inputs) {
  if (!state_.inspectedPlace || drawsBetween_) return;
  const glm::vec2 place(*std::exchange(state_.inspectedPlace, std::nullopt));
  if (place.x < 0.0f || place.x >= static_cast<float>(view_.x)) return;
  const auto pixel = Compare::pictureAt(inputs, view_, place);
  if (!pixel) return;
  state_.inspectedSide = inputs.layout == Layout::one ? state_.shown : Compare::isRight(inputs, view_, place) ? 1 : 0;
  SideState& side = state_.sides[static_cast<std::size_t>(state_.inspectedSide)];
  if (!side.renderer || side.shows == Shows::picture || *pixel != glm::min(*pixel, side.renderer->size() - 1)) return;
  try {
    breathe("inspecting the pixel");
    const gl::BuildWatch watch([this](const std::string& name) { breathe("compiling " + name); });
    state_.answer = side.renderer->inspect(programs_, state_.camera->camera(), *pixel);
    state_.answer->condense(kInspectedShares);
    state_.answerIsNew = true;
  } catch (const Error& error) { state_.say(error.what()); } catch (const Stopped&) {
    state_.say("not inspected");
  }
}

/// The hemicube of the patch that was asked for; asked for anew in a hemicube, the picture.
void WalkWindow::makeHemicube(const Compare::Inputs& inputs) {
  const std::optional<glm::dvec2> place = std::exchange(state_.hemicubePlace, std::nullopt);
  const bool ofMiddle = std::exchange(state_.hemicubeWanted, false);
  const SideState& side = state_.side();
  const RadiosityView* view = side.renderer ? radiosityOf(side.renderer->technique()) : nullptr;
  if (!view || drawsBetween_) state_.hemicube.reset();
  if (!view || drawsBetween_ || (!ofMiddle && !place)) return;
  if (place && state_.hemicube) {
    state_.hemicube.reset();
    return;
  }
  const glm::ivec2 size = side.renderer->size();
  const auto pixel = ofMiddle ? std::optional(size / 2) : Compare::pictureAt(inputs, view_, glm::vec2(*place));
  const auto patch =
      pixel ? patchAt(view->solution().mesh, state_.camera->camera(), *pixel, size) : std::optional<std::uint32_t>();
  if (!patch) {
    state_.say("no patch there");
    return;
  }
  try {
    breathe("drawing the hemicube");
    const gl::BuildWatch watch([this](const std::string& name) { breathe("compiling " + name); });
    const auto& settings = side.renderer->settings().of<RadiosityView::Settings>().solution;
    state_.hemicube = std::make_unique<HemicubeView>(context_, programs_, *state_.scene, view->solution(), settings,
                                                     *patch, state_.exposure);
  } catch (const Error& error) { state_.say(error.what()); } catch (const Stopped&) {
    state_.say("not drawn");
  }
}

/// A stage's result or a count of the shown side, if one was chosen, instead of pictures.
void WalkWindow::showDebugView(Compare::Inputs& inputs) {
  const SideState& shown = state_.side();
  const auto show = [&](const StagePicture& picture) {
    if (!stageView_) stageView_.emplace(programs_);
    inputs.layout = Layout::one;
    inputs.left = {&stageView_->record(picture, state_.stageLayer, std::exp2(state_.stageFactor), state_.scene->bounds),
                   Show::values, nullptr};
  };
  makeHemicube(inputs);
  if (state_.hemicube) {
    inputs.layout = Layout::one;
    inputs.left = {&state_.hemicube->picture(), Show::values, nullptr};
  }
  if (showsLpvStep()) show(state_.lpvSteps->picture(std::min(state_.lpvStep, state_.lpvSteps->steps())));
  if (!state_.stage.empty() && shown.renderer) {
    for (const StagePicture& picture : shown.renderer->stagePictures())
      if (picture.name == state_.stage) show(picture);
  }
  if (state_.countView == CountView::none || !shown.renderer) {
    state_.countViews.reset();
  } else {
    if (!state_.countViews)
      state_.countViews = std::make_unique<CountViews>(context_, programs_, *state_.scene, shown.renderer->origin());
    const Camera& camera = state_.camera->camera();
    inputs.layout = Layout::one;
    inputs.left = {&state_.countViews->record(state_.countView, camera,
                                              shown.renderer->linesView(camera, state_.scene->bounds).clipFromWorld,
                                              shown.renderer->size(), state_.countWhite),
                   Show::values, nullptr};
  }
}

void WalkWindow::compose() {
  SideState& shown = state_.side();
  const bool referenceThere =
      state_.reference && state_.liveReferenceOn && state_.reference->ready() && still_ >= kStillFrames;
  const bool shows = state_.show == Show::picture || (referenceThere && radianceOf(state_.shown) &&
                                                      radianceOf(state_.shown)->size2d() == state_.reference->size());
  const bool stage = (!state_.stage.empty() || showsLpvStep()) && shown.renderer;
  const bool counts = state_.countView != CountView::none && shown.renderer;
  const bool hemicube = state_.hemicube || state_.hemicubePlace || state_.hemicubeWanted;
  const bool plain = !stage && !counts && !hemicube && state_.layout == Layout::one &&
                     (state_.show == Show::picture || !shows) && state_.zoom == 1.0f && !state_.magnifier &&
                     radianceOf(state_.shown) == (shown.renderer ? &shown.renderer->radiance() : nullptr) &&
                     shown.renderer && shown.renderer->size() == view_;
  presented_ = plain && !drawsUi() && !state_.shotWanted && !state_.inspectedPlace && !state_.answer &&
               !state_.records && state_.glyphs == Glyphs::none && !state_.movesLamps && !recorder_.isRecording() &&
               view_ == window_;
  if (presented_) {
    host_.present(shown.renderer->displayFramebuffer().id(), window_);
    return;
  }
  Compare::Inputs inputs;
  const auto side = [&](int i) {
    const SideState& s = state_.sides[static_cast<std::size_t>(i)];
    Compare::Side result{radianceOf(i), referenceThere ? state_.show : Show::picture, s.judgement.flipMap()};
    const bool isReference = referenceThere && result.radiance == &state_.reference->mean();
    if (isReference || (result.show == Show::flip && !result.flip) ||
        (result.radiance && referenceThere && result.radiance->size2d() != state_.reference->size()))
      result.show = Show::picture;
    return result;
  };
  inputs.layout = state_.layout;
  inputs.left = side(state_.layout == Layout::one ? state_.shown : 0);
  inputs.right = side(1);
  if (!inputs.right.radiance) inputs.layout = Layout::one;
  inputs.split = state_.split;
  inputs.zoom = state_.zoom;
  inputs.centre = state_.centre;
  inputs.interpolates = state_.motionScale < 1.0f;
  inputs.exposure = state_.exposure;
  if (referenceThere) {
    inputs.reference = &state_.reference->mean();
    inputs.standardError = &state_.reference->standardError();
    const glm::dvec3 mean = meanOf(state_.reference->reference().mean);
    inputs.errorScale = state_.errorScale > 0.0f
                            ? state_.errorScale
                            : std::max(0.5f * static_cast<float>(mean.x + mean.y + mean.z) / 3.0f, 1e-30f);
  }
  if (state_.magnifier && input_.cursor.x >= 0.0 && !(ui_ && drawsUi() && ui_->wantsMouse(input_)))
    inputs.magnifier = glm::vec2(input_.cursor);
  showDebugView(inputs);
  std::vector<Label> labels;
  if (!plain && inputs.left.radiance) {
    if (!ui_) ui_.emplace(programs_, host_, host_.contentScale());
    ui_->beginNote(window_, 0.02);  // for the size of text
    labels = placeLabels(state_, view_, inputs);
    ui_->drop();
    compare_->record(pictureTarget_, view_, inputs);
  } else if (plain) {
    gl::copyTexels(shown.renderer->display(), {0, 0}, picture_, {0, 0}, view_);
  }
  readPixel(inputs);
  inspectPixel(inputs);
  overlay_.draw({pictureTarget_, inputs, view_, window_.y, host_.contentScale()});
  if (!labels.empty()) {
    ui_->beginNote(window_, 0.02);
    drawLabels(labels, *ImGui::GetForegroundDrawList());
    ui_->end(pictureTarget_);
  }
  if (state_.shotWanted) recorder_.takeShot(shownPicture());
}

// ---------------------------------------------------------------------------------------------------- presenting

void WalkWindow::resizeTo(glm::ivec2 window) {
  if (window != window_) {
    window_ = window;
    picture_ = gl::Texture("window", gl::Format::rgba8, window_);
    const std::array<const gl::Texture*, 1> colors{&picture_};
    pictureTarget_ = gl::Framebuffer("window", colors);
    const gl::RasterPass pass("window", pictureTarget_, {});
    pass.clearColor(0, glm::vec4(0.0f, 0.0f, 0.0f, 1.0f));
    changed();
  }
  // An open panel gets the right part of the window if most of the window remains.
  const int panel = state_.panel ? Panel::widthOf(host_.contentScale()) : 0;
  view_ = {window_.x > 2 * panel ? window_.x - panel : window_.x, window_.y};
  if (resizePictures()) changed();
}

bool WalkWindow::resizePictures() {
  bool isOther = false;
  for (SideState& side : state_.sides) {
    if (!side.renderer || side.renderer->size() == pictureSize()) continue;
    side.renderer->resize(pictureSize());
    side.settled = false;
    side.judgement.clear();
    isOther = true;
  }
  return isOther;
}

glm::ivec2 WalkWindow::pictureSize() const {
  return glm::max(glm::ivec2(glm::vec2(view_) * state_.renderScale * state_.motionScale), glm::ivec2(1));
}

/// What is measured, played, kept or read pixel by pixel is whole.
bool WalkWindow::mayBeCoarse() const {
  const bool keeps = recorder_.isRecording() || state_.records || state_.shotWanted || state_.magnifier;
  return state_.coarseInMotion && mayVary() && options_.frames == 0 && !keeps;
}

void WalkWindow::buildUi(double seconds) {
  ui_->begin(input_, window_, seconds);
  ui_->beginWindows();
  if (state_.panel) Panel::show(*ui_, state_, host_);
  if (state_.help) Panel::showHelp(*ui_, state_);
  if (state_.solving.isOn() && made_) showSolving(*ui_, state_.solving);
  if (state_.asksToEnd) Panel::showQuestion(*ui_, state_);
  Panel::showValues(state_);
  Panel::showMessage(state_, "", -1.0);
}

void WalkWindow::drawUi(double seconds) {
  if (!ui_) ui_.emplace(programs_, host_, host_.contentScale());
  buildUi(seconds);
  ui_->end(pictureTarget_);
}

// Controls that recorded input uses by name must exist; apart from them, nothing invisible is built.
bool WalkWindow::drawsUi() const {
  return state_.panel || state_.help || state_.asksToEnd || state_.hint || made_ ||
         (!state_.messages.empty() && state_.messageAge < kMessageSeconds) || player_.has_value();
}

void WalkWindow::breathe(const std::string& what, double share) {
  const bool measures = !options_.common.json.empty() && !player_;
  if (made_) {
    state_.solving.note(what);
    if (!drawBetween()) throw Stopped(what);
    return;
  }
  if (measures || window_.x <= 0 || secondsSince(lastBreath_) < 0.1) return;
  if (!player_) {
    host_.pump();
    if (host_.input().closes()) stop_ = true;
    if (stop_ || interrupted() || host_.input().takeEscape()) throw Stopped(what);
    if (host_.framebufferSize() != window_) return;  // the next frame handles it
  }
  if (!ui_) ui_.emplace(programs_, host_, host_.contentScale());
  ui_->beginNote(window_, 0.02);
  Panel::showMessage(state_, what, share);
  ui_->end(pictureTarget_);
  host_.present(pictureTarget_.id(), window_);
  lastBreath_ = Clock::now();
}

bool WalkWindow::goesOnSolving(const RadiosityStage& stage) {
  state_.solving.note(stage);
  if (made_) return drawBetween();
  if (player_ || secondsSince(lastBreath_) < 0.1) return true;
  lastBreath_ = Clock::now();
  host_.pump();
  if (host_.input().closes()) stop_ = true;
  return !stop_ && !interrupted() && !host_.input().takeEscape();
}

/// A frame of what is there, while a solution is made: camera, keys and panel act as ever, and what is asked for
/// meanwhile is made afterwards. False: the solution is to stop.
bool WalkWindow::drawBetween() {
  if (drawsBetween_) return true;  // asked by what this frame itself makes
  host_.pump();
  const double seconds = secondsSince(lastBreath_);
  const bool acts = host_.input().waits() || walking_.move != glm::dvec3(0.0) || still_ <= kStillFrames;
  // The solution has half of the time, and most of it where nothing moves.
  if (seconds < (acts ? std::max(kBetweenFrames, frameBetween_) : std::max(kBetweenNotes, 4.0 * frameBetween_)))
    return true;
  const auto start = Clock::now();
  if (seconds > kLongGap) logVerbose("{:.2f} s without a frame before: {}", seconds, state_.solving.text());
  drawsBetween_ = true;
  const auto end = [this, start](bool goesOn) {
    drawsBetween_ = false;
    lastBreath_ = Clock::now();
    frameBetween_ = secondsSince(start);
    return goesOn;
  };
  if (!takeInput()) {
    stop_ = true;
    return end(false);
  }
  const glm::ivec2 window = host_.framebufferSize();
  if (state_.solving.cancelled || !isWanted()) return end(false);
  if (window.x <= 0 || window.y <= 0 || host_.isMinimised()) return end(true);
  resizeTo(window);
  moveCamera(std::min(seconds, kLongestStep));
  draw();
  compose();
  recorder_.record(shownPicture(), seconds);
  drawUi(seconds);
  host_.present(pictureTarget_.id(), window_);
  host_.setTitle(fmt::format("Lucerna - {} - radiosity: {} - Escape stops", state_.scene->name, state_.solving.text()));
  ++still_;
  ++quiet_;
  state_.messageAge += seconds;
  sinceHint_ += seconds;
  return end(true);
}

void WalkWindow::pace(Clock::time_point start) {
  if (state_.frameLimit <= 0 || player_) return;
  std::this_thread::sleep_until(
      start + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1.0 / state_.frameLimit)));
}

/// Whether nothing would change by itself: the picture has converged, nothing moves, no message is about to go.
bool WalkWindow::rests() const {
  if (!mayVary() || options_.frames > 0 || state_.drawsAtRest) return false;
  const bool isStill = still_ > kStillFrames && quiet_ > kStillFrames && state_.motionScale == 1.0f && allSettled();
  const bool moves =
      (state_.path.follows && !state_.path.paused) || state_.timeRuns() || input_.move != glm::dvec3(0.0);
  const bool works = state_.liveReferenceOn || state_.autoExposure || recorder_.isRecording() || state_.records;
  const bool speaks = state_.hint || (!state_.messages.empty() && state_.messageAge < kMessageSeconds);
  return isStill && !moves && !works && !speaks;
}

void WalkWindow::run() {
  lastEdit_ = {{state_.sides[0].options, state_.sides[1].options}, lightsOf(state_)};
  shownLights_ = lastEdit_.lights;
  const auto begin = Clock::now();
  auto frameStart = begin, titleTime = begin;
  compare_.emplace(programs_);
  bool rested = false;
  while (true) {
    if (rests()) {
      if (!rested) host_.setTitle(fmt::format("Lucerna - {} - at rest - F1 keys, F2 panel", state_.scene->name));
      rested = true;
      host_.pump(kRest);
      frameStart = titleTime = Clock::now();
      framesOfTitle_ = 0;
      if (!host_.input().waits() && !interrupted()) continue;
    }
    rested = false;
    if (!takeInput()) break;
    const auto start = Clock::now();
    const double measured = frames_ > 0 ? std::chrono::duration<double>(start - frameStart).count() : 0.0;
    const double dt = player_ ? kPlayedFrame : measured;
    frameStart = start;
    const glm::ivec2 window = host_.kind() == HostKind::window ? host_.framebufferSize() : playedSize_;
    if (window.x <= 0 || window.y <= 0 || host_.isMinimised()) {
      if (!player_) host_.pump(kRest);
      ++frames_;
      continue;
    }
    // Scene, light and renderers.
    resizeTo(window);
    loadWantedScene();
    moveScene(dt);
    const auto beforeLight = Clock::now();
    const bool relit = relight();
    makeReady();
    if (relit) followSeconds_ = secondsSince(beforeLight);
    noteEdits();
    if (stop_) break;
    // The picture.
    moveCamera(dt);
    recorder_.beginCapture(frames_ == options_.capture);
    const auto drawing = Clock::now();
    const bool mayBeCoarse = this->mayBeCoarse();
    if (!mayBeCoarse) motionScale_.showWhole();
    state_.motionScale = mayBeCoarse ? motionScale_.next(restSeconds_ < kRestsFrom) : 1.0f;
    if (resizePictures()) still_ = 0;
    draw();
    makeReference(measured);
    compose();
    recorder_.record(shownPicture(), dt);
    if (drawsUi()) {
      drawUi(dt);
      if (player_)
        if (const auto file = player_->takeSave()) writePng(*file, gl::readBitmap(picture_, window_));
      host_.present(pictureTarget_.id(), window_);
    } else if (!presented_) {
      host_.present(pictureTarget_.id(), window_);
    }
    recorder_.endCapture();
    if (mayBeCoarse) motionScale_.took(secondsSince(drawing));
    ++still_;
    ++quiet_;
    ++frames_;
    restSeconds_ += secondsSince(start);
    state_.messageAge += dt;
    sinceHint_ += dt;
    if (sinceHint_ > kHintSeconds) state_.hint = false;
    if (std::exchange(hasSolved_, false)) {  // no frame's time
      titleTime = Clock::now();
      framesOfTitle_ = 0;
    } else {
      state_.frameMs.push_back(static_cast<float>(1e3 * secondsSince(start)));
    }
    if (state_.frameMs.size() > kPlotFrames) state_.frameMs.erase(state_.frameMs.begin());
    ++framesOfTitle_;
    if (secondsSince(titleTime) > 0.5) {
      host_.setTitle(fmt::format("Lucerna - {} - {:.1f} frames a second - F1 keys, F2 panel", state_.scene->name,
                                 framesOfTitle_ / secondsSince(titleTime)));
      titleTime = Clock::now();
      framesOfTitle_ = 0;
    }
    if (options_.frames > 0 && frames_ >= options_.frames) break;
    pace(start);
  }
  state_.records = false;
  recorder_.record(shownPicture(), 0.0);
  for (SideState& side : state_.sides)
    if (side.renderer) side.renderer->drain();
  seconds_ = secondsSince(begin);
}

nlohmann::ordered_json WalkWindow::toJson() const {
  nlohmann::ordered_json json;
  if (!state_.frameMs.empty()) {
    const std::vector<double> ms(state_.frameMs.begin(), state_.frameMs.end());
    json["frame_ms"] = {{"mean", std::accumulate(ms.begin(), ms.end(), 0.0) / static_cast<double>(ms.size())},
                        {"median", median(ms)},
                        {"p25", percentile(ms, 0.25)},
                        {"p75", percentile(ms, 0.75)},
                        {"p95", percentile(ms, 0.95)},
                        {"count", ms.size()}};
  }
  json["messages"] = state_.messages;
  if (state_.hemicube) json["hemicube"] = {{"patch", state_.hemicube->patch()}, {"fronts", state_.hemicube->seen()}};
  for (const SolvingState::Point& point : state_.solving.curve())
    json["residuals"].push_back({point.products, point.residual});
  if (state_.lpvSteps) json["flux_by_step"] = state_.lpvSteps->energies();
  if (const auto& sun = state_.scene->sun) json["sun"] = {sun->direction.x, sun->direction.y, sun->direction.z};
  json["lamps"] = nlohmann::ordered_json::array();
  for (const SpotLight& l : state_.scene->spots) json["lamps"].push_back({l.position.x, l.position.y, l.position.z});
  for (const PointLight& l : state_.scene->points) json["lamps"].push_back({l.position.x, l.position.y, l.position.z});
  if (ui_) {
    json["panel_gpu_bytes"] = ui_->gpuBytes();
    json["controls"] = ui_->labels();
  }
  if (player_) {
    json["touched"] = player_->touched();
    json["gone"] = player_->gone();
  }
  if (state_.reference) {
    json["reference"] = {{"samples", state_.reference->samples()},
                         {"seconds", state_.reference->seconds()},
                         {"seconds_in_frames", reference_.time().spent()},
                         {"seconds_of_frames", reference_.time().rest()},
                         {"longest_in_a_frame", reference_.time().longest()},
                         {"moving", state_.timeRuns()}};
    for (std::size_t i = 0; i < 2 && !state_.timeRuns(); ++i)
      if (const Judgement& j = state_.sides[i].judgement; j.known())
        json["reference"][i == 0 ? "a" : "b"] = {
            {"nrmse", j.nrmse().value}, {"low", j.nrmse().low}, {"high", j.nrmse().high}, {"bias", j.bias()}};
  }
  return json;
}

}  // namespace lucerna::demo
