#include "gl/time_query.hpp"

#include "base/error.hpp"
#include "base/statistics.hpp"
#include "gl/pass.hpp"

#include <algorithm>
#include <cmath>
#include <thread>

namespace lucerna::gl {

namespace {

using Milliseconds = std::chrono::duration<double, std::milli>;

/// A GPU's clock and ours differ by parts per million, and its ticks may last microseconds.
bool isPossible(double queryMs, double wallMs) { return queryMs <= 1.01 * wallMs + 0.01; }

}  // namespace

TimeQuery::~TimeQuery() {
  for (Stage& s : stages_)
    for (Query& query : s.queries) glDeleteQueries(1, &query.name);
}

TimeQuery::Stage& TimeQuery::stage(const std::string& name) {
  for (Stage& s : stages_)
    if (s.name == name) return s;
  Stage& s = stages_.emplace_back();
  s.name = name;
  for (Query& query : s.queries) glGenQueries(1, &query.name);
  return s;
}

void TimeQuery::begin(const std::string& name) {
  CHECK(!current_, "stage {} begun inside stage {}", name, current_->name);
  current_ = &stage(name);
  ++current_->ran;
  pushDebugGroup(name);
  if (finishStages_) glFinish();
  fetch(*current_, false);
  start_ = Clock::now();
  Query& query = current_->queries[current_->next];
  currentQuery_ = !query.pending;
  if (currentQuery_) {
    query.begun = start_;
    query.mostMs = std::numeric_limits<double>::infinity();
    glBeginQuery(GL_TIME_ELAPSED, query.name);
  } else {
    ++dropped_;
  }
}

void TimeQuery::end() {
  CHECK(current_, "no stage was begun");
  Stage& s = *current_;
  if (currentQuery_) glEndQuery(GL_TIME_ELAPSED);
  if (finishStages_) {
    glFinish();
    const double ms = Milliseconds(Clock::now() - start_).count();
    if (currentQuery_) s.queries[s.next].mostMs = ms;
    if (s.warmWall) s.wallMs.push_back(ms);
    else s.firstWallMs = ms;
    s.warmWall = true;
  }
  if (currentQuery_) {
    s.queries[s.next].pending = true;
    s.next = (s.next + 1) % kRing;
  }
  glPopDebugGroup();
  current_ = nullptr;
}

void TimeQuery::fetch(Stage& s, bool wait) {
  while (s.queries[s.oldest].pending) {
    Query& query = s.queries[s.oldest];
    const auto age = [&] { return Milliseconds(Clock::now() - query.begun).count(); };
    GLint available = GL_FALSE;
    glGetQueryObjectiv(query.name, GL_QUERY_RESULT_AVAILABLE, &available);
    for (; !available && wait && age() < lostMs_; std::this_thread::sleep_for(std::chrono::milliseconds(1)))
      glGetQueryObjectiv(query.name, GL_QUERY_RESULT_AVAILABLE, &available);
    if (!available && age() < lostMs_) return;

    double ms = kNoTime;
    if (available) {
      GLuint64 nanoseconds = 0;
      glGetQueryObjectui64v(query.name, GL_QUERY_RESULT, &nanoseconds);
      ms = static_cast<double>(nanoseconds) * 1e-6;
      // The work was done between its submission and now, and within a stage that was finished.
      if (!isPossible(ms, std::min(query.mostMs, age()))) ms = kNoTime;
    } else {  // its answer may still come: not to the next query
      glDeleteQueries(1, &query.name);
      glGenQueries(1, &query.name);
    }
    if (!s.warmQuery) s.firstQueryMs = ms;
    else if (std::isnan(ms)) ++s.refused;
    else s.queryMs.push_back(ms);
    s.warmQuery = true;
    query.pending = false;
    s.oldest = (s.oldest + 1) % kRing;
  }
}

void TimeQuery::collect() {
  ++frames_;
  for (Stage& s : stages_) fetch(s, false);
}

void TimeQuery::drain() {
  glFlush();  // otherwise an answer need not come
  for (Stage& s : stages_) fetch(s, true);
}

double StageStatistics::savedMs() const {
  if (ran >= frames || std::isnan(medianMs)) return 0.0;
  return medianMs * static_cast<double>(frames - ran) / static_cast<double>(frames);
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
    r.refused = s.refused;
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
    s.ran = s.refused = 0;
  }
  frames_ = 0;
}

}  // namespace lucerna::gl
