#include "base/error.hpp"
#include "base/files.hpp"
#include "base/log.hpp"
#include "measure/reference.hpp"
#include "scene/motion.hpp"
#include "scene/scene_file.hpp"
#include "scene/studio.hpp"
#include "render/techniques.hpp"
#include "shared/commands.hpp"
#include "shared/completions.hpp"
#include "render/deviations.hpp"
#include "shared/settings_file.hpp"

#include <fmt/ranges.h>

#include <charconv>
#include <cmath>
#include <sstream>

namespace lucerna::demo {

namespace {
constexpr double kSecondsBetweenFrames = 0.04;  // of hemicubes, where a window draws in between
}

std::unique_ptr<SolutionWatch> watchSolutions(std::function<bool(const RadiosityStage&)> goOn, bool keepsRows) {
  std::filesystem::path folder = measure::ReferenceCache::defaultFolder();
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) folder.clear();  // nothing is kept
  return std::make_unique<SolutionWatch>(
      folder,
      [goOn = std::move(goOn)](const RadiosityStage& stage) { return !interrupted() && (!goOn || goOn(stage)); },
      keepsRows ? SolutionWatch::Rows::keep : SolutionWatch::Rows::resume,
      SolutionWatch::Limits{.secondsOfChunk =
                                keepsRows ? kSecondsBetweenFrames : SolutionWatch::Limits().secondsOfChunk});
}

void showProgress(Progress& progress, const RadiosityStage& stage) {
  if (*stage.prepares.what) progress.update(stage.prepares.what, std::max(stage.prepares.share, 0.0));
  else if (stage.total > 0)
    progress.update("hemicubes", static_cast<double>(stage.done) / static_cast<double>(stage.total));
}

// ---------------------------------------------------------------------------------------------------- options

namespace {

template <class T>
T parseNumber(const std::string& option, const std::string& text, T lowest, T highest) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !(value >= lowest && value <= highest))
    throwBadInput("{}: '{}' is not a number from {} to {}", option, text, lowest, highest);
  return value;
}

}  // namespace

std::string settingsHelp() {
  std::string text =
      "Settings (--set KEY=VALUE; one that the technique does not read is a warning; lucerna info --settings says "
      "more):\n";
  for (const Setting& setting : allSettings())
    text += fmt::format("  {:<22} {}{}; {} (default {})\n", setting.key,
                        setting.unit.empty() ? "" : std::string(setting.unit) + ": ", setting.meaning,
                        allowedValues(setting), defaultValue(setting));
  return text;
}

std::vector<std::string> settingCompletions(const SettingCost* only) {
  std::vector<std::string> words;
  for (const Setting& setting : allSettings()) {
    if (only && setting.cost != *only) continue;
    const std::string key = std::string(setting.key) + "=";
    std::vector<std::string_view> values = setting.value.choices;
    if (setting.value.type == SettingType::boolean) values = {"on", "off"};
    if (values.empty()) words.push_back(key);
    for (const std::string_view value : values) words.push_back(key + std::string(value));
  }
  return words;
}

SettingAssignment parseSet(const std::string& assignment, const SettingCost* only) {
  return parseAssignment(assignment, "--set ", only);
}

std::string deviationsHelp() {
  std::string text =
      "\nDeviations (--deviation NAME=on|off; * are on with --fidelity original, which is thesis; + with demo):\n";
  for (const Deviation& deviation : allDeviations())
    text += fmt::format("{}{} {:<24} {}\n", deviation.inOriginal() ? '*' : ' ', deviation.inDemo() ? '+' : ' ',
                        deviation.name, deviation.meaning);
  return text;
}

void PictureOptions::declare(Command app) {
  const auto addNames = [](Option option, const auto& names) {
    addCompletions(option, std::vector<std::string>(names.begin(), names.end()));
  };
  addNames(app.addOption("--technique", technique,
                         fmt::format("{}; without it the one that alone reads a setting or deviation given, else {}",
                                     fmt::join(techniqueNames(), ", "), kDefaultTechnique)),
           techniqueNames());
  addNames(app.addOption("--component", component, "all, direct or indirect").showDefault(), namesOf(Component{}));
  addNames(
      app.addOption("--fidelity", fidelity,
                    "corrected; original: as published; lpv: thesis (original) or demo, the program published with it")
          .showDefault(),
      namesOf(Fidelity{}));
  std::vector<std::string> switches;
  for (const Deviation& deviation : allDeviations())
    for (const char* state : {"=on", "=off"}) switches.push_back(deviation.name + std::string(state));
  addCompletions(
      app.addOption("--deviation", deviations, "NAME=on|off: one deviation of the published original; may be repeated"),
      switches);
  app.addOption("--size", size,
                "WIDTHxHEIGHT in pixels; path without it: 1920x1080 for the JSON of the VPT original and for "
                "--fidelity original")
      .showDefault();
  app.addOption("--pixel-samples", pixelSamples,
                "points of each pixel that are drawn, for smooth edges (16); path: its own --spp")
      .range(1, 1024);
  addNames(app.addOption("--filter", filter, "pixel filter: box, gaussian, blackman-harris, or centre: none (box)"),
           namesOf(PixelFilter{}));
  addCompletions(app.addOption("--set", settings, "KEY=VALUE, see below; may be repeated"), settingCompletions());
  app.addOption("--settings", settingsFile,
                "a settings file, as written by `lucerna tune`; other options here override it");
  app.setFooter(settingsHelp() + deviationsHelp());
}

