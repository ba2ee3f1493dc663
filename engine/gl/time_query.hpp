// GPU time of named stages, without ever waiting for a result, and their wall-clock time.
//
// A stage is one GL_TIME_ELAPSED query per frame, from a ring per stage: results are fetched when they have arrived,
// some frames later. The first result of each stage is a warm-up and is dropped (on llvmpipe it can be garbage). On a
// software renderer a query sees only rasterisation, since vertices are processed at submission. There `finishStages`
// puts glFinish around each stage, and the wall-clock time is the one to use. Both are recorded.
//
// A driver's answer may be wrong (Mesa 26.2's llvmpipe: hours). One that is longer than the wall clock around its query
// is refused, as is a query without an answer after some seconds.
#pragma once

#include "host/api.hpp"

#include <array>
#include <chrono>
#include <limits>
#include <string>
#include <vector>

namespace lucerna::gl {

/// Times are NaN where there is no sample.
struct StageStatistics {
  std::string name;
  std::size_t count = 0;  ///< samples after the warm-up
  double medianMs = 0.0, p95Ms = 0.0;  ///< the time to use: query on hardware, wall clock on software
  double queryMedianMs = 0.0, queryP95Ms = 0.0;
  double wallMedianMs = 0.0, wallP95Ms = 0.0;  ///< NaN unless stages are finished
  std::size_t refused = 0;  ///< queries answered wrongly or not at all, after the warm-up
  std::size_t ran = 0, frames = 0;  ///< how often it ran, in how many frames; a stage with unchanged inputs runs once
  /// Average per frame saved because it did not run in every frame. A stage that ran only in the warm-up counts with
  /// that time; one without any sample with 0.
  double savedMs() const;
};

class TimeQuery {
 public:
  /// finishStages: glFinish before and after each stage, and wall-clock times. lostMs: a query without an answer for
  /// that long is refused.
  explicit TimeQuery(bool finishStages, double lostMs = 10000.0) : finishStages_(finishStages), lostMs_(lostMs) {}
  ~TimeQuery();
  TimeQuery(const TimeQuery&) = delete;
  TimeQuery& operator=(const TimeQuery&) = delete;

  /// Stages do not nest (GL_TIME_ELAPSED cannot).
  void begin(const std::string& stage);
  void end();
  /// Fetches results that have arrived. Call once per frame.
  void collect();
  /// Waits for all pending results, for lostMs at most; for the end of a run, not for a frame.
  void drain();

  /// In order of first appearance.
  std::vector<StageStatistics> statistics() const;
  /// Raw samples of a stage in milliseconds (after the warm-up), query or wall clock.
  const std::vector<double>& querySamples(const std::string& stage) const;
  const std::vector<double>& wallSamples(const std::string& stage) const;
  /// Samples lost because all queries of the ring were pending.
  std::size_t dropped() const { return dropped_; }
  void reset();

  /// begin and end as a scope.
  class Scope {
   public:
    Scope(TimeQuery& timer, const std::string& stage) : timer_(timer) { timer_.begin(stage); }
    ~Scope() { timer_.end(); }
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;

   private:
    TimeQuery& timer_;
  };

 private:
  static constexpr std::size_t kRing = 6;
  static constexpr double kNoTime = std::numeric_limits<double>::quiet_NaN();
  using Clock = std::chrono::steady_clock;
  struct Query {
    GLuint name = 0;
    bool pending = false;
    Clock::time_point begun;
    double mostMs = 0.0;  ///< wall clock around it; infinite until its stage is finished
  };
  struct Stage {
    std::string name;
    std::array<Query, kRing> queries{};
    std::size_t next = 0, oldest = 0;
    bool warmQuery = false, warmWall = false;
    double firstQueryMs = kNoTime, firstWallMs = kNoTime;  ///< the warm-up
    std::size_t ran = 0, refused = 0;
    std::vector<double> queryMs, wallMs;
  };
  Stage& stage(const std::string& name);
  void fetch(Stage& stage, bool wait);

  bool finishStages_;
  double lostMs_;
  std::vector<Stage> stages_;
  Stage* current_ = nullptr;
  bool currentQuery_ = false;
  Clock::time_point start_;
  std::size_t dropped_ = 0, frames_ = 0;
};

}  // namespace lucerna::gl
