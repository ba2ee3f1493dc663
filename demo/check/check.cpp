#include "check/check.hpp"

#include "base/clock.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/json.hpp"
#include "base/log.hpp"
#include "base/provenance.hpp"
#include "bench/bench.hpp"
#include "check/child.hpp"
#include "check/report.hpp"
#include "gl/draw.hpp"
#include "shared/completions.hpp"
#include "shared/shell.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>

namespace lucerna::demo {

namespace check {

namespace {

namespace fs = std::filesystem;

struct CheckOptions {
  UnitInput input;
  double minutes = 10.0;
  std::vector<std::string> only;
  std::string unit;  ///< --part: this process is a child
  std::string writeReference;
};

struct Part {
  const char* name;
  double share;  ///< of the time
  std::vector<Unit> (*units)();
};
/// In order of value.
constexpr Part kParts[] = {{"context", 0.04, contextUnits}, {"pictures", 0.25, pictureUnits},
                           {"probes", 0.08, probeUnits},    {"programs", 0.15, programUnits},
                           {"stages", 0.28, stageUnits},    {"rays", 0.05, rayUnits},
                           {"error", 0.10, errorUnits},     {"sharing", 0.05, sharingUnits}};

/// The context always: reports name the driver.
bool isChosen(const std::vector<std::string>& only, const Unit& unit) {
  return only.empty() || unit.part == "context" ||
         std::ranges::any_of(only, [&](const std::string& word) { return word == unit.part || word == unit.key(); });
}

/// The units of a part that are to run, and the time by which they end, in seconds from the beginning.
struct Planned {
  std::string part;
  std::vector<Unit> units;
  double until = 0.0;
};

/// Throws Error(badInput) for words of --only that name nothing.
std::vector<Planned> planOf(const CheckOptions& options) {
  std::vector<Planned> plan;
  double shares = 0.0;
  for (const Part& part : kParts) {
    Planned planned{part.name, part.units(), 0.0};
    std::erase_if(planned.units, [&](const Unit& unit) { return !isChosen(options.only, unit); });
    if (!planned.units.empty()) shares += part.share;
    planned.until = shares;
    plan.push_back(std::move(planned));
  }
  for (const std::string& word : options.only) {
    std::string known;
    bool found = false;
    for (const Part& part : kParts) {
      known += (known.empty() ? "" : ", ") + std::string(part.name);
      for (const Unit& unit : part.units()) found = found || word == unit.part || word == unit.key();
    }
    if (!found) throwBadInput("--only {}: unknown; expected one of {}, or PART/NAME of a report", word, known);
  }
  for (Planned& planned : plan) planned.until *= 60.0 * options.minutes / shares;
  std::erase_if(plan, [](const Planned& planned) { return planned.units.empty(); });
  return plan;
}

// ---------------------------------------------------------------------------------------------------- a child

/// For tests: LUCERNA_CHECK_FAULT=KEY=FAULT makes that unit's process hang, crash, exit or fail.
void failAsRequested(const std::string& key) {
  const char* asked = std::getenv("LUCERNA_CHECK_FAULT");
  if (!asked || std::string(asked).substr(0, key.size() + 1) != key + "=") return;
  const std::string fault = std::string(asked).substr(key.size() + 1);
  at("a fault for a test");
  while (fault == "hang") ::pause();
  if (fault == "crash") std::raise(SIGSEGV);
  if (fault == "exit") std::_Exit(7);
  throw Error(ErrorKind::fault, "the driver reset the GPU: a test's");
}

int runChildUnit(const CheckOptions& options) {
  for (const Part& part : kParts)
    for (const Unit& unit : part.units()) {
      if (unit.key() != options.unit) continue;
      fs::create_directories(fs::path(options.input.out) / "pictures");
      at(unit.key());
      failAsRequested(unit.key());
      const Finding finding = unit.run(options.input);
      fmt::print("{}: {}\n", finding.right ? "right" : "wrong", finding.text);
      options.input.common.writeJson({{"right", finding.right}, {"text", finding.text}, {"figures", finding.figures}});
      return finding.right ? 0 : 1;
    }
  throwBadInput("--part {}: no such unit; a report lists them as PART/NAME", options.unit);
}

// ---------------------------------------------------------------------------------------------------- the parent

/// Rows and time so far, on disk: the machine itself may not survive a unit.
class State {
 public:
  State(const fs::path& folder, std::string identity) : file_(folder / "state.json"), identity_(std::move(identity)) {
    if (!fs::exists(file_)) return;
    try {
      const auto json = nlohmann::ordered_json::parse(readFileText(file_));
      if (json.at("identity") != identity_) {
        logWarning("{}: of another command or build; starting again", file_.string());
        return;
      }
      for (const auto& row : json.at("rows")) rows.push_back(rowOf(row));
      seconds_ = json.at("seconds").get<double>();
      running_ = json.at("running").get<std::string>();
      resumed = true;
    } catch (const std::exception& error) {
      logWarning("{}: damaged ({}); starting again", file_.string(), error.what());
      rows.clear();
    }
  }
  double seconds() const { return seconds_ + secondsSince(start_); }
  /// The unit that was running when an earlier process ended without saying why; empty: none.
  const std::string& running() const { return running_; }
  bool has(const std::string& key) const {
    return std::ranges::any_of(rows, [&](const Row& row) { return row.key() == key; });
  }
  void store(const std::string& running) const {
    nlohmann::ordered_json json{{"identity", identity_}, {"seconds", seconds()}, {"running", running}};
    json["rows"] = nlohmann::ordered_json::array();
    for (const Row& row : rows) json["rows"].push_back(toJson(row));
    const std::string text = json.dump() + "\n";
    writeFileDurably(file_, std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
  }
  void finish() const { fs::remove(file_); }

  std::vector<Row> rows;
  bool resumed = false;

 private:
  fs::path file_;
  std::string identity_, running_;
  double seconds_ = 0.0;
  Clock::time_point start_ = Clock::now();
};

class Check {
 public:
  explicit Check(const CheckOptions& options)
      : options_(options), out_(options.input.out), state_(out_, identityOf(options)) {}

