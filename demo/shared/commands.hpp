// The subcommands of `lucerna`, one file each, and shared declarations.
#pragma once

#include "gl/context.hpp"
#include "gl/program.hpp"
#include "host/host.hpp"
#include "irradiance_cache/irradiance_cache.hpp"
#include "radiosity/solution_watch.hpp"
#include "render/renderer.hpp"
#include "render/settings.hpp"
#include "rsm/rsm_gather.hpp"
#include "shared/command_line.hpp"

#include <nlohmann/json.hpp>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace lucerna::demo {

/// A subcommand: declares its options on `app` and returns its work, which runs after parsing.
Work addWalk(Command app);
Work addRender(Command app);
Work addInfo(Command app);
Work addMedia(Command app);
Work addRadiosity(Command app);
Work addCompare(Command app);

/// Why a picture is black.
constexpr const char* kNoLightSeen = "no light reaches what this view shows; --camera chooses another";

/// --host, --json, --quiet: every subcommand has them.
struct CommonOptions {
  std::string host;  ///< empty: LUCERNA_HOST, else the default
  std::string json;  ///< empty: none
  bool quiet = false;
  bool checkBarriers = false;  ///< gl/barrier_ledger.hpp

  void declare(Command app);
  void apply() const;  ///< checks the requested host and sets the log level
  std::string requestedHost() const;  ///< from the option, else from LUCERNA_HOST; empty: neither
  std::unique_ptr<Host> makeHost(bool wantsWindow, const HostOptions& options = {}) const;
  void writeJson(const nlohmann::ordered_json& json) const;  ///< no effect without --json
};

/// --technique, --component, --fidelity, --deviation, --set, --size: the options of a picture.
struct PictureOptions {
  static constexpr int kPixelSamples = 16;
  int usualSamples = kPixelSamples;  ///< of a pixel, without --pixel-samples; commands that time frames set 1

  /// technique: empty until readSettingsFile(), unless it is given.
  std::string technique, component = "all", fidelity = "corrected", size = "1280x720";
  std::vector<std::string> deviations, settings;
  std::optional<int> pixelSamples;  ///< --pixel-samples and --filter: settings of their own
  std::string filter;
  std::string settingsFile;  ///< --settings: its content counts as given before the command line

  void declare(Command app);
  std::optional<std::uint32_t> settingsSpp;  ///< samples per pixel from the settings file; path tracing only

  /// Reads --settings, if given; options from the command line take precedence. Then sets the technique if none is
  /// given. Call once, before parse().
  void readSettingsFile();
  /// The options as a settings file, which readSettingsFile() takes.
  nlohmann::ordered_json toJson() const;
  /// Throws Error(badInput) naming the option. Options that the technique does not read cause a warning.
  RenderSettings parse() const;

 private:
  void addSettingsFile();
  /// That of --fidelity, of the first deviation, or of the first setting that one technique alone reads.
  std::string impliedTechnique() const;
};

/// A scene file at a time, seen by a camera.
struct SceneAt {
  std::string file;
  double time = 0.0;  ///< --time, seconds
  std::string camera;  ///< --camera
  bool noFloor = false;  ///< --no-floor

  void declare(Command app);
  /// The scene, in its studio if it has no light of its own (scene/studio.hpp), and the chosen camera.
  std::pair<Scene, Camera> load() const;
};

/// "640x360" with both from 1 to 16384; throws Error(badInput) naming the option.
glm::ivec2 parseSize(const std::string& text);

/// A camera's name, or px,py,pz,tx,ty,tz,fov: position, target, vertical field of view in degrees; empty: the scene's
/// first camera.
Camera chooseCamera(const Scene& scene, const std::string& text);

/// Every key of --set with its meaning and default, for --help and README.
std::string settingsHelp();
/// Parses "KEY=VALUE" of --set. `only`: accept only settings of that cost. Throws Error(badInput) listing the keys.
SettingAssignment parseSet(const std::string& assignment, const SettingCost* only = nullptr);
inline constexpr SettingCost kSolutionCost =
    SettingCost::solution;  ///< for the settings that a radiosity solution depends on
/// Every deviation with its meaning.
std::string deviationsHelp();

/// On a terminal a progress bar on standard error for work longer than a second; elsewhere a line every 30 seconds.
class Progress {
 public:
  Progress(std::string what, int total, bool quiet);
  ~Progress();
  void update(int done);
  /// Of other work than before: the time that is left is counted anew.
  void update(const std::string& what, double share);

 private:
  std::string what_;
  int total_;
  bool enabled_, isTerminal_, drawn_ = false;
  std::chrono::steady_clock::time_point start_, line_;
};

/// How far a solution is: what comes before the hemicubes, then those.
void showProgress(Progress& progress, const RadiosityStage& stage);

/// Applies to every command after watchForInterrupt(): on Ctrl-C (SIGINT) and SIGTERM, long work finishes its current
/// step, keeps its state, writes no final file and ends with exitCode(). The same command continues from there.
void watchForInterrupt();
bool interrupted();
/// The signals end the program at once from here on: for work that keeps no state. Throws Stopped if one has come.
void endAtInterrupt();
/// For the lifetime of the result, solutions of the technique radiosity stop at an interruption, or if `goOn` is false;
/// they keep their form factors in the folder of cached references, from which the same command goes on. keepsRows: for
/// a window; until the end of that lifetime, so that other light needs no hemicubes, and `goOn` is called often.
std::unique_ptr<SolutionWatch> watchSolutions(std::function<bool(const RadiosityStage&)> goOn = {},
                                              bool keepsRows = false);
int exitCode();  ///< 0, or 128 + the signal's number: 130 after Ctrl-C, 143 after SIGTERM

nlohmann::ordered_json stagesJson(const std::vector<gl::StageStatistics>& stages);
/// The savings of the reflective shadow map's gather, in pixels per frame.
nlohmann::ordered_json gatherJson(const RsmGather& gather);
nlohmann::ordered_json cacheJson(const IrradianceCache& cache);
std::string stagesTable(const std::vector<gl::StageStatistics>& stages, const std::string& renderer);

}  // namespace lucerna::demo
