#include "walk/reference_work.hpp"

#include "base/clock.hpp"
#include "base/error.hpp"
#include "gl/build_watch.hpp"
#include "gl/read_pictures.hpp"
#include "gl/wait.hpp"
#include "walk/live_reference.hpp"

#include <algorithm>

namespace lucerna::demo {

// Everything counts: sampling, reading back, judging. While pictures are still changing, the reference gets at most its
// share of the frames' own time; once they are still, all idle time.
void ReferenceWork::doShare(double frameSeconds, const Frame& frame) {
  constexpr double kIdleSeconds = 0.03;  // per frame, so that the panel still responds
  constexpr double kLongestFrame = 1.0;  // longer frames are something else, such as compiling
  if (!state_.liveReferenceOn || !state_.side().renderer) return;
  const double share = std::clamp(static_cast<double>(state_.referenceShare), 0.01, 0.9);
  const double submission = state_.reference ? state_.reference->submissionSeconds() : 0.0;
  time_.frame(frameSeconds, share, std::max(4.0 * submission, share * std::min(frameSeconds, kLongestFrame)));
  if (!frame.isStill) return;
  const bool idle = frame.isSettled;
  if (!idle && time_.left() < submission) return;
  gl::finish();  // the picture's work must not count as the reference's
  auto start = Clock::now();
  if (seek(frame)) start = Clock::now();  // compiling happens once and is not counted
  if (state_.reference) state_.reference->advance(idle ? kIdleSeconds : time_.left());
  judge(frame);
  if (idle) time_.idle(secondsSince(start));
  else time_.spend(secondsSince(start));
}

/// Provides the path tracer for the current view. Returns whether it had to be made.
bool ReferenceWork::seek(const Frame& frame) {
  bool made = false;
  const SideState& shown = state_.side();
  const glm::ivec2 size = shown.renderer->size();
  const Component component = shown.renderer->settings().component;
  if (!state_.reference || state_.reference->size() != size || state_.reference->component() != component ||
      state_.reference->filter() != shown.renderer->settings().filter || version_ != state_.sceneVersion ||
      state_.reference->denoises() != state_.referenceDenoised) {
    try {
      frame.note("making the path tracer");
      const gl::BuildWatch watch([&](const std::string& name) { frame.note("compiling " + name); });
      state_.reference.reset();
      state_.reference =
          std::make_unique<LiveReference>(context_, programs_, *state_.scene, size, shown.renderer->settings().filter,
                                          component, state_.referenceDenoised);
      version_ = state_.sceneVersion;
      camera_.reset();
      made = true;
    } catch (const Error& error) {
      state_.liveReferenceOn = false;
      state_.say(error.what());
    } catch (const Stopped&) { state_.liveReferenceOn = false; }
    if (!state_.reference) return made;
  }
  if (!camera_ || !camera_->seesAs(state_.camera->camera())) {
    camera_ = state_.camera->camera();
    state_.reference->look(*camera_);
    for (SideState& side : state_.sides) side.judgement.clear(), side.judgedReference = 0;
  }
  return made;
}

// At most twice a second, since pictures are read back.
void ReferenceWork::judge(const Frame& frame) {
  if (!state_.reference || !state_.reference->ready()) return;
  for (SideState& side : state_.sides) side.judgement.flip();  // takes up its FLIP picture once that is computed
  if (frame.now - judged_ < 0.5) return;
  judged_ = frame.now;
  for (int i = 0; i < 2; ++i) {
    SideState& side = state_.sides[static_cast<std::size_t>(i)];
    if (!state_.isVisible(i) || side.shows == Shows::reference) continue;
    if (side.judgedReference == state_.reference->version() && side.judgedPicture == side.pictureVersion) continue;
    side.judgedReference = state_.reference->version();
    side.judgedPicture = side.pictureVersion;
    if (side.shows == Shows::picture) {
      if (!side.picture || side.picture->size2d() != state_.reference->size()) continue;
      side.judgement.judge(gl::readImage(*side.picture), state_.reference->reference(), frame.isSettled);
    } else if (side.renderer && side.renderer->size() == state_.reference->size()) {
      side.judgement.judge(side.renderer->readRadiance(), state_.reference->reference(), frame.isSettled);
    }
  }
}

}  // namespace lucerna::demo
