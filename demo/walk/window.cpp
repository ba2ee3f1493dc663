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
#include "irradiance_cache/irradiance_cache.hpp"
#include "irradiance_cache/irradiance_cache_frame.hpp"
#include "walk/ground.hpp"
#include "walk/panel.hpp"
#include "shared/paths.hpp"
#include "walk/pixel_section.hpp"
#include "walk/shots.hpp"

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
constexpr int kStillFrames = 3;  // still frames before the reference of a view is started
constexpr std::size_t kPlotFrames = 240;

bool sameView(const Camera& a, const Camera& b) {
  return a.position == b.position && a.direction == b.direction && a.up == b.up && a.verticalFov == b.verticalFov;
}

bool isPicture(const fs::path& file) {
  const std::string extension = lowerExtension(file);
  return extension == ".png" || extension == ".jpg" || extension == ".hdr" || extension == ".exr" ||
         extension == ".pfm";
}

}  // namespace

WalkWindow::WalkWindow(const WalkOptions& options, Host& host, const gl::Context& context, gl::ProgramLibrary& programs,
                       WalkState state)
    : options_(options), host_(host), context_(context), programs_(programs), state_(std::move(state)) {
  state_.rendererName = context.capabilities().renderer;
  if (!options.playInput.empty()) player_.emplace(options.playInput);
  playedSize_ = parseSize(options.picture.size);
  renderDoc_ = RenderDoc::find();
  state_.canCapture = renderDoc_.has_value();
  state_.canRecord = Video::canBeMade();
  state_.swapAtRefresh = host.swapInterval().value_or(0) > 0;
}

WalkWindow::~WalkWindow() {
  if (state_.reference) state_.reference->keep();
}

// ---------------------------------------------------------------------------------------------------- input

bool WalkWindow::takeInput() {
  if (player_) {
    if (player_->done() && options_.frames == 0) return false;
    if (!ui_) ui_.emplace(programs_, host_, host_.contentScale());
    input_ = player_->next(&*ui_);
    if (const auto size = player_->takeSize()) {
      playedSize_ = *size;
      host_.setWindowSize(*size);
    }
    host_.poll();  // the system must see that the window responds
  } else {
    input_ = host_.poll();
  }
  if (input_.closeRequested || interrupted()) return false;
  const bool typing = ui_ && ui_->wantsKeyboard(), pointing = ui_ && drawsUi() && ui_->wantsMouse(input_);
  if (typing) {
    input_.move = glm::dvec3(0.0);
    input_.pressed.clear();
  }
  if (pointing) input_.mouseDelta = glm::dvec2(0.0);
  touched_ = touched_ || !input_.pressed.empty() || input_.buttons[0] || input_.buttons[1] || !input_.dropped.empty();
  for (const KeyEvent& event : input_.keys) {
    touched_ = true;
    const auto action = actionOf(event);
    if (action && (!typing || *action == Action::help || *action == Action::panel)) act(*action);
  }
  if (!pointing) {
    const glm::vec2 pixels(glm::max(view_, glm::ivec2(1)));
    if (input_.buttons[static_cast<std::size_t>(MouseButton::right)] && state_.layout == Layout::wipe)
      state_.split = std::clamp(static_cast<float>(input_.cursor.x) / pixels.x, 0.0f, 1.0f);
    if (input_.wheel.y != 0.0)
      state_.zoom = std::clamp(state_.zoom * static_cast<float>(std::exp2(0.25 * input_.wheel.y)), 1.0f, 64.0f);
    if (state_.zoom == 1.0f) state_.centre = glm::vec2(0.5f);
    if (input_.buttons[static_cast<std::size_t>(MouseButton::middle)])
      state_.centre = glm::clamp(
          state_.centre - glm::vec2(1.0f, -1.0f) * glm::vec2(input_.cursor - cursorBefore_) / pixels / state_.zoom,
          0.0f, 1.0f);
  }
  const bool left = input_.buttons[static_cast<std::size_t>(MouseButton::left)];
  if (state_.movesLamps && screen_ && !pointing &&
      gizmo_.take(*state_.scene, *screen_, glm::vec2(input_.cursor), left)) {
    input_.mouseDelta = glm::dvec2(0.0);
    if (gizmo_.takeMoved()) ++state_.sceneVersion;
    changed();
  } else if (state_.inspectsByClick && !pointing) {
    if (left && !leftBefore_) state_.inspectedPlace = input_.cursor;
    input_.mouseDelta = glm::dvec2(0.0);
  }
  leftBefore_ = left;
  cursorBefore_ = input_.cursor;
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
    case Action::end: s.endWanted = true; break;
    case Action::pause: s.path.paused = !s.path.paused; break;
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
      break;
    case Action::undo:
      if (s.undo.empty()) break;
      for (std::size_t i = 0; i < 2; ++i) s.sides[i].options = s.undo.back()[i];
      s.undo.pop_back();
      s.say("settings as before");
      break;
    case Action::flicker: s.shown = 1 - s.shown; break;
    case Action::wipe: s.layout = s.layout == Layout::wipe ? Layout::one : Layout::wipe; break;
    case Action::sideBySide: s.layout = s.layout == Layout::sideBySide ? Layout::one : Layout::sideBySide; break;
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

// ---------------------------------------------------------------------------------------------------- frame steps

void WalkWindow::moveCamera(double seconds) {
  PathState& path = state_.path;
  const bool steers = input_.move != glm::dvec3(0.0) || input_.mouseDelta != glm::dvec2(0.0);
  if (steers) path.follows = false;
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
    state_.camera->move(input_, std::min(seconds, 0.1));  // a slow frame must not fling the camera across the room
  }
  if (!sameView(state_.camera->camera(), lastCamera_)) changed();
  lastCamera_ = state_.camera->camera();
}

