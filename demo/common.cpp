#include "base/error.hpp"
#include "base/files.hpp"
#include "base/log.hpp"
#include "commands.hpp"
#include "offers.hpp"
#include "render/deviations.hpp"
#include "settings_file.hpp"

#include <fmt/core.h>

#include <charconv>
#include <chrono>
#include <cmath>
#include <csignal>
#include <ctime>
#include <sstream>
#include <unistd.h>

namespace lucerna::demo {

// ---------------------------------------------------------------------------------------------------- options

void CommonOptions::declare(CLI::App& app) {
  offer(app.add_option("--host", host, "who makes the OpenGL context: window, egl or osmesa (default: LUCERNA_HOST, else see README)"),
        {"window", "egl", "osmesa"});
  app.add_option("--json", json, "write machine-readable results to this file");
  app.add_flag("--quiet", quiet, "no warnings, no progress");
}

std::string CommonOptions::askedHost() const {
  const char* environment = std::getenv("LUCERNA_HOST");
  return !host.empty() ? host : environment ? environment : "";
}

void CommonOptions::apply() const {
  if (const std::string asked = askedHost(); !asked.empty()) parseHostKind(asked);
  if (quiet) setLogLevel(LogLevel::quiet);
  if (const char* verbose = std::getenv("LUCERNA_VERBOSE"); verbose && *verbose) setLogLevel(LogLevel::verbose);
}

std::unique_ptr<Host> CommonOptions::makeHost(bool wantsWindow, const HostOptions& options) const {
  const std::string asked = askedHost();
  return asked.empty() ? Host::createDefault(wantsWindow, options) : Host::create(parseHostKind(asked), options);
}

void CommonOptions::writeJson(const nlohmann::ordered_json& value) const {
  if (!json.empty()) writeFileAtomically(json, value.dump(2) + "\n");
}

namespace {

template <class T>
T parseNumber(const std::string& option, const std::string& text, T lowest, T highest) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !(value >= lowest && value <= highest))
    throwBadInput("{}: '{}' is not a number from {} to {}", option, text, lowest, highest);
  return value;
}

bool parseSwitch(const std::string& option, const std::string& text) {
  if (text == "on" || text == "true" || text == "1") return true;
  if (text == "off" || text == "false" || text == "0") return false;
  throwBadInput("{}: '{}' is neither on nor off", option, text);
}

int parsePowerOfTwo(const std::string& option, const std::string& text, int most) {
  const int value = parseNumber(option, text, 1, most);
  if ((value & (value - 1)) != 0) throwBadInput("{}: {} is no power of two", option, value);
  return value;
}

/// Whether there is a geometry volume, and from whose surfels.
bool parseBlocking(const std::string& option, const std::string& text, LpvSurfels& surfels) {
  surfels = text == "camera" ? LpvSurfels::camera : text == "both" ? LpvSurfels::both : LpvSurfels::rsm;
  if (text == "rsm" || surfels != LpvSurfels::rsm) return true;
  if (text == "on" || text == "off") return text == "on";
  throwBadInput("{}: '{}' is none of rsm (or on), camera, both, off", option, text);
}

template <class T>
T parseChoice(const std::string& option, const std::string& text, std::initializer_list<T> choices) {
  std::string known;
  for (T choice : choices) {
    if (text == nameOf(choice)) return choice;
    known += (known.empty() ? "" : ", ") + std::string(nameOf(choice));
  }
  throwBadInput("{}: '{}' is none of {}", option, text, known);
}

/// Radiosity's settings begin with "rad.", as its deviations do; the technique's whole name is understood too.
std::pair<std::string, std::string> splitAssignment(const std::string& option, std::string text) {
  if (text.starts_with("radiosity.")) text.replace(0, 9, "rad");
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals == 0) throwBadInput("{} {}: expected key=value", option, text);
  return {text.substr(0, equals), text.substr(equals + 1)};
}

/// One key of --set. `apply` throws naming the key when the value is wrong.
struct Setting {
  const char* key;
  const char* meaning;
  void (*apply)(RenderSettings&, std::optional<float>& exposure, const std::string& key, const std::string& value);
};

