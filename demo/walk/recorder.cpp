#include "walk/recorder.hpp"

#include "base/error.hpp"
#include "base/files.hpp"
#include "gl/read_pictures.hpp"
#include "inspect.hpp"
#include "shared/paths.hpp"
#include "walk/shots.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <utility>

namespace lucerna::demo {

namespace fs = std::filesystem;

Recorder::Recorder(WalkState& state) : state_(state), renderDoc_(RenderDoc::find()) {
  state.canCapture = renderDoc_.has_value();
  state.canRecord = Video::canBeMade();
}

void Recorder::takeShot(const Shown& shown) {
  state_.shotWanted = false;
  const SideState& side = state_.side();
  try {
    std::error_code ignored;
    fs::create_directories(state_.shotFolder, ignored);
    const fs::path stem = freeName(state_.shotFolder, state_.scene->name);
    std::string note = fmt::format("Lucerna {} on {}\n{} --camera {} --size {}x{}\nexposure {:.6g}", LUCERNA_VERSION,
                                   state_.rendererName, commandLine("render", state_.scene->file.string(), side.built),
                                   cameraText(*state_.scene, state_.camera->camera()), side.renderer->size().x,
                                   side.renderer->size().y, state_.exposure);
    if (side.judgement.known())
      note += fmt::format("\nrelative error {:.4g}, {:.4g} to {:.4g} (99 %), against {} path-traced samples a pixel",
                          side.judgement.nrmse().value, side.judgement.nrmse().low, side.judgement.nrmse().high,
                          state_.reference ? state_.reference->samples() : 0);
    writePngWithNote(stem.string() + ".png", gl::readBitmap(shown.picture, shown.view), note);
    if (side.renderer) writeHdrWithNote(stem.string() + ".hdr", side.renderer->readRadiance(), note);
    state_.say(fmt::format("{}.png and .hdr written", stem.string()));
  } catch (const Error& error) { state_.say(error.what()); }
}

void Recorder::record(const Shown& shown, double seconds) {
  const auto end = [&] {
    const bool whole = video_->finish();
    state_.say(whole ? fmt::format("{}: {} pictures", video_->file().string(), video_->pictures())
                     : fmt::format("{0} is not whole; what ffmpeg says is in {0}.log", video_->file().string()));
    video_.reset();
    state_.records = false;
    state_.recording.clear();
  };
  if (video_ && (!state_.records || video_->size() != shown.view)) end();
  if (!state_.records) return;
  try {
    if (!video_) {
      std::error_code ignored;
      fs::create_directories(state_.shotFolder, ignored);
      video_.emplace(freeName(state_.shotFolder, state_.scene->name + "_video", {".mp4"}).string() + ".mp4",
                     shown.view);
      state_.say(fmt::format("recording {}", video_->file().string()));
    }
    if (!video_->add(gl::readBitmap(shown.picture, shown.view), seconds)) {
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

void Recorder::beginCapture(bool isRequested) {
  captures_ = std::exchange(state_.captureWanted, false) || isRequested;
  if (!captures_) return;
  if (renderDoc_) renderDoc_->begin();
  else state_.say("RenderDoc is missing: install it and start with walk --capture N");
}

void Recorder::endCapture() {
  if (!captures_ || !renderDoc_) return;
  const auto file = renderDoc_->end();
  state_.say(file ? fmt::format("RenderDoc: {}", *file) : "RenderDoc saw no frame on this host");
}

}  // namespace lucerna::demo
