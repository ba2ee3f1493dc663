#include "gl/time_query.hpp"

#include "base/error.hpp"
#include "base/statistics.hpp"
#include "gl/pass.hpp"

namespace lucerna::gl {

TimeQuery::~TimeQuery() {
  for (Stage& s : stages_) glDeleteQueries(kRing, s.queries.data());
}

TimeQuery::Stage& TimeQuery::stage(const std::string& name) {
  for (Stage& s : stages_)
    if (s.name == name) return s;
  Stage& s = stages_.emplace_back();
  s.name = name;
  glGenQueries(kRing, s.queries.data());
  return s;
}

void TimeQuery::begin(const std::string& name) {
  CHECK(!current_, "stage {} begun inside stage {}", name, current_->name);
  current_ = &stage(name);
  ++current_->ran;
  pushDebugGroup(name);
  if (finishStages_) glFinish();
  start_ = std::chrono::steady_clock::now();
  fetch(*current_, false);
  currentQuery_ = !current_->pending[current_->next];
  if (currentQuery_) glBeginQuery(GL_TIME_ELAPSED, current_->queries[current_->next]);
  else ++dropped_;
}

void TimeQuery::end() {
  CHECK(current_, "no stage was begun");
  Stage& s = *current_;
  if (currentQuery_) {
    glEndQuery(GL_TIME_ELAPSED);
    s.pending[s.next] = true;
    s.next = (s.next + 1) % kRing;
  }
  if (finishStages_) {
    glFinish();
    const double ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count();
    if (s.warmWall) s.wallMs.push_back(ms);
    else s.firstWallMs = ms;
    s.warmWall = true;
  }
  glPopDebugGroup();
  current_ = nullptr;
}

void TimeQuery::fetch(Stage& s, bool wait) {
  while (s.pending[s.oldest]) {
    const GLuint query = s.queries[s.oldest];
    GLint available = GL_FALSE;
    if (!wait) {
      glGetQueryObjectiv(query, GL_QUERY_RESULT_AVAILABLE, &available);
      if (!available) return;
    }
    GLuint64 nanoseconds = 0;
    glGetQueryObjectui64v(query, GL_QUERY_RESULT, &nanoseconds);
    if (s.warmQuery) s.queryMs.push_back(static_cast<double>(nanoseconds) * 1e-6);
    else s.firstQueryMs = static_cast<double>(nanoseconds) * 1e-6;
    s.warmQuery = true;
    s.pending[s.oldest] = false;
    s.oldest = (s.oldest + 1) % kRing;
  }
}

void TimeQuery::collect() {
  ++frames_;
  for (Stage& s : stages_) fetch(s, false);
}

void TimeQuery::drain() {
  for (Stage& s : stages_) fetch(s, true);
}

double StageStatistics::savedMs() const {
  return ran < frames ? medianMs * static_cast<double>(frames - ran) / static_cast<double>(frames) : 0.0;
}

std::vector<StageStatistics> TimeQuery::statistics() const {
  std::vector<StageStatistics> result;
  for (const Stage& s : stages_) {
    StageStatistics r;
    r.name = s.name;
    r.queryMedianMs = percentile(s.queryMs, 0.5);
    r.queryP95Ms = percentile(s.queryMs, 0.95);
    r.wallMedianMs = percentile(s.wallMs, 0.5);
    r.wallP95Ms = percentile(s.wallMs, 0.95);
    r.medianMs = finishStages_ ? r.wallMedianMs : r.queryMedianMs;
    r.p95Ms = finishStages_ ? r.wallP95Ms : r.queryP95Ms;
    r.count = finishStages_ ? s.wallMs.size() : s.queryMs.size();
    r.ran = s.ran;
    r.frames = frames_;
    if (r.count == 0) r.medianMs = r.p95Ms = finishStages_ ? s.firstWallMs : s.firstQueryMs;
    result.push_back(r);
  }
  return result;
}

namespace {
const std::vector<double> kNone;
}

const std::vector<double>& TimeQuery::querySamples(const std::string& name) const {
  for (const Stage& s : stages_)
    if (s.name == name) return s.queryMs;
  return kNone;
}

const std::vector<double>& TimeQuery::wallSamples(const std::string& name) const {
  for (const Stage& s : stages_)
    if (s.name == name) return s.wallMs;
  return kNone;
}

void TimeQuery::reset() {
  drain();
  for (Stage& s : stages_) {
    s.queryMs.clear();
    s.wallMs.clear();
    s.ran = 0;
  }
  frames_ = 0;
}

}  // namespace lucerna::gl
