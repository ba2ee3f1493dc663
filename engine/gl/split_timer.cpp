#include "gl/split_timer.hpp"

namespace lucerna::gl {

SplitTimer::~SplitTimer() {
  for (Frame& frame : ring_)
    if (frame.queries[0]) glDeleteQueries(static_cast<GLsizei>(frame.queries.size()), frame.queries.data());
}

void SplitTimer::mark(std::size_t moment) {
  if (finishes_) {
    glFinish();
    clock_[moment] = std::chrono::steady_clock::now();
    return;
  }
  Frame& frame = ring_[next_];
  if (!frame.queries[0]) glGenQueries(static_cast<GLsizei>(frame.queries.size()), frame.queries.data());
  if (!frame.isPending) glQueryCounter(frame.queries[moment], GL_TIMESTAMP);
}

std::vector<SplitTimer::Times> SplitTimer::end(int label) {
  mark(2);
  if (finishes_) {
    const auto ms = [&](std::size_t moment) {
      return std::chrono::duration<double, std::milli>(clock_[moment] - clock_[moment - 1]).count();
    };
    return {{ms(1), ms(2), label}};
  }
  if (!ring_[next_].isPending) {
    ring_[next_].isPending = true;
    ring_[next_].label = label;
  }
  std::vector<Times> arrived;
  for (std::size_t i = 1; i <= kRing; ++i) {  // the oldest first
    Frame& frame = ring_[(next_ + i) % kRing];
    if (!frame.isPending) continue;
    GLint isKnown = GL_FALSE;
    glGetQueryObjectiv(frame.queries[2], GL_QUERY_RESULT_AVAILABLE, &isKnown);
    if (!isKnown) break;
    std::array<GLuint64, 3> ns{};
    for (std::size_t k = 0; k < ns.size(); ++k) glGetQueryObjectui64v(frame.queries[k], GL_QUERY_RESULT, &ns[k]);
    const auto ms = [&](std::size_t moment) { return 1e-6 * static_cast<double>(ns[moment] - ns[moment - 1]); };
    arrived.push_back({ms(1), ms(2), frame.label});
    frame.isPending = false;
  }
  next_ = (next_ + 1) % kRing;
  return arrived;
}

}  // namespace lucerna::gl