#define SETTING(key, meaning, statement)                                                                          \
  Setting {                                                                                                       \
    key, meaning, [](RenderSettings& s, std::optional<float>& exposure, const std::string& k, const std::string& v) { \
      (void)s, (void)exposure, (void)k;                                                                                  \
      statement;                                                                                                  \
    }                                                                                                             \
  }

const Setting kSettings[] = {
    SETTING("lpv.cells", "cells a side of every cascade (32)", s.lpv.cascades.cells = parseNumber(k, v, 1, 128)),
    SETTING("lpv.cascades", "nested grids (3)", s.lpv.cascades.cascades = parseNumber(k, v, 1, LPV_MAX_CASCADES)),
    SETTING("lpv.transport", "how light gets to what is looked up: propagate, through the grids' cells; to points of surfaces: gather, from the lights' maps; rays, along paths (rays, unless a setting or deviation is given that another alone reads)",
            s.lpv.transport = parseChoice(k, v, {LpvTransport::propagate, LpvTransport::gather, LpvTransport::rays})),
    SETTING("lpv.visibility", "of gathered light: voxels or none (voxels)", s.lpv.visibility = parseChoice(k, v, {LpvVisibility::voxels, LpvVisibility::none})),
    SETTING("lpv.voxels", "of gathered light: voxels along the longest side of the scene (256)", s.lpv.voxels = parseNumber(k, v, 1, 1024)),
    SETTING("lpv.lookup", "irradiance from propagated light: flux, as the kernel sends it; published, 1.91 times as much (flux)",
            s.lpv.lookup = parseChoice(k, v, {LpvLookup::flux, LpvLookup::published})),
    SETTING("lpv.rays", "with transport rays: paths of a receiver and frame, 1, 2, 4, ... 64 (16)", s.lpv.rays = parsePowerOfTwo(k, v, 64)),
    SETTING("lpv.least-rays", "with transport rays: paths of a receiver in its first frame, at least (64)", s.lpv.leastRays = parseNumber(k, v, 1, 1 << 20)),
    SETTING("lpv.samples", "with transport rays: paths of a receiver while light and geometry stand still (512)", s.lpv.samples = parseNumber(k, v, 1, 1 << 24)),
    SETTING("lpv.most-change", "of receivers: largest relative change of what is shown in a frame, 0 for any (0.004)", s.lpv.mostChange = static_cast<float>(parseNumber(k, v, 0.0, 1.0))),
    SETTING("lpv.iterations", "propagation steps (8)", s.lpv.iterations = parseNumber(k, v, 0, 100000)),
    SETTING("lpv.cell-size", "cell size of the coarsest cascade in scene units (0: half the cells span the scene)",
            s.lpv.cascades.cellSize = parseNumber(k, v, 0.0, 1e12)),
    SETTING("lpv.ratio", "cell size over that of the next finer cascade (2)", s.lpv.cascades.ratio = parseNumber(k, v, 1.0, 16.0)),
    SETTING("lpv.push", "how far grids lie ahead of the camera, in half extents (0.8)", s.lpv.cascades.push = parseNumber(k, v, 0.0, 1.0)),
    SETTING("lpv.fill", "how the grid is filled: layered, atomic or fixed (layered)",
            s.lpv.fill = parseChoice(k, v, {LpvFill::layered, LpvFill::atomic, LpvFill::fixed})),
    SETTING("lpv.propagate", "compute; layered: one pass a step and cascade, a point a cell, as published; slices: the same, a triangle a slice (compute)",
            s.lpv.propagate = parseChoice(k, v, {LpvPropagate::compute, LpvPropagate::layered, LpvPropagate::slices})),
    SETTING("lpv.amplifier", "factor of the deviating 4 pi kernel; 4 conserves (1)", s.lpv.amplifier = parseNumber(k, v, 0.0f, 100.0f)),
    SETTING("lpv.blocking", "geometry volume from rsm (or on), camera, both, or off (rsm)",
            s.lpv.blocking = parseBlocking(k, v, s.lpv.surfels)),
    SETTING("lpv.bounces", "times that light is reflected, with transport rays also all (all with rays, else 1)",
            s.lpv.bounces = v == "all" ? LightPropagationVolume::kAllBounces : parseNumber(k, v, 1, 64)),
    SETTING("lpv.blend", "fraction of a cascade over which it fades into the next (0.25)",
            s.lpv.blendBand = parseNumber(k, v, 0.001f, 1.0f)),
    SETTING("lpv.hand-over", "steps after which finer cascades take a coarser one's light (0: from iterations and ratio)",
            s.lpv.handOver = parseNumber(k, v, 0, 100000)),
    SETTING("lpv.lookup-offset", "cells along the normal that a point is moved before the lookup (0; 0.5 with lookup published)",
            s.lpv.lookupOffset = parseNumber(k, v, 0.0f, 4.0f)),
    SETTING("rsm.size", "texels a side of the reflective shadow map (256)", s.rsm.size = parseNumber(k, v, 1, 8192)),
    SETTING("rsm.samples", "samples of the map a gathered point (400)", s.gather.samples = parseNumber(k, v, 1, 65536)),
    SETTING("rsm.radius", "reach of the gather, fraction of the map's side (0.3)", s.gather.radius = parseNumber(k, v, 1e-4f, 2.0f)),
    SETTING("rsm.weight", "unbiased or published: xi or xi^2 (unbiased)",
            s.gather.weight = parseChoice(k, v, {RsmGather::Weight::unbiased, RsmGather::Weight::published})),
    SETTING("rsm.rotation", "none or noise: the sample pattern turned from pixel to pixel (none)",
            s.gather.rotation = parseChoice(k, v, {RsmGather::Rotation::none, RsmGather::Rotation::noise})),
    SETTING("rsm.near", "beside a texel's surface: quad, disc, clamp or none (quad)",
            s.gather.nearField = parseChoice(k, v, {RsmGather::Near::quad, RsmGather::Near::disc, RsmGather::Near::clamp, RsmGather::Near::none})),
    SETTING("rsm.clamp", "least distance with rsm.near=clamp, in texels (1)", s.gather.clampTexels = parseNumber(k, v, 0.0f, 1000.0f)),
    SETTING("rsm.interpolate", "gather few pixels, interpolate the others where they fit (on)", s.gather.interpolate = parseSwitch(k, v)),
    SETTING("rsm.low-resolution", "pixels between gathered ones each way (4)", s.gather.lowResolution = parseNumber(k, v, 1, 64)),
    SETTING("rsm.fit-normal", "least cosine between normals that fit (0.9)", s.gather.fitNormal = parseNumber(k, v, -1.0f, 1.0f)),
    SETTING("rsm.fit-plane", "most distance off the tangent plane, in low-resolution steps (0.25)",
            s.gather.fitPlane = parseNumber(k, v, 0.0f, 1e6f)),
    SETTING("rsm.fit-distance", "most distance, in low-resolution steps (8)", s.gather.fitDistance = parseNumber(k, v, 0.0f, 1e6f)),
    SETTING("rsm.show-refused", "paint the pixels that interpolation refused red (off)", s.gather.showRefused = parseSwitch(k, v)),
    SETTING("rad.edge", "longest edge of a patch in scene units (0: a 12th of the scene)", s.radiosity.solution.patches.longestEdge = parseNumber(k, v, 0.0, 1e12)),
    SETTING("rad.resolution", "pixels a side of a hemicube, even (64)", s.radiosity.solution.hemicubes.resolution = 2 * (parseNumber(k, v, 2, 4096) / 2)),
    SETTING("rad.visibility", "what tells hemicubes' pixels what they see: auto (measured at start), raster, rays or item-buffer (auto)",
            s.radiosity.solution.hemicubes.visibility = parseHemicubeVisibility(v)),
    SETTING("rad.error", "guaranteed relative error of the solution (0.001)", s.radiosity.solution.error = parseNumber(k, v, 1e-12, 10.0)),
    SETTING("rad.solver", "auto, jacobi, gauss-seidel, progressive, overshoot, anderson, per-room or cg (auto)",
            s.radiosity.solution.solver = parseRadiositySolver(v)),
    SETTING("rad.refinements", "times that patches are halved where light changes steeply (0)", s.radiosity.solution.refinements = parseNumber(k, v, 0, 8)),
    SETTING("rad.products", "products with the form factors, at most (100000)", s.radiosity.solution.mostProducts = parseNumber(k, v, 1, 100000000)),
    SETTING("rad.seed", "of the hemicubes' random roll (1)", s.radiosity.solution.hemicubes.seed = static_cast<std::uint32_t>(parseNumber(k, v, 0, 2147483647))),
    SETTING("rad.exact-pixels", "pixels from which a patch takes its closed form factor; 0: none does (12)",
            s.radiosity.solution.hemicubes.exactPixels = parseNumber(k, v, 0, 1 << 24)),
    SETTING("rad.near", "receivers are divided until others are so many part sizes away; 0: never (3)",
            s.radiosity.solution.hemicubes.nearDistance = parseNumber(k, v, 0.0f, 1e6f)),
    SETTING("rad.parts", "parts a side of a receiver, at most (8)", s.radiosity.solution.hemicubes.mostParts = parseNumber(k, v, 1, 64)),
    SETTING("rad.steep", "step from patch to patch that is refined, in parts of the mean (0.1)", s.radiosity.solution.steep = parseNumber(k, v, 1e-6, 1e6)),
    SETTING("rad.memory", "MiB for form factors; more are computed anew (0: half of what is free)",
            s.radiosity.solution.memoryBytes = static_cast<std::size_t>(parseNumber(k, v, 0, 1 << 30)) << 20),
    SETTING("rad.batch", "MiB of GPU memory that the hemicubes of one submission take (0: what suits the renderer)",
            s.radiosity.solution.hemicubes.batchBytes = static_cast<std::size_t>(parseNumber(k, v, 0.0, 1e6) * 1048576.0)),
    SETTING("rad.repair", "reciprocity and row sums put right (on)", s.radiosity.solution.repair = parseSwitch(k, v)),
    SETTING("rad.file", "a solution: loaded where there is one, else saved there", s.radiosity.file = v),
    SETTING("rad.mapping", "tone, linear, log or false-colours (tone)",
            s.radiosity.mapping = parseChoice(k, v, {RadiosityView::Mapping::tone, RadiosityView::Mapping::linear, RadiosityView::Mapping::logarithmic,
                                                     RadiosityView::Mapping::falseColours})),
    SETTING("rad.decades", "powers of ten that log and false-colours span (4)", s.radiosity.decades = parseNumber(k, v, 0.1f, 30.0f)),
    SETTING("rad.mesh", "patch edges drawn over (off)", s.radiosity.mesh = parseSwitch(k, v)),
    SETTING("rad.direct", "direct light: pixels, by shadow rays in each; patches, a value each; auto: pixels in render, patches elsewhere (auto)",
            s.radiosity.direct = parseChoice(k, v, {RadiosityView::Direct::automatic, RadiosityView::Direct::patches, RadiosityView::Direct::pixels})),
    SETTING("rad.shadow-rays", "shadow rays a pixel with rad.direct=pixels, divided among the emissive triangles (32)",
            s.radiosity.shadowRays = parseNumber(k, v, 1, 4096)),
    SETTING("rad.flat", "patches not interpolated (off)", s.radiosity.flat = parseSwitch(k, v)),
    SETTING("shadow.size", "texels a side of the shadow map (2048)", s.shadow.size = parseNumber(k, v, 1, 16384)),
    SETTING("shadow.cascades", "shadow maps of the sun along the view, 1: one for the whole scene (1)",
            s.sunCascades.cascades = parseNumber(k, v, 1, SUN_MAX_CASCADES)),
    SETTING("shadow.split", "how cascades divide the view's depth, 0 uniformly to 1 logarithmically (0.9)",
            s.sunCascades.split = parseNumber(k, v, 0.0, 1.0)),
    SETTING("shadow.spot-size", "texels a side of a spot light's shadow map (1024)", s.lights.spotSize = parseNumber(k, v, 1, 16384)),
    SETTING("shadow.point-size", "texels a side of each face of an omnidirectional light's shadow map (512)",
            s.lights.pointSize = parseNumber(k, v, 1, 16384)),
    SETTING("texture.anisotropy", "anisotropic filtering, at most (4)", s.textures.anisotropy = parseNumber(k, v, 1.0f, 16.0f)),
    SETTING("frame.reuse", "what has not changed since the frame before is not made again: maps, volume, receivers (on)", s.reuse = parseSwitch(k, v)),
    SETTING("exposure", "multiplies radiance before tone mapping (the scene's)", exposure = parseNumber(k, v, 1e-12f, 1e12f)),
};

