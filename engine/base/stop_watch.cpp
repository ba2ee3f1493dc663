#include "base/stop_watch.hpp"

#include "base/error.hpp"

#include <fmt/format.h>

#include <utility>

namespace lucerna {

namespace {
thread_local StopWatch* innermostStopWatch = nullptr;
}

StopWatch::StopWatch(std::function<bool(const LongWork&)> wantsStop)
    : wantsStop_(std::move(wantsStop)), outer_(std::exchange(innermostStopWatch, this)) {}

StopWatch::~StopWatch() { innermostStopWatch = outer_; }

bool StopWatch::wantsStop(const LongWork& work) { return innermostStopWatch && innermostStopWatch->wantsStop_(work); }

void StopWatch::check(const char* what, std::size_t done, std::size_t total) {
  if (wantsStop({what, total > 0 ? static_cast<double>(done) / static_cast<double>(total) : -1.0}))
    throw Stopped(fmt::format("stopped while {}; nothing of it is kept", what));
}

}  // namespace lucerna