void SceneAt::declare(Command app) {
  app.addOption("--time", time, "seconds at which a scene that moves is shown").range(-1e12, 1e12).showDefault();
  app.addFlag("--no-floor", noFloor, "models without light of their own: not on our grey floor");
}

std::pair<Scene, Camera> SceneAt::load() const {
  std::pair<Scene, Camera> loaded{loadScene(file, time), {}};
  auto& [scene, view] = loaded;
  view = chooseCamera(scene, camera);
  setDefaultExposure(scene, view);
  if (!noFloor && scene.studio) addFloor(scene);
  return loaded;
}

void PictureOptions::readSettingsFile() {
  if (!settingsFile.empty()) addSettingsFile();
  if (pixelSamples && technique == "path")
    logWarning("--pixel-samples {}: technique path does not read it; its samples are --spp", *pixelSamples);
  else if (pixelSamples) settings.push_back(fmt::format("picture.samples={}", *pixelSamples));
  if (!filter.empty())
    settings.push_back(fmt::format("picture.filter={}", nameOf(parseName<PixelFilter>(filter, "--filter"))));
  if (technique.empty()) technique = impliedTechnique();
  if (settingsSpp && technique != "path")
    throwBadInput("--settings {}: key \"spp\": samples per pixel belong to technique path, not to {}", settingsFile,
                  technique);
}

std::string PictureOptions::impliedTechnique() const {
  const auto implied = [&](const std::string& option, std::string_view name) {
    if (name != kDefaultTechnique) logInfo("{}: using technique {}, the only one that reads it", option, name);
    return std::string(name);
  };
  if (fidelity != "corrected") {
    logInfo("--fidelity {}: using technique lpv, as --technique names no other", fidelity);
    return "lpv";
  }
  for (const Deviation& deviation : allDeviations())
    if (!deviations.empty() && deviations.front().starts_with(std::string(deviation.name) + "="))
      return implied(deviations.front(), std::string_view(deviation.name).substr(0, deviations.front().find('.')));
  for (const std::string& assignment : settings)
    if (const auto only = onlyTechnique(*parseSet(assignment).setting)) return implied(assignment, *only);
  return std::string(kDefaultTechnique);
}

void PictureOptions::addSettingsFile() {
  const PictureOptions usual;
  const SettingsFile file = demo::readSettingsFile(settingsFile);
  if (file.technique && technique.empty()) technique = *file.technique;
  if (file.fidelity && fidelity == usual.fidelity) fidelity = *file.fidelity;
  deviations.insert(deviations.begin(), file.deviations.begin(), file.deviations.end());
  settings.insert(settings.begin(), file.settings.begin(), file.settings.end());
  settingsSpp = file.spp;
}

nlohmann::ordered_json PictureOptions::toJson() const {
  return {{"technique", technique}, {"fidelity", fidelity}, {"deviations", deviations}, {"settings", settings}};
}

RenderSettings PictureOptions::parse() const {
  RenderSettings result;
  result.pixelSamples = usualSamples;
  result.technique = techniqueNamed(technique.empty() ? impliedTechnique() : technique, "--technique").name;
  result.component = parseName<Component>(component, "--component");
  applyFidelity(result, parseName<Fidelity>(fidelity, "--fidelity"));
  for (const std::string& deviation : deviations) applyDeviation(result, deviation);
  result.size = parseSize(size);
  applySettings(result, settings, "--set ");
  return result;
}

glm::ivec2 parseSize(const std::string& text) {
  const auto cross = text.find('x');
  if (cross == std::string::npos) throwBadInput("--size {}: expected WIDTHxHEIGHT, such as 640x360", text);
  return {parseNumber("--size", text.substr(0, cross), 1, 16384),
          parseNumber("--size", text.substr(cross + 1), 1, 16384)};
}