#undef SETTING

/// What each technique reads, by the beginning of the key.
bool isRead(const std::string& technique, std::string_view key) {
  const auto reads = [&](std::initializer_list<std::string_view> beginnings) {
    return std::any_of(beginnings.begin(), beginnings.end(), [&](std::string_view beginning) { return key.starts_with(beginning); });
  };
  if (key == "exposure" || key == "frame.reuse") return true;
  if (technique == "direct") return reads({"shadow.", "texture."});
  if (technique == "lpv") return reads({"lpv.", "rsm.size", "shadow.", "texture."});
  if (technique == "rsm") return reads({"rsm.", "shadow.", "texture."});
  if (technique == "radiosity") return reads({"rad.", "shadow.", "texture."});
  return false;  // path: its own options
}

/// What concerns the picture of a solution, not the solution.
constexpr std::string_view kViewOfSolution[] = {"rad.file", "rad.mapping", "rad.decades", "rad.mesh", "rad.flat", "rad.direct", "rad.shadow-rays"};

bool isOfSolution(const Setting& setting) {
  const std::string_view name = setting.key;
  return name.starts_with("rad.") && std::find(std::begin(kViewOfSolution), std::end(kViewOfSolution), name) == std::end(kViewOfSolution);
}

}  // namespace

namespace {

/// Throws Error(badInput) with the keys that there are, where `key` is none of those that `known` says.
template <class Known>
const Setting& findSetting(const std::string& assignment, const std::string& key, Known known) {
  const auto* found = std::find_if(std::begin(kSettings), std::end(kSettings), [&](const Setting& s) { return s.key == key && known(s); });
  if (found != std::end(kSettings)) return *found;
  std::string keys;
  for (const Setting& setting : kSettings)
    if (known(setting)) keys += (keys.empty() ? "" : ", ") + std::string(setting.key);
  throwBadInput("--set {}: unknown key; there are {}", assignment, keys);
}

}  // namespace