  int run() {
    const std::vector<Planned> plan = planOf(options_);
    if (!state_.resumed)
      for (const char* old : {"logs", "pictures", "error"}) fs::remove_all(out_ / old);
    fs::create_directories(out_ / "logs");
    if (state_.resumed && !options_.input.common.quiet) fmt::print("resumes after {} units\n", state_.rows.size());
    for (const Planned& part : plan)
      for (const Unit& unit : part.units) {
        if (state_.has(unit.key())) continue;
        Row row = rowOfUnit(unit, part.until);
        if (interrupted()) {
          state_.store("");
          fmt::print(stderr, "lucerna: interrupted; the same command resumes\n");
          return exitCode();
        }
        if (!options_.input.common.quiet && row.status != Status::notRun)
          fmt::print("{:<8} {:<34} {}\n", nameOf(row.status), row.key(), row.text);
        std::fflush(stdout);
        state_.rows.push_back(std::move(row));
      }
    return write();
  }

 private:
  /// Everything that rows depend on.
  static std::string identityOf(const CheckOptions& options) {
    std::string only;
    for (const std::string& word : options.only) only += " " + word;
    return fmt::format("{}, host {}, {:g} minutes, only{}, {}", programVersion(), options.input.common.requestedHost(),
                       options.minutes, only, options.input.reference);
  }

  Row rowOfUnit(const Unit& unit, double until) {
    Row row;
    row.part = unit.part, row.name = unit.name;
    if (state_.running() == unit.key()) {
      row.status = Status::crashed;
      row.text = "an earlier check, or the machine, ended while this ran";
      return row;
    }
    for (const Row& earlier : state_.rows)
      if ((earlier.key() == unit.after || earlier.part == "context") && isFault(earlier.status) &&
          earlier.status != Status::wrong) {
        row.text = fmt::format("{} {}", earlier.key(), nameOf(earlier.status));
        return row;
      }
    // At most half of the part's rest: the other half is for a second look, or for the units that follow.
    // The context, without which a report is of no use, always has its time.
    const bool isContext = unit.part == "context";
    const double limit = isContext ? unit.seconds : std::min(unit.seconds, 0.5 * (until - state_.seconds()));
    if (limit < (unit.part == "sharing" ? kFair : kLeast)) {
      row.text = "no time left";
      return row;
    }
    state_.store(unit.key());
    const ChildEnd end = start(unit, limit, {});
    row.seconds = end.seconds;
    judge(row, end);
    if (end.timedOut && !end.stuck && limit < std::min(unit.seconds, kFair)) {
      row.status = Status::notRun;  // --minutes ended it, which says nothing about the GPU
      row.text = fmt::format("no time left: stopped after {:.1f} s", end.seconds);
    } else if (end.timedOut && !end.stuck && !isAlive(end, limit) && !(unit.isLarge && isSoftware()))
      lookAgain(unit, until, limit, row);
    state_.store("");
    return row;
  }