void WalkWindow::loadWantedScene() {
  if (!state_.sceneToLoad) return;
  const fs::path file = *std::exchange(state_.sceneToLoad, std::nullopt);
  try {
    breathe("loading " + file.filename().string());
    auto scene = std::make_unique<Scene>(loadScene(file));
    if (state_.ground && wantsGround(*scene)) addGround(*scene);
    Spline path = pathOf(*scene, {});
    RenderSettings settings = state_.sides[0].options.parse();
    settings.size = state_.sides[0].renderer->size();
    const gl::BuildWatch watch([this](const std::string& name) { breathe("compiling " + name); });
    auto renderer = std::make_unique<Renderer>(context_, programs_, *scene, settings);
    // Nothing can fail from here on: the new scene replaces the old one.
    state_.reference.reset();
    state_.countViews.reset();
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
    SideState& a = state_.sides[0];
    a.renderer = std::move(renderer);
    a.built = a.options;
    a.builtAs = textOf(a.options) + fmt::format(" {}", state_.sceneVersion);
    state_.sceneText = file.string();
    state_.path.spline = std::move(path);
    state_.path.first = 0;
    state_.path.last = state_.path.spline->viewCount() - 1;
    state_.path.seconds = 0.0;
    state_.path.follows = false;
    state_.camera.emplace(state_.scene->cameras.front(), 0.08 * glm::length(state_.scene->bounds.extent()));
    state_.exposure = state_.scene->exposure;
    if (state_.scene->defaultSun) state_.meterWanted = true;  // no file sets an exposure
    host_.setTitle("Lucerna - " + state_.scene->name);
    state_.say(fmt::format("{}: {} triangles", state_.scene->name, state_.scene->triangleCount()));
    changed();
  } catch (const Error& error) { state_.say(error.what()); } catch (const Stopped&) {
    state_.say("loading stopped");
  }
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
  const std::string wanted = textOf(side.options) + fmt::format(" {}", state_.sceneVersion);
  if (side.shows != Shows::technique && side.renderer) return;
  if (wanted == side.builtAs || wanted == side.failedAs) return;
  const bool first = !state_.sides[0].renderer;
  try {
    RenderSettings settings = side.options.parse();
    settings.size = pictureSize();
    const auto start = Clock::now();
    breathe("making technique " + side.options.technique);
    const gl::BuildWatch watch([this](const std::string& name) { breathe("compiling " + name); });
    auto renderer = std::make_unique<Renderer>(context_, programs_, *state_.scene, settings);
    lastBreath_ = {};  // a driver may compile its programs only now
    breathe("drawing the first picture by " + side.options.technique);
    side.renderer = std::move(renderer);
    side.buildSeconds = secondsSince(start);
    side.failure.clear();
    side.failedAs.clear();
    if (!side.builtAs.empty() && textOf(side.built) != textOf(side.options)) {
      std::array<PictureOptions, 2> before{state_.sides[0].built, state_.sides[1].built};
      if (state_.undo.empty() || textOf(state_.undo.back()[0]) != textOf(before[0]) ||
          textOf(state_.undo.back()[1]) != textOf(before[1]))
        state_.undo.push_back(before);
      if (state_.undo.size() > 100) state_.undo.erase(state_.undo.begin());
    }
    side.built = side.options;
    side.builtAs = wanted;
    side.settled = false;
    side.judgement.clear();
    side.judgedReference = 0;
    if (settings.exposure && first) state_.exposure = *settings.exposure;
  } catch (const Error& error) {
    if (first) throw;
    side.failedAs = wanted;
    side.failure = error.what();
    state_.say(error.what());
  } catch (const Stopped&) {
    if (first) {
      stop_ = true;
      return;
    }
    side.options = side.built;
    if (!side.renderer) side.failedAs = wanted;
    state_.say("stopped; settings as before");
  }
}