std::string settingsHelp() {
  std::string text = "Settings (--set KEY=VALUE; one that the technique does not read is a warning):\n";
  for (const Setting& setting : kSettings) text += fmt::format("  {:<20} {}\n", setting.key, setting.meaning);
  return text;
}

std::vector<std::string> offeredSettings(bool ofSolutions) {
  std::vector<std::string> keys;
  for (const Setting& setting : kSettings)
    if (!ofSolutions || isOfSolution(setting)) keys.push_back(std::string(setting.key) + "=");
  return keys;
}

std::string deviationsHelp() {
  std::string text = "\nDeviations (--deviation NAME=on|off; * are on with --fidelity original):\n";
  for (const Deviation& deviation : allDeviations())
    text += fmt::format("{} {:<24} {}\n", deviation.inOriginal ? '*' : ' ', deviation.name, deviation.meaning);
  return text;
}

void PictureOptions::declare(CLI::App& app) {
  offer(app.add_option("--technique", technique, "direct, rsm, lpv, radiosity or, for render, path")->capture_default_str(),
        {"direct", "rsm", "lpv", "radiosity"});
  offer(app.add_option("--component", component, "all, direct or indirect")->capture_default_str(), {"all", "direct", "indirect"});
  offer(app.add_option("--fidelity", fidelity, "corrected, or original: as published")->capture_default_str(), {"corrected", "original"});
  std::vector<std::string> switches;
  for (const Deviation& deviation : allDeviations())
    for (const char* state : {"=on", "=off"}) switches.push_back(deviation.name + std::string(state));
  offer(app.add_option("--deviation", deviations, "NAME=on|off: one deviation of the published original; may be repeated"), switches);
  app.add_option("--size", size, "WIDTHxHEIGHT in pixels; path without it: 1920x1080 for the JSON of the VPT original and for --fidelity original")->capture_default_str();
  offer(app.add_option("--set", settings, "KEY=VALUE, see below; may be repeated"), offeredSettings());
  app.add_option("--settings", settingsFile, "a settings file, such as `lucerna tune` writes; what else is given here comes after it");
  app.footer(settingsHelp() + deviationsHelp());
}

