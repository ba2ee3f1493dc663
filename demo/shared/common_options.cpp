// Options of every command, including the labs: --host, --json and --quiet, progress, interruption.
#include "base/clock.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/log.hpp"
#include "shared/commands.hpp"
#include "gl/barrier_ledger.hpp"
#include "shared/completions.hpp"

#include <fmt/core.h>

#include <csignal>
#include <ctime>
#include <string>
#include <unistd.h>

namespace lucerna::demo {

void CommonOptions::declare(Command app) {
  addCompletions(app.addOption("--host", host,
                               "creates the OpenGL context: window, egl or osmesa (default: LUCERNA_HOST, else as in "
                               "docs/commands.md)"),
                 {"window", "egl", "osmesa"});
  app.addOption("--json", json, "write machine-readable results to this file");
  app.addFlag("--quiet", quiet, "no warnings, no progress");
  app.addFlag("--check-barriers", checkBarriers,
              "report missing memory barriers as errors; LUCERNA_CHECK_BARRIERS=1 does so too");
}

std::string CommonOptions::requestedHost() const {
  const char* environment = std::getenv("LUCERNA_HOST");
  return !host.empty() ? host : environment ? environment : "";
}

void CommonOptions::apply() const {
  if (const std::string asked = requestedHost(); !asked.empty()) parseHostKind(asked);
  if (!json.empty()) checkWritable(json);
  if (quiet) setLogLevel(LogLevel::quiet);
  if (const char* verbose = std::getenv("LUCERNA_VERBOSE"); verbose && *verbose) setLogLevel(LogLevel::verbose);
}

std::unique_ptr<Host> CommonOptions::makeHost(bool wantsWindow, const HostOptions& options) const {
  if (checkBarriers || gl::barriersCheckedByDefault()) gl::checkBarriers();
  const std::string asked = requestedHost();
  return asked.empty() ? Host::createDefault(wantsWindow, options) : Host::create(parseHostKind(asked), options);
}

void CommonOptions::writeJson(const nlohmann::ordered_json& value) const {
  if (!json.empty()) writeFileAtomically(json, value.dump(2) + "\n");
}

Progress::Progress(std::string what, int total, bool quiet)
    : what_(std::move(what)),
      total_(total),
      enabled_(!quiet),
      isTerminal_(isatty(STDERR_FILENO) != 0),
      start_(Clock::now()),
      line_(start_) {}

Progress::~Progress() {
  if (drawn_) fmt::print(stderr, "\r\x1b[K");
}

void Progress::update(int done) {
  if (!enabled_) return;
  const double seconds = secondsSince(start_);
  const std::string rest = done > 0 ? fmt::format(", {:.0f} s left", seconds / done * (total_ - done)) : "";
  if (!isTerminal_) {
    constexpr double kBetweenLines = 30.0;
    if (secondsSince(line_) < kBetweenLines) return;
    fmt::print(stderr, "{}: {}/{}{}\n", what_, done, total_, rest);
    line_ = Clock::now();
    return;
  }
  if (seconds < 1.0 && !drawn_) return;
  constexpr int kWidth = 30;
  const int filled = total_ > 0 ? kWidth * done / total_ : 0;
  fmt::print(stderr, "\r{} [{:#<{}}{:-<{}}] {}/{}{} \x1b[K", what_, "", filled, "", kWidth - filled, done, total_,
             rest);
  std::fflush(stderr);
  drawn_ = true;
}

void Progress::update(const std::string& what, double share) {
  if (what != what_) {
    what_ = what;
    start_ = Clock::now();
  }
  update(static_cast<int>(share * total_));
}

namespace {
volatile std::sig_atomic_t g_interrupted = 0;  // the signal's number
volatile std::time_t g_interruptedAt = 0;

void onInterrupt(int signal) {
  // A second Ctrl-C does not wait for the work to end. One that arrives together with the first (timeout signals a
  // whole group) counts as the same.
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  if (g_interrupted && now.tv_sec > g_interruptedAt + 1) std::_Exit(128 + signal);
  if (g_interrupted) return;
  g_interruptedAt = now.tv_sec;
  g_interrupted = signal;
}
}  // namespace

void watchForInterrupt() {
  std::signal(SIGINT, onInterrupt);
  std::signal(SIGTERM, onInterrupt);
}

void endAtInterrupt() {
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
  if (g_interrupted) throw Stopped("stopped");
}

bool interrupted() { return g_interrupted != 0; }

int exitCode() { return g_interrupted ? 128 + g_interrupted : 0; }

}  // namespace lucerna::demo
