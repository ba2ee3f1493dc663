// Recorded input: what keyboard, mouse and window do, frame by frame, from a text file. Tests drive the window with it,
// on every host.
//
// A line an event, `FRAME VERB ...`, frames ascending from 0; '#' starts a comment:
//   key NAME         down and up again: A, F1, space, tab, control+Z, ... (host/input.hpp)
//   down NAME        up NAME
//   cursor X Y       pixels from the top left
//   press B          release B: left, right, middle
//   click X Y        wheel STEPS       text WORDS
//   touch LABEL      click the panel's control of that name, such as `Light/sun height`; it is scrolled into view first
//   touch *          every control once, also those that appear on the way; the next line waits for it
//   touch LABEL*     the same of those whose names begin so, such as `Light/*`
//   drop FILE        relative to the input file
//   resize W H       also 0 0: minimised
//   focus on|off     close
//   save FILE        what the window shows in that frame, panel and all, as PNG; relative to the working directory
#pragma once

#include "host/input.hpp"
#include "walk/ui.hpp"

#include <deque>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace lucerna::demo {

class InputPlayer {
 public:
  /// Throws Error(badInput) naming file and line.
  explicit InputPlayer(const std::filesystem::path& file);

  /// Queues the input of the next frame. `ui` finds controls by name; throws Error(badInput) if one does not appear
  /// within kPatience frames.
  void next(Ui* ui);
  InputState& input() { return state_; }
  /// The size set by `resize` in this frame.
  std::optional<glm::ivec2> takeSize() { return std::exchange(size_, std::nullopt); }
  /// The file set by `save` in this frame.
  std::optional<std::filesystem::path> takeSave() { return std::exchange(save_, std::nullopt); }
  /// Whether all events are done.
  bool done() const { return events_.empty() && touching_.empty() && !every_; }
  const std::set<std::string>& touched() const { return touched_; }
  /// Controls that disappeared before they could be touched, and did not come back.
  const std::set<std::string>& gone() const { return gone_; }

 private:
  static constexpr int kPatience = 60, kSettles = 4;  // frames
  static constexpr int kAttempts = 4;
  struct Event {
    int line = 0;
    int frame = 0;
    std::string verb, rest;
  };
  void act(const Event& event);
  void touch(Ui* ui);
  void chooseNext(Ui& ui);
  [[noreturn]] void fail(int line, const std::string& what) const;

  std::filesystem::path file_;
  std::deque<Event> events_;
  InputState state_;
  std::optional<glm::ivec2> size_;
  std::optional<std::filesystem::path> save_;
  int frame_ = 0;
  // The control being touched, in steps: found, cursor over it, button down, button up.
  std::string touching_;
  int touchingLine_ = 0, touchStep_ = 0, waited_ = 0, idle_ = 0;
  glm::vec2 restsAt_{-1.0f};  ///< position of the control in the previous frame
  int rests_ = 0;  ///< frames
  std::optional<std::string> every_;  ///< being touched: controls whose names begin so
  std::set<std::string> touched_, gone_;
  std::map<std::string, int> attempts_;  ///< to bring a control into view
};

}  // namespace lucerna::demo