void PictureOptions::readSettingsFile() {
  if (settingsFile.empty()) return;
  const PictureOptions usual;
  const SettingsFile file = demo::readSettingsFile(settingsFile);
  if (file.technique && technique == usual.technique) technique = *file.technique;
  if (file.fidelity && fidelity == usual.fidelity) fidelity = *file.fidelity;
  deviations.insert(deviations.begin(), file.deviations.begin(), file.deviations.end());
  settings.insert(settings.begin(), file.settings.begin(), file.settings.end());
  settingsSpp = file.spp;
  if (settingsSpp && technique != "path") throwBadInput("--settings {}: key \"spp\": samples a pixel belong to technique path, not to {}", settingsFile, technique);
}

nlohmann::ordered_json PictureOptions::toJson() const {
  return {{"technique", technique}, {"fidelity", fidelity}, {"deviations", deviations}, {"settings", settings}};
}

namespace {

/// Which transport reads a setting of the light propagation volume; nothing where several do.
std::optional<LpvTransport> transportOf(std::string_view key) {
  for (const char* k : {"lpv.iterations", "lpv.propagate", "lpv.fill", "lpv.amplifier", "lpv.blocking", "lpv.hand-over", "lpv.lookup", "lpv.lookup-offset"})
    if (key == k) return LpvTransport::propagate;
  for (const char* k : {"lpv.visibility", "lpv.voxels"})
    if (key == k) return LpvTransport::gather;
  for (const char* k : {"lpv.rays", "lpv.least-rays", "lpv.samples"})
    if (key == k) return LpvTransport::rays;
  return {};
}

/// The transport where none is named: that of the first setting or deviation that one transport alone reads, else paths, which have all light.
void chooseTransport(RenderSettings& settings, const PictureOptions& options, const std::vector<std::string>& keys) {
  const auto isSet = [&](std::string_view key) { return std::find(keys.begin(), keys.end(), key) != keys.end(); };
  if (!isSet("lpv.transport")) {
    settings.lpv.transport = LpvTransport::rays;
    if (options.fidelity == "original" || settings.rsm.fluxCosine || settings.lpv.deviations != LightPropagationVolume::Deviations{}) settings.lpv.transport = LpvTransport::propagate;
    for (const std::string& key : keys)
      if (const auto transport = transportOf(key)) {
        settings.lpv.transport = *transport;
        if (*transport != LpvTransport::rays) logInfo("{}: lpv.transport={}, which alone reads it", key, nameOf(*transport));
        break;
      }
  }
  if (!isSet("lpv.bounces") && settings.lpv.transport == LpvTransport::rays) settings.lpv.bounces = LightPropagationVolume::kAllBounces;
}

}  // namespace