void WalkWindow::makeReady() {
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
  for (int i = 0; i < 2; ++i)
    if (i == 0 || state_.isVisible(i)) make(state_.sides[static_cast<std::size_t>(i)]);
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
    const bool rests =
        state_.liveReferenceOn && still_ > kStillFrames && side.settled && side.renderer->exposure() == state_.exposure;
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

// Everything counts: sampling, reading back, judging. While pictures are still changing, the reference gets at most its
// share of the frames' own time; once they are still, all idle time.
void WalkWindow::makeReference(double frameSeconds) {
  constexpr double kIdleSeconds = 0.03;  // per frame, so that the panel still responds
  constexpr double kLongestFrame = 1.0;  // longer frames are something else, such as compiling
  if (!state_.liveReferenceOn || !state_.side().renderer) return;
  const double share = std::clamp(static_cast<double>(state_.referenceShare), 0.01, 0.9);
  const double submission = state_.reference ? state_.reference->submissionSeconds() : 0.0;
  referenceTime_.frame(frameSeconds, share, std::max(4.0 * submission, share * std::min(frameSeconds, kLongestFrame)));
  if (still_ < kStillFrames) return;
  const bool idle = allSettled();
  if (!idle && referenceTime_.left() < submission) return;
  gl::finish();  // the picture's work must not count as the reference's
  auto start = Clock::now();
  if (seekReference()) start = Clock::now();  // compiling happens once and is not counted
  if (state_.reference) state_.reference->advance(idle ? kIdleSeconds : referenceTime_.left());
  judge();
  if (idle) referenceTime_.idle(secondsSince(start));
  else referenceTime_.spend(secondsSince(start));
}

/// Provides the path tracer for the current view. Returns whether it had to be made.
bool WalkWindow::seekReference() {
  bool made = false;
  const SideState& shown = state_.side();
  const glm::ivec2 size = shown.renderer->size();
  const Component component = shown.renderer->settings().component;
  if (!state_.reference || state_.reference->size() != size || state_.reference->component() != component ||
      referenceVersion_ != state_.sceneVersion) {
    try {
      breathe("making the path tracer");
      const gl::BuildWatch watch([this](const std::string& name) { breathe("compiling " + name); });
      state_.reference.reset();
      state_.reference = std::make_unique<LiveReference>(context_, programs_, *state_.scene, size, component);
      referenceVersion_ = state_.sceneVersion;
      referenceCamera_.reset();
      made = true;
    } catch (const Error& error) {
      state_.liveReferenceOn = false;
      state_.say(error.what());
    } catch (const Stopped&) { state_.liveReferenceOn = false; }
    if (!state_.reference) return made;
  }
  if (!referenceCamera_ || !sameView(*referenceCamera_, state_.camera->camera())) {
    referenceCamera_ = state_.camera->camera();
    state_.reference->look(*referenceCamera_);
    for (SideState& side : state_.sides) side.judgement.clear(), side.judgedReference = 0;
  }
  return made;
}

// At most twice a second, since pictures are read back.
void WalkWindow::judge() {
  if (!state_.reference || !state_.reference->ready()) return;
  for (SideState& side : state_.sides) side.judgement.flip();  // takes up its FLIP picture once that is computed
  const double since = player_ ? kPlayedFrame * (frames_ - judgedFrame_) : secondsSince(judged_);
  if (since < 0.5) return;
  judged_ = Clock::now();
  judgedFrame_ = frames_;
  for (int i = 0; i < 2; ++i) {
    SideState& side = state_.sides[static_cast<std::size_t>(i)];
    if (!state_.isVisible(i) || side.shows == Shows::reference) continue;
    if (side.judgedReference == state_.reference->version() && side.judgedPicture == side.pictureVersion) continue;
    side.judgedReference = state_.reference->version();
    side.judgedPicture = side.pictureVersion;
    if (side.shows == Shows::picture) {
      if (!side.picture || side.picture->size2d() != state_.reference->size()) continue;
      const std::vector<glm::vec4> texels = side.picture->readRgba();
      Image image(side.picture->size().x, side.picture->size().y);
      for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
          image.at(x, image.height - 1 - y) =
              glm::vec3(texels[static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                               static_cast<std::size_t>(x)]);
      side.judgement.judge(std::move(image), state_.reference->reference(), allSettled());
    } else if (side.renderer && side.renderer->size() == state_.reference->size()) {
      side.judgement.judge(side.renderer->readRadiance(), state_.reference->reference(), allSettled());
    }
  }
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
  if (!state_.inspectedPlace) return;
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

// Rebuilt when the camera or their source has changed.
void WalkWindow::drawGlyphs(const Compare::Inputs& inputs) {
  const SideState& side = state_.side();
  if (state_.glyphs == Glyphs::none || !side.renderer || side.shows == Shows::picture) return;
  const Camera& camera = state_.camera->camera();
  const IrradianceCache* cache = cacheOf(side.renderer->technique());  // their light changes from frame to frame
  const std::string are = fmt::format("{} {} {} {} {} {} {}", static_cast<int>(state_.glyphs), side.builtAs,
                                      state_.glyphCascade, state_.glyphMost, cameraText(camera), state_.shown,
                                      state_.glyphs == Glyphs::records && cache ? cache->frame() : 0);
  if (are != glyphsAre_)
    glyphs_ = glyphsOf(state_.glyphs, *side.renderer, *state_.scene, camera, state_.glyphCascade, state_.glyphMost);
  glyphsAre_ = are;
  if (!lines_) lines_.emplace(programs_);
  lines_->draw(pictureTarget_, Compare::placementOf(inputs, view_, inputs.layout != Layout::one && state_.shown == 1),
               side.renderer->linesView(camera, state_.scene->bounds), glyphs_, host_.contentScale());
}

void WalkWindow::drawGizmo(const Compare::Inputs& inputs) {
  const SideState& side = state_.side();
  screen_.reset();
  if (!state_.movesLamps || !side.renderer) return;
  const Renderer& renderer = *side.renderer;
  screen_ =
      Gizmo::Screen{Compare::placementOf(inputs, view_, inputs.layout != Layout::one && state_.shown == 1),
                    renderer.linesView(state_.camera->camera(), state_.scene->bounds), renderer.origin(), window_.y};
  if (!lines_) lines_.emplace(programs_);
  gl::Lines::View view = screen_->view;
  view.depth = nullptr;  // a lamp behind a wall can be grabbed too
  lines_->draw(pictureTarget_, screen_->placement, view, gizmo_.lines(*state_.scene, renderer.origin()),
               3.0f * host_.contentScale());
}

// Drawn over the picture of its side and hidden by the surfaces in that picture.
void WalkWindow::drawLines(const Compare::Inputs& inputs) {
  if (!state_.answer || !state_.drawsAnswer) return;
  const bool right = inputs.layout != Layout::one && state_.inspectedSide == 1;
  if (inputs.layout == Layout::one && state_.inspectedSide != state_.shown) return;
  const SideState& side = state_.sides[static_cast<std::size_t>(state_.inspectedSide)];
  if (!side.renderer || side.shows == Shows::picture) return;
  const Renderer& renderer = *side.renderer;
  const gl::Lines::View view = renderer.linesView(state_.camera->camera(), state_.scene->bounds);
  if (!lines_) lines_.emplace(programs_);
  lines_->draw(pictureTarget_, Compare::placementOf(inputs, view_, right), view,
               linesOf(*state_.answer, state_.pointedShare, renderer.origin(), state_.scene->bounds),
               1.5f * host_.contentScale());
}

void WalkWindow::compose() {
  SideState& shown = state_.side();
  const bool referenceThere =
      state_.reference && state_.liveReferenceOn && state_.reference->ready() && still_ >= kStillFrames;
  const bool shows = state_.show == Show::picture || (referenceThere && radianceOf(state_.shown) &&
                                                      radianceOf(state_.shown)->size2d() == state_.reference->size());
  const bool stage = !state_.stage.empty() && shown.renderer;
  const bool counts = state_.countView != CountView::none && shown.renderer;
  const bool plain = !stage && !counts && state_.layout == Layout::one && (state_.show == Show::picture || !shows) &&
                     state_.zoom == 1.0f && !state_.magnifier &&
                     radianceOf(state_.shown) == (shown.renderer ? &shown.renderer->radiance() : nullptr) &&
                     shown.renderer && shown.renderer->size() == view_;
  presented_ = plain && !drawsUi() && !state_.shotWanted && !state_.inspectedPlace && !state_.answer &&
               !state_.records && state_.glyphs == Glyphs::none && !state_.movesLamps && !video_ && view_ == window_;
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
  if (stage) {
    for (const StagePicture& picture : shown.renderer->stagePictures()) {
      if (picture.name != state_.stage) continue;
      if (!stageView_) stageView_.emplace(programs_);
      inputs.layout = Layout::one;
      inputs.left = {
          &stageView_->record(picture, state_.stageLayer, std::exp2(state_.stageFactor), state_.scene->bounds),
          Show::values, nullptr};
    }
  }
  if (!counts) {
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
  if (plain) gl::copyTexels(shown.renderer->display(), {0, 0}, picture_, {0, 0}, view_);
  else if (inputs.left.radiance) compare_->record(pictureTarget_, view_, inputs);
  readPixel(inputs);
  inspectPixel(inputs);
  drawGlyphs(inputs);
  drawGizmo(inputs);
  drawLines(inputs);
  if (state_.shotWanted) takeShot();
}

/// Reads the presented picture: `size` pixels from the upper left corner of the window.
Bitmap WalkWindow::shownPicture(glm::ivec2 size) const {
  const std::vector<glm::vec4> texels = picture_.readRgba();
  Bitmap bitmap;
  bitmap.width = size.x;
  bitmap.height = size.y;
  for (int y = size.y - 1; y >= 0; --y)
    for (int x = 0; x < size.x; ++x)
      for (int c = 0; c < 4; ++c)
        bitmap.rgba.push_back(static_cast<std::uint8_t>(
            std::lround(255.0f * texels[static_cast<std::size_t>(y) * static_cast<std::size_t>(window_.x) +
                                        static_cast<std::size_t>(x)][c])));
  return bitmap;
}

void WalkWindow::takeShot() {
  state_.shotWanted = false;
  const SideState& side = state_.side();
  try {
    std::error_code ignored;
    fs::create_directories(state_.shotFolder, ignored);
    const fs::path stem = freeName(state_.shotFolder, state_.scene->name);
    std::string note = fmt::format("Lucerna {} on {}\n{} --camera {} --size {}x{}\nexposure {:.6g}", LUCERNA_VERSION,
                                   state_.rendererName, commandLine("render", state_.scene->file.string(), side.built),
                                   cameraText(state_.camera->camera()), side.renderer->size().x,
                                   side.renderer->size().y, state_.exposure);
    if (side.judgement.known())
      note += fmt::format("\nrelative error {:.4g}, {:.4g} to {:.4g} (99 %), against {} path-traced samples a pixel",
                          side.judgement.nrmse().value, side.judgement.nrmse().low, side.judgement.nrmse().high,
                          state_.reference ? state_.reference->samples() : 0);
    writePngWithNote(stem.string() + ".png", shownPicture(view_), note);
    if (side.renderer) writeHdrWithNote(stem.string() + ".hdr", side.renderer->readRadiance(), note);
    state_.say(fmt::format("{}.png and .hdr written", stem.string()));
  } catch (const Error& error) { state_.say(error.what()); }
}

void WalkWindow::recordVideo(double seconds) {
  const auto end = [&] {
    const bool whole = video_->finish();
    state_.say(whole ? fmt::format("{}: {} pictures", video_->file().string(), video_->pictures())
                     : fmt::format("{0} is not whole; what ffmpeg says is in {0}.log", video_->file().string()));
    video_.reset();
    state_.records = false;
    state_.recording.clear();
  };
  if (video_ && (!state_.records || video_->size() != view_)) end();
  if (!state_.records) return;
  try {
    if (!video_) {
      std::error_code ignored;
      fs::create_directories(state_.shotFolder, ignored);
      video_.emplace(freeName(state_.shotFolder, state_.scene->name + "_video", {".mp4"}).string() + ".mp4", view_);
      state_.say(fmt::format("recording {}", video_->file().string()));
    }
    if (!video_->add(shownPicture(view_), seconds)) {
      end();
      return;
    }
    state_.recording = fmt::format("recording {}: {:.1f} s", video_->file().string(),
                                   static_cast<double>(video_->pictures()) / Video::kPicturesASecond);
  } catch (const Error& error) {
    state_.records = false;
    state_.say(error.what());
  }
}

void WalkWindow::beginCapture() {
  captures_ = std::exchange(state_.captureWanted, false) || frames_ == options_.capture;
  if (!captures_) return;
  if (renderDoc_) renderDoc_->begin();
  else state_.say("RenderDoc is missing: install it and start with walk --capture N");
}

void WalkWindow::endCapture() {
  if (!captures_ || !renderDoc_) return;
  const auto file = renderDoc_->end();
  state_.say(file ? fmt::format("RenderDoc: {}", *file) : "RenderDoc saw no frame on this host");
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
  for (SideState& side : state_.sides)
    if (side.renderer && side.renderer->size() != pictureSize()) {
      side.renderer->resize(pictureSize());
      side.settled = false;
      side.judgement.clear();
      changed();
    }
}

glm::ivec2 WalkWindow::pictureSize() const {
  return glm::max(glm::ivec2(glm::vec2(view_) * state_.renderScale), glm::ivec2(1));
}

void WalkWindow::drawUi(const HostInput& input, double seconds, const std::string& work, double share) {
  if (!ui_) ui_.emplace(programs_, host_, host_.contentScale());
  if (work.empty()) ui_->begin(input, window_, seconds);
  else ui_->beginNote(window_, seconds);
  if (work.empty()) {
    ui_->beginWindows();
    if (state_.panel) Panel::show(*ui_, state_, host_);
    if (state_.help) Panel::showHelp(*ui_, state_);
    Panel::showValues(state_);
  }
  Panel::showMessage(state_, work, share);
  ui_->end(pictureTarget_);
}

// Controls that recorded input uses by name must exist; apart from them, nothing invisible is built.
bool WalkWindow::drawsUi() const {
  return state_.panel || state_.help || state_.hint ||
         (!state_.messages.empty() && state_.messageAge < kMessageSeconds) || player_.has_value();
}

void WalkWindow::breathe(const std::string& what, double share) {
  const bool measures = !options_.common.json.empty() && !player_;
  if (measures || window_.x <= 0 || secondsSince(lastBreath_) < 0.1) return;
  if (!player_) {
    const HostInput input = host_.poll();
    if (input.closeRequested) stop_ = true;
    if (stop_ || interrupted() || input.pressed.find('\x1b') != std::string::npos) throw Stopped(what);
    if (host_.framebufferSize() != window_) return;  // the next frame handles it
  }
  drawUi({}, 0.02, what, share);
  host_.present(pictureTarget_.id(), window_);
  lastBreath_ = Clock::now();
}

void WalkWindow::pace(Clock::time_point start) {
  if (state_.frameLimit <= 0 || player_) return;
  std::this_thread::sleep_until(
      start + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1.0 / state_.frameLimit)));
}

void WalkWindow::run() {
  const auto begin = Clock::now();
  auto frameStart = begin, titleTime = begin;
  compare_.emplace(programs_);
  while (takeInput()) {
    const auto start = Clock::now();
    const double measured = frames_ > 0 ? std::chrono::duration<double>(start - frameStart).count() : 0.0;
    const double dt = player_ ? kPlayedFrame : measured;
    frameStart = start;
    const glm::ivec2 window = host_.kind() == HostKind::window ? host_.framebufferSize() : playedSize_;
    if (window.x <= 0 || window.y <= 0) {  // minimised
      if (!player_) std::this_thread::sleep_for(std::chrono::milliseconds(20));
      ++frames_;
      continue;
    }
    resizeTo(window);
    loadWantedScene();
    makeReady();
    if (stop_) break;
    moveCamera(dt);
    beginCapture();
    draw();
    makeReference(measured);
    compose();
    recordVideo(dt);
    if (drawsUi()) {
      drawUi(input_, dt, "", -1.0);
      if (player_)
        if (const auto file = player_->takeSave()) writePng(*file, shownPicture(window_));
      host_.present(pictureTarget_.id(), window_);
    } else if (!presented_) {
      host_.present(pictureTarget_.id(), window_);
    }
    endCapture();
    ++still_;
    ++frames_;
    state_.messageAge += dt;
    sinceHint_ += dt;
    if (sinceHint_ > kHintSeconds) state_.hint = false;
    state_.frameMs.push_back(static_cast<float>(1e3 * secondsSince(start)));
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
  recordVideo(0.0);
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
                         {"seconds_in_frames", referenceTime_.spent()},
                         {"seconds_of_frames", referenceTime_.rest()},
                         {"longest_in_a_frame", referenceTime_.longest()}};
    for (std::size_t i = 0; i < 2; ++i)
      if (const Judgement& j = state_.sides[i].judgement; j.known())
        json["reference"][i == 0 ? "a" : "b"] = {
            {"nrmse", j.nrmse().value}, {"low", j.nrmse().low}, {"high", j.nrmse().high}, {"bias", j.bias()}};
  }
  return json;
}

}  // namespace lucerna::demo
