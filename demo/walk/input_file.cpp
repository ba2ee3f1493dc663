#include "walk/input_file.hpp"

#include "base/error.hpp"
#include "base/files.hpp"
#include "base/nearest_words.hpp"

#include <fmt/format.h>

#include <sstream>

namespace lucerna::demo {

namespace {

MouseButton buttonNamed(const std::string& name, bool& known) {
  known = name == "left" || name == "right" || name == "middle";
  return name == "right" ? MouseButton::right : name == "middle" ? MouseButton::middle : MouseButton::left;
}

}  // namespace

InputPlayer::InputPlayer(const std::filesystem::path& file) : file_(file) {
  std::istringstream text(readFileText(file));
  std::string line;
  for (int number = 1; std::getline(text, line); ++number) {
    line = line.substr(0, line.find('#'));
    std::istringstream words(line);
    Event event;
    event.line = number;
    if (std::string first; !(words >> first)) continue;
    words.clear();
    words.seekg(0);
    if (!(words >> event.frame >> event.verb) || event.frame < 0) fail(number, "expected FRAME VERB ...");
    std::getline(words >> std::ws, event.rest);
    while (!event.rest.empty() && std::isspace(static_cast<unsigned char>(event.rest.back()))) event.rest.pop_back();
    if (!events_.empty() && event.frame < events_.back().frame)
      fail(number, fmt::format("frame {} comes after frame {}", event.frame, events_.back().frame));
    events_.push_back(event);
  }
}

void InputPlayer::fail(int line, const std::string& what) const {
  throwBadInput("{}:{}: {}", file_.string(), line, what);
}

void InputPlayer::act(const Event& event) {
  std::istringstream words(event.rest);
  const auto numbers = [&]() -> glm::dvec2 {
    glm::dvec2 v(0.0);
    if (!(words >> v.x >> v.y)) fail(event.line, fmt::format("{}: expected two numbers", event.verb));
    return v;
  };
  const auto keys = [&](bool down, bool up) {
    std::vector<int> codes;
    for (std::string rest = event.rest; !rest.empty();) {
      const std::size_t plus = rest.find('+', 1);
      codes.push_back(key::named(rest.substr(0, plus)));
      if (codes.back() < 0) fail(event.line, fmt::format("{}: no such key", rest.substr(0, plus)));
      rest = plus == std::string::npos ? "" : rest.substr(plus + 1);
    }
    if (down)
      for (const int code : codes) state_.key(code, true);
    if (up)
      for (auto code = codes.rbegin(); code != codes.rend(); ++code) state_.key(*code, false);
  };
  const auto button = [&](bool down) {
    bool known = false;
    const MouseButton which = buttonNamed(event.rest, known);
    if (!known) fail(event.line, fmt::format("{}: expected left, right or middle", event.verb));
    state_.button(which, down);
  };
  const auto onOff = [&] {
    if (event.rest != "on" && event.rest != "off") fail(event.line, "expected on or off");
    return event.rest == "on";
  };
  if (event.verb == "key") keys(true, true);
  else if (event.verb == "down") keys(true, false);
  else if (event.verb == "up") keys(false, true);
  else if (event.verb == "cursor") state_.cursor(numbers());
  else if (event.verb == "press") button(true);
  else if (event.verb == "release") button(false);
  else if (event.verb == "click")
    state_.cursor(numbers()), state_.button(MouseButton::left, true), state_.button(MouseButton::left, false);
  else if (event.verb == "wheel") state_.wheel({0.0, std::strtod(event.rest.c_str(), nullptr)});
  else if (event.verb == "text") state_.text(event.rest);
  else if (event.verb == "drop") state_.drop(file_.parent_path() / event.rest);
  else if (event.verb == "resize") size_ = glm::ivec2(numbers());
  else if (event.verb == "focus") state_.focus(onOff());
  else if (event.verb == "close") state_.close();
  else if (event.verb == "save") save_ = event.rest;
  else if (event.verb == "touch") {
    every_.reset();
    touching_ = event.rest;
    if (touching_.ends_with('*')) every_ = std::exchange(touching_, "").substr(0, event.rest.size() - 1);
    touchingLine_ = event.line;
    touchStep_ = waited_ = rests_ = 0;
  } else {
    fail(event.line,
         fmt::format("{}: unknown; expected one of key, down, up, cursor, press, release, click, wheel, text, "
                     "touch, drop, resize, focus, save, close",
                     event.verb));
  }
}

// Existing controls come first: items of an open menu ("Section/menu: item", any of them closes it), then other
// controls. For a missing one its section or menu is opened; if it still does not appear, it is gone.
void InputPlayer::chooseNext(Ui& ui) {
  const auto isItem = [](const std::string& label) { return label.find(": ") != std::string::npos; };
  const auto isWanted = [&](const std::string& label) { return label.starts_with(*every_); };
  const auto parentOf = [&](const std::string& label) {
    return isItem(label) ? label.substr(0, label.find(": ")) : label.substr(0, label.find('/'));
  };
  touchStep_ = waited_ = rests_ = 0;
  touching_.clear();
  for (const std::string& label : ui.labels())
    if (isWanted(label) && isItem(label) && ui.isThere(label) && (touching_.empty() || touched_.contains(touching_)))
      touching_ = label;
  if (!touching_.empty()) return;
  const auto isSection = [](const std::string& label) { return label.find('/') == std::string::npos; };
  for (const bool sections : {false, true})
    for (const std::string& label : ui.labels())
      if (isWanted(label) && isSection(label) == sections && !touched_.contains(label) && ui.isThere(label) &&
          attempts_[label] < kAttempts) {
        touching_ = label;
        idle_ = 0;
        return;
      }
  if (++idle_ < kSettles) return;  // what the last one changed may reveal others
  idle_ = 0;
  for (const std::string& label : ui.labels()) {
    if (!isWanted(label) || touched_.contains(label) || gone_.contains(label)) continue;
    std::string parent = parentOf(label);
    if (!ui.isThere(parent)) parent = parentOf(parent);  // the section of a menu
    if (++attempts_[label] > kAttempts || !ui.isThere(parent)) {
      gone_.insert(label);
      continue;
    }
    touching_ = parent;
    return;
  }
  every_.reset();
}

void InputPlayer::touch(Ui* ui) {
  if (!ui) fail(touchingLine_, "touch: there is no panel in this run");
  if (touching_.empty()) chooseNext(*ui);
  if (touching_.empty()) return;
  const auto place = ui->find(touching_);
  if (touchStep_ == 0 && (!place || !place->visible)) {
    if (++waited_ <= kPatience) return;
    if (every_) {  // it disappeared with its parent
      ++attempts_[touching_];
      gone_.insert(touching_);
      touching_.clear();
      return;
    }
    const std::set<std::string>& known = ui->labels();
    fail(touchingLine_, fmt::format("{}: the panel shows no such control; nearest: {}", touching_,
                                    nearestList(touching_, {known.begin(), known.end()})));
  }
  // The panel scrolls to it for some frames: it is touched once it has stopped moving.
  if (touchStep_ == 0) {
    rests_ = place->centre == restsAt_ ? rests_ + 1 : 0;
    restsAt_ = place->centre;
    if (rests_ < kSettles) return;
  }
  // One frame each: move the cursor over it, press, release.
  if (touchStep_ == 0 && place) state_.cursor(glm::dvec2(place->centre));
  if (touchStep_ == 1) state_.button(MouseButton::left, true);
  if (touchStep_ == 2) state_.button(MouseButton::left, false);
  if (++touchStep_ < 4) return;
  touched_.insert(touching_);
  gone_.erase(touching_);  // it came back
  touching_.clear();
  touchStep_ = 0;
}

void InputPlayer::next(Ui* ui) {
  if (every_ || !touching_.empty()) {
    touch(ui);
  } else {
    while (!events_.empty() && events_.front().frame <= frame_ && touching_.empty() && !every_) {
      const Event event = events_.front();
      events_.pop_front();
      act(event);
    }
  }
  ++frame_;
}

}  // namespace lucerna::demo