RenderSettings PictureOptions::parse(std::optional<float>& exposure) const {
  RenderSettings result;
  result.technique = parseTechnique(technique);
  result.component = parseComponent(component);
  if (fidelity != "corrected" && fidelity != "original") throwBadInput("--fidelity {}: unknown; there are corrected, original", fidelity);
  applyFidelity(result, fidelity == "original" ? Fidelity::original : Fidelity::corrected);
  for (const std::string& deviation : deviations) applyDeviation(result, deviation);
  result.size = parseSize(size);
  std::string unread;
  std::vector<std::string> keys;
  for (const std::string& assignment : settings) {
    const auto [key, value] = splitAssignment("--set", assignment);
    keys.push_back(key);
    findSetting(assignment, key, [](const Setting&) { return true; }).apply(result, exposure, "--set " + key, value);
    if (!isRead(readBy.empty() ? technique : readBy, key)) unread += (unread.empty() ? "" : ", ") + key;
  }
  if (result.technique == Technique::lpv) {
    chooseTransport(result, *this, keys);
    for (const std::string& key : keys)
      if (const auto transport = transportOf(key); transport && *transport != result.lpv.transport)
        logWarning("--set {}: lpv.transport={} does not read that, {} does", key, nameOf(result.lpv.transport), nameOf(*transport));
  }
  if (!unread.empty()) logWarning("--set {}: technique {} does not read that", unread, readBy.empty() ? technique : readBy);
  return result;
}