  bool isSoftware() const {
    return std::ranges::any_of(state_.rows, [](const Row& row) { return row.figures.value("software", false); });
  }
  /// Whether a child that was killed at its limit had said something lately.
  static bool isAlive(const ChildEnd& end, double limit) { return end.quiet < std::min(10.0, 0.4 * limit); }

  ChildEnd start(const Unit& unit, double limit, std::vector<std::string> environment) {
    const fs::path result = resultOf(unit);
    fs::remove(result);
    std::vector<std::string> words{"check",
                                   "--part",
                                   unit.key(),
                                   "--out",
                                   out_.string(),
                                   "--reference",
                                   options_.input.reference,
                                   "--seconds",
                                   fmt::format("{:.1f}", 0.6 * limit),
                                   "--json",
                                   result.string()};
    if (!options_.input.common.host.empty()) words.insert(words.end(), {"--host", options_.input.common.host});
    if (unit.part == "programs")  // the caches of NVIDIA's driver and of Mesa's
      environment.insert(environment.end(), {"__GL_SHADER_DISK_CACHE=0", "MESA_SHADER_CACHE_DISABLE=true"});
    return runChild(words, environment, logOf(unit), limit);
  }
  fs::path logOf(const Unit& unit) const { return out_ / "logs" / fmt::format("{}-{}.txt", unit.part, unit.name); }
  fs::path resultOf(const Unit& unit) const { return out_ / "logs" / fmt::format("{}-{}.json", unit.part, unit.name); }

  /// Status and text from how a child ended and what it wrote.
  void judge(Row& row, const ChildEnd& end) const {
    const std::string in = end.place.empty() ? "" : ", in: " + end.place;
    if (end.timedOut) {
      row.status = Status::slow;
      row.text = fmt::format("not ended in {:.0f} s{}", end.seconds, in);
      if (!end.stuck) return;
      row.status = Status::hung;
      row.text += "; the driver holds the process even when it is killed";
      return;
    }
    if (end.signal != 0) {
      row.status = Status::crashed;
      row.text = fmt::format("signal {}{}", end.signal, in);
      return;
    }
    const fs::path file = out_ / "logs" / fmt::format("{}-{}.json", row.part, row.name);
    if (fs::exists(file)) {
      const auto json = parseJson<nlohmann::ordered_json>(readFileText(file), file.string());
      row.text = json.at("text").get<std::string>();
      row.figures = json.at("figures");
      if (end.code == (json.at("right").get<bool>() ? 0 : 1)) {
        row.status = json.at("right").get<bool>() ? Status::right : Status::wrong;
        return;
      }
    }
    row.status = end.message.find("reset the GPU") != std::string::npos ? Status::reset : Status::failed;
    row.text = fmt::format("{}{}", end.message.empty() ? fmt::format("exit code {}", end.code) : end.message, in);
  }

  /// Runs a unit that gave no sign of life once more, waiting for the GPU before every pass: names the pass that does
  /// not end.
  void lookAgain(const Unit& unit, double until, double limit, Row& row) {
    row.status = Status::hung;
    const double again = std::min(limit, 0.5 * (until - state_.seconds()));
    if (interrupted() || again < kLeast) return;
    const ChildEnd end = start(unit, again, {"LUCERNA_FINISH_PASSES=1"});
    row.seconds += end.seconds;
    if (end.timedOut && !isAlive(end, again))
      row.text = fmt::format("no end in {:.0f} s, in: {}", end.quiet, end.place);
    else if (end.timedOut || end.seconds > 0.5 * again) row.status = Status::slow;
    else row.text += fmt::format("; ended in {:.1f} s when each pass was waited for", end.seconds);
  }

