#include "base/stop_watch.hpp"

#include "base/error.hpp"

#include <fmt/format.h>

#include <utility>

namespace lucerna {

namespace {
thread_local StopWatch* innermostStopWatch = nullptr;
}

StopWatch::StopWatch(std::function<bool()> wantsStop)
    : wantsStop_(std::move(wantsStop)), outer_(std::exchange(innermostStopWatch, this)) {}

StopWatch::~StopWatch() { innermostStopWatch = outer_; }

bool StopWatch::wantsStop() { return innermostStopWatch && innermostStopWatch->wantsStop_(); }

void StopWatch::check(const char* what) {
  if (wantsStop()) throw Stopped(fmt::format("stopped while {}; nothing of it is kept", what));
}

}  // namespace lucerna