void applySolutionSetting(RadiositySolutionSettings& settings, const std::string& assignment) {
  const auto [key, value] = splitAssignment("--set", assignment);
  RenderSettings all;
  all.radiosity.solution = settings;
  std::optional<float> exposure;
  findSetting(assignment, key, isOfSolution).apply(all, exposure, "--set " + key, value);
  settings = all.radiosity.solution;
}

glm::ivec2 parseSize(const std::string& text) {
  const auto cross = text.find('x');
  if (cross == std::string::npos) throwBadInput("--size {}: expected WIDTHxHEIGHT, such as 640x360", text);
  return {parseNumber("--size", text.substr(0, cross), 1, 16384), parseNumber("--size", text.substr(cross + 1), 1, 16384)};
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
    } catch (const std::exception&) {
    }
    if (used == 0 || used != part.size() || !std::isfinite(value)) numbers.clear();
    if (used == 0 || used != part.size() || !std::isfinite(value)) break;
    numbers.push_back(value);
  }
  if (numbers.size() != 7) {
    std::string known;
    for (const Camera& camera : scene.cameras) known += (known.empty() ? "" : ", ") + (camera.name.empty() ? "default" : camera.name);
    throwBadInput("--camera {}: neither a camera of the scene ({}) nor px,py,pz,tx,ty,tz,fov", text, known);
  }
  Camera camera;
  camera.position = {numbers[0], numbers[1], numbers[2]};
  const glm::dvec3 view = glm::dvec3(numbers[3], numbers[4], numbers[5]) - camera.position;
  if (glm::length(view) == 0.0) throwBadInput("--camera {}: the target is the position", text);
  if (!(numbers[6] > 0.0 && numbers[6] < 180.0)) throwBadInput("--camera {}: the field of view is in degrees, above 0 and below 180", text);
  camera.direction = glm::normalize(view);
  camera.up = std::abs(camera.direction.y) < 0.999 ? glm::dvec3(0.0, 1.0, 0.0) : glm::dvec3(0.0, 0.0, -1.0);
  camera.verticalFov = glm::radians(numbers[6]);
  return camera;
}

// ---------------------------------------------------------------------------------------------------- progress, interruption

Progress::Progress(std::string what, int total, bool quiet)
    : what_(std::move(what)), total_(total), enabled_(!quiet && isatty(STDERR_FILENO)), start_(std::chrono::steady_clock::now()) {}

Progress::~Progress() {
  if (drawn_) fmt::print(stderr, "\r\x1b[K");
}

void Progress::update(int done) {
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  if (!enabled_ || (seconds < 1.0 && !drawn_)) return;
  constexpr int kWidth = 30;
  const int filled = total_ > 0 ? kWidth * done / total_ : 0;
  const double rest = done > 0 ? seconds / done * (total_ - done) : 0.0;
  fmt::print(stderr, "\r{} [{:#<{}}{:-<{}}] {}/{}, {:.0f} s left \x1b[K", what_, "", filled, "", kWidth - filled, done, total_, rest);
  std::fflush(stderr);
  drawn_ = true;
}