  int write() {
    Report report;
    report.rows = state_.rows;
    report.seconds = state_.seconds();
    std::vector<std::string> words{"lucerna", "check"};
    if (!options_.only.empty()) {
      words.emplace_back("--only");
      std::string list;
      for (const std::string& word : options_.only) list += (list.empty() ? "" : ",") + word;
      words.push_back(list);
    }
    if (options_.minutes != CheckOptions{}.minutes)
      words.insert(words.end(), {"--minutes", fmt::format("{:g}", options_.minutes)});
    if (const std::string host = options_.input.common.requestedHost(); !host.empty())
      words.insert(words.end(), {"--host", host});
    report.command = bench::shellCommand(words);
    writeFileAtomically(out_ / "check.json", report.json().dump(1) + "\n");
    writeFileAtomically(out_ / "check.txt", report.page());
    state_.finish();
    if (!options_.input.common.quiet)
      fmt::print("\n{}\n{}, {}\n", report.page(), (out_ / "check.txt").string(), (out_ / "check.json").string());
    options_.input.common.writeJson(report.json());
    for (const Row& row : report.rows)
      if (row.part == "context" && isFault(row.status)) return static_cast<int>(ErrorKind::missingCapability);
    return report.faults() == 0 ? 0 : 1;
  }

  static constexpr double kLeast = 1.0;  ///< seconds in which no unit would end
  static constexpr double kFair = 10.0;  ///< seconds after which a unit that has not ended says something

  const CheckOptions& options_;
  fs::path out_;
  State state_;
};

int runCheck(CheckOptions options) {
  options.input.common.apply();
  if (options.input.reference.empty()) options.input.reference = bench::asset("check/reference.json");
  if (!options.writeReference.empty()) {
    checkWritable(options.writeReference);
    writeReference(options.input.common, options.writeReference);
    return 0;
  }
  std::error_code error;
  fs::create_directories(options.input.out, error);
  if (error || !fs::is_directory(options.input.out))
    throwBadInput("--out {}: cannot create folder ({})", options.input.out,
                  error ? error.message() : "a file of that name exists");
  if (!options.unit.empty()) return runChildUnit(options);
  watchForInterrupt();
  return Check(options).run();
}

}  // namespace

void at(const std::string& what) { fmt::print(stderr, "at {}\n", what); }

Session::Session(const UnitInput& input) : host(makeHost(input)) {}

std::unique_ptr<Host> Session::makeHost(const UnitInput& input) {
  at("creating a context");
  return input.common.makeHost(false);
}

}  // namespace check

Work addCheck(Command app) {
  auto options = std::make_shared<check::CheckOptions>();
  options->input.out = "lucerna-check";
  std::vector<std::string> parts;
  for (const check::Part& part : check::kParts) parts.emplace_back(part.name);
  app.addOption("--out", options->input.out, "folder for the report: check.txt, check.json, logs, pictures")
      .showDefault();
  app.addOption("--minutes", options->minutes, "it ends by then; what finds no time is a row \"not run\"")
      .showDefault()
      .range(0.05, 1440.0);
  addCompletions(app.addOption("--only", options->only, "only these parts, or PART/NAME of a report").delimiter(','),
                 parts);
  app.addOption("--reference", options->input.reference,
                "values that pictures are compared with (default: assets/check/reference.json)");
  app.addOption("--write-reference", options->writeReference,
                "instead, render the pictures here and write their values to this file");
  app.addOption(
      "--part", options->unit,
      "PART/NAME: run this unit alone, in this process, for a debugger; exit code 1 if its results are wrong");
  app.addOption("--seconds", options->input.seconds, "with --part: measurements end after this time").showDefault();
  options->input.common.declare(app);
  app.setFooter(
      "Parts, in this order: context (driver and limits), pictures (every technique against stored values), probes "
      "(uses of OpenGL that failed elsewhere), programs (compile times), stages (times at 1280x720 and 1920x1080), "
      "rays "
      "(a second), error (against run time), sharing (four processes at once).\n"
      "Each unit is a process of its own under a time limit: a hang, a crash or a reset is a row of the report. A unit "
      "that hangs is run once more with LUCERNA_FINISH_PASSES=1, to name the pass. Interrupted, the same command "
      "resumes.\n"
      "Exit codes: 0 nothing wrong (slow and not run count as right), 1 something is wrong, hung, crashed or failed, 3 "
      "no OpenGL 4.3, 130 interrupted.");
  return [options] { return check::runCheck(*options); };
}

}  // namespace lucerna::demo