Camera chooseCamera(const Scene& scene, const std::string& text) {
  if (text.empty()) return scene.cameras.front();
  for (const Camera& camera : scene.cameras)
    if (camera.name == text) return camera;
  std::vector<double> numbers;
  std::istringstream stream(text);
  std::string part;
  while (std::getline(stream, part, ',')) {
    std::size_t used = 0;
    double value = NAN;
    try {
      value = std::stod(part, &used);
    } catch (const std::exception&) {}
    if (used == 0 || used != part.size() || !std::isfinite(value)) numbers.clear();
    if (used == 0 || used != part.size() || !std::isfinite(value)) break;
    numbers.push_back(value);
  }
  if (numbers.size() != 7) {
    std::string known;
    for (const Camera& camera : scene.cameras)
      known += (known.empty() ? "" : ", ") + (camera.name.empty() ? "default" : camera.name);
    throwBadInput("--camera {}: neither a camera of the scene ({}) nor px,py,pz,tx,ty,tz,fov", text, known);
  }
  Camera camera;
  camera.position = glm::dvec3(numbers[0], numbers[1], numbers[2]) - scene.origin;
  const glm::dvec3 view = glm::dvec3(numbers[3] - numbers[0], numbers[4] - numbers[1], numbers[5] - numbers[2]);
  if (glm::length(view) == 0.0) throwBadInput("--camera {}: the target is the position", text);
  if (!(numbers[6] > 0.0 && numbers[6] < 180.0))
    throwBadInput("--camera {}: the field of view is in degrees, above 0 and below 180", text);
  camera.direction = glm::normalize(view);
  camera.up = std::abs(camera.direction.y) < 0.999 ? glm::dvec3(0.0, 1.0, 0.0) : glm::dvec3(0.0, 0.0, -1.0);
  camera.verticalFov = glm::radians(numbers[6]);
  return camera;
}

// ---------------------------------------------------------------------------------------------------- stage times

nlohmann::ordered_json stagesJson(const std::vector<gl::StageStatistics>& stages) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  for (const auto& s : stages) {
    json[s.name] = {
        {"median_ms", s.medianMs},      {"p95_ms", s.p95Ms}, {"count", s.count},   {"query_median_ms", s.queryMedianMs},
        {"queries_refused", s.refused}, {"ran", s.ran},      {"frames", s.frames}, {"saved_ms", s.savedMs()}};
    if (!std::isnan(s.wallMedianMs)) json[s.name]["wall_median_ms"] = s.wallMedianMs;
  }
  return json;
}

nlohmann::ordered_json gatherJson(const RsmGather& gather) {
  const RsmGather::Counts& c = gather.counts();
  return {{"refused", c.perFrame(c.refused)},
          {"pixels", c.perFrame(c.pixels)},
          {"gathered", c.perFrame(c.gathered)},
          {"saving", c.saving()},
          {"frames", c.frames}};
}

nlohmann::ordered_json cacheJson(const IrradianceCache& cache) {
  const IrradianceCache::Counts& c = cache.counts();
  return {{"records", c.records},
          {"waiting", c.waiting},
          {"without_room", c.left},
          {"paths_of_each", cache.settings().samples}};
}

std::string stagesTable(const std::vector<gl::StageStatistics>& stages, const std::string& renderer) {
  std::string text = fmt::format("Stage times on {}\n{:<18}{:>12}{:>12}{:>8}{:>16}{:>16}{:>14}\n", renderer, "stage",
                                 "median ms", "95 % ms", "count", "query median ms", "ran in frames", "saved ms");
  const auto time = [](double ms) { return std::isnan(ms) ? std::string("-") : fmt::format("{:.3f}", ms); };
  double total = 0.0, saved = 0.0;
  std::string refused;
  for (const auto& s : stages) {
    text += fmt::format("{:<18}{:>12}{:>12}{:>8}{:>16}{:>16}{:>14.3f}\n", s.name, time(s.medianMs), time(s.p95Ms),
                        s.count, time(s.queryMedianMs), fmt::format("{} of {}", s.ran, s.frames), s.savedMs());
    total += std::isnan(s.medianMs) ? 0.0 : s.medianMs - s.savedMs();
    saved += s.savedMs();
    if (s.refused > 0) refused += fmt::format("{}{} ({})", refused.empty() ? "" : ", ", s.name, s.refused);
  }
  text += fmt::format("{:<18}{:>12.3f}{:>66.3f}\n", "a frame", total, saved);
  if (!refused.empty())
    text += "Queries refused, since the driver's time exceeds the wall clock or never came: " + refused + "\n";
  return text;
}

}  // namespace lucerna::demo