namespace {
volatile std::sig_atomic_t g_interrupted = 0;  // the signal
volatile std::time_t g_interruptedAt = 0;

void onInterrupt(int signal) {
  // A second Ctrl-C does not wait for the work to end; one that comes with the first (timeout signals a whole group) is the same.
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

bool interrupted() { return g_interrupted != 0; }

int exitCode() { return g_interrupted ? 128 + g_interrupted : 0; }

// ---------------------------------------------------------------------------------------------------- stage times

nlohmann::ordered_json stagesJson(const std::vector<gl::StageStatistics>& stages) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  for (const auto& s : stages) {
    json[s.name] = {{"median_ms", s.medianMs}, {"p95_ms", s.p95Ms}, {"count", s.count}, {"query_median_ms", s.queryMedianMs}, {"ran", s.ran}, {"frames", s.frames}, {"saved_ms", s.savedMs()}};
    if (!std::isnan(s.wallMedianMs)) json[s.name]["wall_median_ms"] = s.wallMedianMs;
  }
  return json;
}

nlohmann::ordered_json gatherJson(const RsmGather& gather) {
  const RsmGather::Counts& c = gather.counts();
  const auto perFrame = [&](std::uint64_t sum) { return c.frames ? (sum + c.frames / 2) / c.frames : 0; };
  return {{"refused", perFrame(c.refused)}, {"pixels", perFrame(c.pixels)}, {"gathered", perFrame(c.gathered)}, {"saving", c.saving()}, {"frames", c.frames}};
}

std::string gatherLine(const RsmGather& gather) {
  const nlohmann::ordered_json json = gatherJson(gather);
  const auto count = [&](const char* key) { return json.at(key).get<std::uint64_t>(); };
  if (count("frames") == 0) return "";
  return fmt::format("gathered {} of {} pixels a frame ({} refused by interpolation), {:.1f} % saved\n", count("gathered"), count("pixels"), count("refused"),
                     100.0 * gather.counts().saving());
}

nlohmann::ordered_json receiversJson(const LpvReceivers& receivers) {
  const LpvReceivers::Counts& c = receivers.counts();
  return {{"receivers", c.receivers}, {"waiting", c.waiting}, {"without_room", c.left}, {"paths_of_each", receivers.settings().samples}};
}

std::string receiversLine(const LpvReceivers& receivers) {
  const LpvReceivers::Counts& c = receivers.counts();
  std::string line = fmt::format("{} receivers, {} paths each", c.receivers, receivers.settings().samples);
  if (c.waiting > 0) line += fmt::format("; {} lack some", c.waiting);
  if (c.left > 0) line += fmt::format("; {} found no room (lpv.cells)", c.left);
  return line + "\n";
}

std::string stagesTable(const std::vector<gl::StageStatistics>& stages, const std::string& renderer) {
  std::string text = fmt::format("Stage times on {}\n{:<18}{:>12}{:>12}{:>8}{:>16}{:>16}{:>14}\n", renderer, "stage", "median ms", "95 % ms", "count",
                                 "query median ms", "ran in frames", "saved ms");
  double total = 0.0, saved = 0.0;
  for (const auto& s : stages) {
    text += fmt::format("{:<18}{:>12.3f}{:>12.3f}{:>8}{:>16.3f}{:>16}{:>14.3f}\n", s.name, s.medianMs, s.p95Ms, s.count, s.queryMedianMs,
                        fmt::format("{} of {}", s.ran, s.frames), s.savedMs());
    total += std::isnan(s.medianMs) ? 0.0 : s.medianMs - s.savedMs();
    saved += s.savedMs();
  }
  return text + fmt::format("{:<18}{:>12.3f}{:>66.3f}\n", "a frame", total, saved);
}

}  // namespace lucerna::demo
