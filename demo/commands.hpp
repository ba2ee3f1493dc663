// The subcommands of `lucerna`, one file each, and what they share.
#pragma once

#include "gl/context.hpp"
#include "gl/program.hpp"
#include "host/host.hpp"
#include "render/renderer.hpp"
#include "settings/settings.hpp"
#include "command_line.hpp"

#include <nlohmann/json.hpp>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace lucerna::demo {

/// A subcommand: its options are declared on `app`, its work is returned and run after parsing.
Work addWalk(Command app);
Work addRender(Command app);
Work addInfo(Command app);
Work addMedia(Command app);
Work addBench(Command app);
Work addRadiosity(Command app);
Work addCompare(Command app);
Work addTune(Command app);

/// --host, --json, --quiet: every subcommand has them.
struct CommonOptions {
  std::string host;  ///< empty: LUCERNA_HOST, else the default
  std::string json;  ///< empty: none
  bool quiet = false;

  void declare(Command app);
  void apply() const;  ///< checks the host asked for and sets the log level
  std::string askedHost() const;  ///< by the option, else by LUCERNA_HOST; empty: neither
  std::unique_ptr<Host> makeHost(bool wantsWindow, const HostOptions& options = {}) const;
  void writeJson(const nlohmann::ordered_json& json) const;  ///< no effect without --json
};

/// --technique, --component, --fidelity, --deviation, --set, --size: what a picture is made with.
struct PictureOptions {
  std::string technique = "lpv", component = "all", fidelity = "corrected", size = "1280x720";
  std::vector<std::string> deviations, settings;
  std::string settingsFile;  ///< --settings: what it says counts as given before the command line

  void declare(Command app);
  std::optional<std::uint32_t> settingsSpp;  ///< samples a pixel that the settings file asks for, path tracing alone

  /// Reads --settings, if given; options that were given on the command line stay. Call once, before parse().
  void readSettingsFile();
  /// The options as a settings file, which readSettingsFile() takes.
  nlohmann::ordered_json toJson() const;
  /// Throws Error(badInput) naming the option. What the technique does not read is a warning.
  RenderSettings parse() const;
};

/// "640x360" with both from 1 to 16384; throws Error(badInput) naming the option.
glm::ivec2 parseSize(const std::string& text);

/// A camera's name, or px,py,pz,tx,ty,tz,fov: position, target, vertical field of view in degrees; empty: the scene's
/// first.
Camera chooseCamera(const Scene& scene, const std::string& text);

/// Every key of --set with its meaning and default, for --help and README.
std::string settingsHelp();
/// "KEY=VALUE" of --set; a former spelling of the key is a warning. `only`: the settings that cost as much. Throws
/// Error(badInput) with the keys.
SettingAssignment parseSet(const std::string& assignment, const SettingCost* only = nullptr);
inline constexpr SettingCost kSolutionCost =
    SettingCost::solution;  ///< of the settings that a radiosity solution depends on
/// Every deviation with its meaning.
std::string deviationsHelp();

/// A progress bar on a terminal's standard error for work longer than a second; silent elsewhere.
class Progress {
 public:
  Progress(std::string what, int total, bool quiet);
  ~Progress();
  void update(int done);

 private:
  std::string what_;
  int total_;
  bool enabled_, drawn_ = false;
  std::chrono::steady_clock::time_point start_;
};

/// One rule for every command after watchForInterrupt(): on Ctrl-C (SIGINT) and SIGTERM long work ends after what it is
/// doing, keeps its state, writes no final file and ends with exitCode(); the same command goes on from there.
void watchForInterrupt();
bool interrupted();
int exitCode();  ///< 0, or 128 and the signal's number: 130 after Ctrl-C, 143 after SIGTERM

nlohmann::ordered_json stagesJson(const std::vector<gl::StageStatistics>& stages);
/// What the gather of the reflective shadow map saved: pixels a frame.
nlohmann::ordered_json gatherJson(const RsmGather& gather);
std::string gatherLine(const RsmGather& gather);
nlohmann::ordered_json receiversJson(const LpvReceivers& receivers);
std::string receiversLine(const LpvReceivers& receivers);
std::string stagesTable(const std::vector<gl::StageStatistics>& stages, const std::string& renderer);

}  // namespace lucerna::demo
