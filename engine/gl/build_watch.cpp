#include "gl/build_watch.hpp"

#include <utility>

namespace lucerna::gl {

namespace {
thread_local BuildWatch* innermost = nullptr;
}

BuildWatch::BuildWatch(std::function<void(const std::string& name)> watch)
    : watch_(std::move(watch)), outer_(std::exchange(innermost, this)) {}

BuildWatch::~BuildWatch() { innermost = outer_; }

void BuildWatch::say(const std::string& name) {
  if (innermost) innermost->watch_(name);
}

}  // namespace lucerna::gl
