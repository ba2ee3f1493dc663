#include "bench/error_rows.hpp"

#include "base/clock.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/hash.hpp"
#include "base/image.hpp"
#include "base/log.hpp"
#include "base/statistics.hpp"
#include "base/provenance.hpp"
#include "irradiance_cache/irradiance_cache_frame.hpp"
#include "irradiance_cache/settings.hpp"
#include "lpv/settings.hpp"
#include "gl/draw.hpp"
#include "measure/flip.hpp"
#include "measure/front.hpp"
#include "measure/heat_map.hpp"
#include "shared/shell.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <functional>
#include <map>
#include <set>

namespace lucerna::demo::bench {

namespace fs = std::filesystem;

namespace {
double msSince(Clock::time_point start) { return 1e3 * secondsSince(start); }

std::string fileStem(const std::string& name) {
  Hash hash;
  hash.add(std::string_view(name));
  std::string text =
      fmt::format("{}-{:08x}", name.substr(0, 48), static_cast<std::uint32_t>(hash.value() ^ hash.value() >> 32));
  for (char& c : text)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '-' && c != '.') c = '_';
  return text;
}

/// A picture's options as settings of a measuring renderer.
RenderSettings settingsOf(const ErrorBench& bench, const PictureOptions& picture, Component component) {
  PictureOptions own = picture;
  own.usualSamples = bench.pixelSamples;  // a point may ask for others
  RenderSettings settings = own.parse();
  settings.component = component;
  settings.size = bench.size;
  settings.wholePictures = true;
  settings.filter = bench.filter;
  settings.fullFloatTarget = true;
  settings.textures.anisotropy = 1.0f;  // anisotropic filtering differs between drivers
  settings.reuse = false;  // measure a picture's full cost, without savings in a still scene
  return settings;
}

struct Timed {
  std::vector<double> wallMs, cpuMs;
  double queryMs = 0.0;  ///< medians of all stages together
  double setupMs = 0.0;
  std::size_t gpuBytes = 0;
  Image picture;
};

/// Renders from scratch: accumulated quantities are restarted and brought to their end.
void renderAnew(Renderer& renderer, const Camera& camera) {
  renderer.forget();
  renderer.renderToTheEnd(camera);
}

Timed render(const ErrorBench& bench, const RenderSettings& settings, int frames) {
  Timed timed;
  auto start = Clock::now();
  Renderer renderer(bench.context, bench.programs, bench.scene, settings);
  gl::finish();
  timed.setupMs = msSince(start);
  renderAnew(renderer, bench.camera);  // warm-up
  gl::finish();
  renderer.drain();
  renderer.timer().reset();
  const auto all = Clock::now();
  for (int i = 0; i < frames || (i < 3 * frames && msSince(all) < 200.0); ++i) {
    start = Clock::now();
    const std::clock_t cpuStart = std::clock();
    renderAnew(renderer, bench.camera);
    gl::finish();
    timed.wallMs.push_back(msSince(start));
    timed.cpuMs.push_back(1e3 * static_cast<double>(std::clock() - cpuStart) / CLOCKS_PER_SEC);
  }
  renderer.drain();
  for (const gl::StageStatistics& stage : renderer.timer().statistics())
    if (std::isfinite(stage.queryMedianMs)) timed.queryMs += stage.queryMedianMs;
  timed.gpuBytes = renderer.gpuBytes();
  timed.picture = renderer.readRadiance();
  return timed;
}

std::optional<ErrorRow> readRow(const fs::path& file) {
  if (!fs::exists(file)) return std::nullopt;
  ErrorRow row = ErrorRow::parse(readFileText(file), nullptr, false);
  if (row.is_discarded()) {
    logWarning("{}: damaged row, will be measured again", file.string());
    return std::nullopt;
  }
  return row;
}

nlohmann::ordered_json partJson(const measure::PartErrors& part) {
  return {{"pixels", part.pixels},
          {"relative_bias", part.relativeBias},
          {"bias_error", part.biasError},
          {"squares", part.squares}};
}

/// Judge only surface pixels if the model shows lights themselves; indirect light does not.
bool onSurfacesAlone(const LightPaths& model) { return showsLights(model.transport); }

/// A baseline's errors. That of a black picture is 100 % by definition, however noisy the reference is.
ErrorRow baselineErrors(const References& references, const std::string& name, const Image& picture,
                        const measure::Reference& reference, bool surfacesAlone) {
  ErrorRow errors = errorsJson(references.judge(picture, reference, surfacesAlone));
  if (name == "black") errors["at_noise"] = errors["blocks"]["at_noise"] = false;
  return errors;
}

/// A picture of no cost, which techniques must beat.
ErrorRow baseline(const References& references, const std::string& name, const Image& picture) {
  ErrorRow row;
  row["technique"] = row["series"] = row["label"] = name;
  row["fidelity"] = "";
  row["settings"] = row["deviations"] = nlohmann::ordered_json::array();
  for (const char* key : {"ms", "wall_ms", "setup_ms", "gpu_bytes"}) row[key] = nullptr;
  row.update(baselineErrors(references, name, picture, references.all(), false));
  row["flip"] = measure::flipHdr(picture, references.all().mean).mean;
  return row;
}

}  // namespace

nlohmann::ordered_json errorsJson(const JudgedPicture& judged) {
  const measure::JudgedErrors& e = judged.pixels;
  const double mean = e.measured.referenceMean;
  return {{"l2", judged.scattered.l2},
          {"l2_error", judged.l2Error},
          {"nrmse_error", judged.nrmseError},
          {"relmse_error", judged.relmseError},
          {"nrmse", e.nrmse},
          {"rmse", e.rmse},
          {"relmse", e.relmse},
          {"bias", e.measured.bias},
          {"bias_error", e.biasError},
          {"relative_bias", e.measured.relativeBias},
          {"p99", e.measured.p99},
          {"max", e.measured.max},
          {"at_noise", e.atNoise},
          {"bias_at_noise", e.biasAtNoise},
          {"noise_l2", judged.scattered.noiseL2},
          {"noise_nrmse", e.noiseNrmse},
          {"noise_relmse", e.noiseRelmse},
          {"measured_nrmse", e.measured.nrmse},
          {"not_finite", e.measured.notFinite},
          {"blocks",
           {{"l2", judged.blocks.l2},
            {"nrmse", judged.blocks.rmse / mean},
            {"at_noise", judged.blocks.atNoise},
            {"noise_l2", judged.blocks.noiseL2},
            {"noise_nrmse", judged.blocks.noiseNrmse * judged.blocks.measured.referenceMean / mean}}},
          {"lit", partJson(judged.lit)},
          {"other", partJson(judged.other)}};
}

std::vector<ErrorRow> baselines(const References& references) {
  const measure::Reference& all = references.all();
  return {baseline(references, "black", references.blackPicture(all)),
          baseline(references, "constant", references.constantPicture(all))};
}

std::vector<InsideModel> insideModels(const References& references) {
  std::vector<InsideModel> result;
  std::set<LightPaths> made;
  for (const TechniqueModel& m : references.models) {
    if (!m.paths.lights.any() || m.paths == LightPaths{Transport::all, references.lights} ||
        !made.insert(m.paths).second)
      continue;
    const measure::Reference reference = references.inside(m.paths);
    const auto row = [&](const char* name, const Image& picture) {
      ErrorRow r{{"label", name}, {"technique", name}};
      r["inside_model"] = baselineErrors(references, name, picture, reference, onSurfacesAlone(m.paths));
      r["inside_model"]["model"] = nameOf(m.paths);
      return r;
    };
    result.push_back({nameOf(m.paths), row("black", references.blackPicture(reference)),
                      row("constant", references.constantPicture(reference))});
  }
  return result;
}

TechniqueModel modelOf(const SweepPoint& point, measure::LightKinds scene) {
  const RenderSettings settings = point.picture.parse();
  LightPaths paths = modelOf(settings);
  paths.lights = paths.lights & scene;
  return {point.picture.technique, paths, directLightsOf(settings) & scene};
}

fs::path rowFile(const fs::path& folder, const std::string& name) {
  return folder / "rows" / (fileStem(name) + ".json");
}

std::string writePictures(const ErrorBench& bench, const std::string& name, const Image& picture,
                          const measure::Reference& reference, const std::vector<float>& flip, const Image* ownError) {
  const std::string stem = "pictures/" + fileStem(name);
  const Image& exact = reference.mean;
  // The same scale for all rows, so that they can be compared: a fifth of a black picture's error.
  const double scale = std::max(0.2 * measure::heatMapScale(Image(exact.width, exact.height), exact), 1e-30);
  const auto file = [&](const char* kind) { return bench.folder / (stem + kind + ".png"); };
  writePng(file(""), toneMapped(picture, bench.scene.exposure));
  writeImage(bench.folder / (stem + ".pfm"), picture);
  if (ownError) writeImage(bench.folder / (stem + ".error.pfm"), *ownError);
  if (!flip.empty()) {
    Bitmap map;
    map.width = picture.width, map.height = picture.height;
    for (const float v : flip) {
      const auto grey = static_cast<std::uint8_t>(std::lround(255.0f * std::clamp(v, 0.0f, 1.0f)));
      map.rgba.insert(map.rgba.end(), {grey, grey, grey, 255});
    }
    writePng(file(".flip"), map);
  }
  writePng(file(".absolute"), measure::heatMap(picture, exact, measure::HeatMap::absolute, scale));
  writePng(file(".signed"), measure::heatMap(picture, exact, measure::HeatMap::signedLuminance, scale));
  return stem;
}

double medianError(const std::vector<double>& values) {
  const double n = static_cast<double>(values.size());
  if (values.size() < 2) return NAN;
  double mean = 0.0, squares = 0.0;
  for (const double v : values) mean += v / n;
  for (const double v : values) squares += (v - mean) * (v - mean);
  const double deviation = std::sqrt(squares / (n - 1.0));
  return deviation * (values.size() == 3 ? 0.67 : std::sqrt(1.5708 / n));
}

void addProvenance(const ErrorBench& bench, ErrorRow& row) {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  char date[32];
  std::strftime(date, sizeof date, "%Y-%m-%dT%H:%M:%SZ", &utc);
  const std::string technique = row.at("technique").get<std::string>();
  row["date"] = date;
  row["program"] = programVersion();
  row["renderer"] = bench.context.capabilities().renderer;
  row["driver"] = bench.context.capabilities().version;
  row["cpu"] = cpuName();
  row["command"] = bench.command + (bench.hasSweeps ? " --techniques " + technique : "");
  std::vector<std::string> words{"--technique", technique, "--fidelity", row.at("fidelity").get<std::string>()};
  for (const auto& deviation : row.at("deviations"))
    words.insert(words.end(), {"--deviation", deviation.get<std::string>()});
  if (row.contains("spp"))
    words.insert(words.end(), {"--spp", row.at("spp").dump(), "--seed", row.at("seeds").at("seed").at(0).dump()});
  if (row.contains("denoised")) words.push_back("--denoise");
  if (!row.contains("spp"))
    for (const auto& setting : row.at("settings")) words.insert(words.end(), {"--set", setting.get<std::string>()});
  row["picture_command"] = bench.pictureCommand + " " + shellCommand(words) + " -o picture.pfm";
}

double rankedError(const ErrorRow& row, const char* measure) {
  const auto noise = row.find("at_noise");
  return noise != row.end() && noise->is_boolean() && noise->get<bool>()
             ? 3.0 * number(row, ("noise_" + std::string(measure)).c_str())
             : number(row, measure);
}

double number(const ErrorRow& row, const char* key) {
  const auto found = row.find(key);
  return found == row.end() || !found->is_number() ? NAN : found->get<double>();
}

void makeFolder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder / "rows", error);
  if (!error) fs::create_directories(folder / "pictures", error);
  if (error) throwBadInput("--out {}: cannot create folder ({})", folder.string(), error.message());
  writeFileAtomically(folder / "rows/.writable", "");
}

void claimFolder(const fs::path& folder, const std::string& identity) {
  const fs::path file = folder / "bench.txt";
  if (fs::exists(file)) {
    if (const std::string known = readFileText(file); known != identity + "\n")
      throwBadInput("--out {}: holds another bench ({}); choose another folder", folder.string(),
                    known.substr(0, known.find('\n')));
    return;
  }
  writeFileAtomically(file, identity + "\n");
}

std::optional<ErrorRow> finishedRow(const fs::path& folder, const SweepPoint& point) {
  return readRow(rowFile(folder, point.name()));
}

void keepRow(const ErrorBench& bench, const SweepPoint& point, const ErrorRow& row) {
  writeFileAtomically(rowFile(bench.folder, point.name()), row.dump(1) + "\n");
}

namespace {

/// The row of a measurement. indirect: the picture of indirect light alone, made if it is needed.
ErrorRow rowOf(const ErrorBench& bench, const SweepPoint& point, const PictureOptions& options, const Timed& timed,
               const std::function<Image()>& indirect) {
  const bool software = bench.context.capabilities().softwareRenderer;
  const double wall = median(timed.wallMs);

  ErrorRow row;
  row["technique"] = options.technique;
  row["fidelity"] = options.fidelity;
  row["settings"] = options.settings;
  row["deviations"] = options.deviations;
  row["series"] = point.series;
  row["step"] = point.isStep;
  row["label"] = point.label();
  row["ms"] = software || timed.queryMs == 0.0 ? wall : timed.queryMs;
  row["wall_ms"] = wall;
  row["wall_ms_spread"] = {percentile(timed.wallMs, 0.05), percentile(timed.wallMs, 0.95)};
  row["query_ms"] = timed.queryMs;
  row["wall_ms_samples"] = timed.wallMs;
  row["cpu_ms"] = median(timed.cpuMs);
  row["frames"] = timed.wallMs.size();
  row["setup_ms"] = timed.setupMs;
  row["gpu_bytes"] = timed.gpuBytes;
  const JudgedPicture errors = bench.references.judge(timed.picture, bench.references.all());
  row.update(errorsJson(errors));
  measure::Flip flip{NAN, {}};
  if (errors.pixels.measured.notFinite == 0) flip = measure::flipHdr(timed.picture, bench.references.all().mean);
  row["flip"] = flip.mean;
  // Inside its model: the promised light, from the supported lights. All light is judged above.
  const LightPaths model = modelOf(point, bench.references.lights).paths;
  if (model.lights.any() && model != LightPaths{Transport::all, bench.references.lights}) {
    const bool whole = showsLights(model.transport);
    const Image picture = whole ? timed.picture : indirect();
    row["inside_model"] =
        errorsJson(bench.references.judge(picture, bench.references.inside(model), onSurfacesAlone(model)));
    row["inside_model"]["model"] = nameOf(model);
    row["inside_model"]["transport"] = std::string(nameOf(model.transport));
    row["inside_model"]["lights"] = measure::nameOf(model.lights);
  }
  row["picture"] = writePictures(bench, point.name(), timed.picture, bench.references.all(), flip.map, nullptr);
  addProvenance(bench, row);
  keepRow(bench, point, row);
  return row;
}

}  // namespace

ErrorRow measurePoint(const ErrorBench& bench, const SweepPoint& point, const std::vector<std::string>& more) {
  PictureOptions options = point.picture;
  options.settings.insert(options.settings.end(), more.begin(), more.end());
  const Timed timed = render(bench, settingsOf(bench, options, Component::all), bench.frames);
  return rowOf(bench, point, options, timed,
               [&] { return render(bench, settingsOf(bench, options, Component::indirect), 1).picture; });
}

ErrorRow measureBound(const ErrorBench& bench, const SweepPoint& point) {
  // The scene with the lights of the technique's model alone.
  const measure::LightKinds lights = modelOf(point, bench.references.lights).paths.lights;
  const Scene scene = measure::litBy(bench.scene, lights);
  RenderSettings settings = settingsOf(bench, point.picture, Component::indirect);
  if (settings.technique == "lpv") {
    settings.of<IrradianceCacheSettings>().cascades = settings.of<LpvSettings>().cascades;
    settings.of<IrradianceCacheSettings>().bounces = settings.of<LpvSettings>().bounces;
  }
  settings.technique = "irradiance-cache";
  settings.of<IrradianceCacheSettings>().transport =
      point.bound == Bound::map ? CacheTransport::gather : CacheTransport::rays;
  settings.of<IrradianceCacheSettings>().samples =
      settings.of<IrradianceCacheSettings>().rays;  // the records' light is not shown
  Timed timed;
  auto start = Clock::now();
  Renderer renderer(bench.context, bench.programs, scene, settings);
  renderer.renderToTheEnd(bench.camera);
  gl::finish();
  timed.setupMs = msSince(start);
  start = Clock::now();
  const std::clock_t cpuStart = std::clock();
  const IrradianceCacheFrame* frame = dynamic_cast<const IrradianceCacheFrame*>(renderer.technique());
  constexpr int kPaths = 2048;
  const Image indirect = !frame
                             ? Image(bench.size.x, bench.size.y)
                             : measure::lit(bench.references.albedo,
                                            point.bound == Bound::map
                                                ? frame->gatheredAtPixels()
                                                : frame->readFromCells(settings.of<LpvSettings>().cascades,
                                                                       settings.of<LpvSettings>().blendBand, kPaths));
  timed.wallMs = {msSince(start)};
  timed.cpuMs = {1e3 * static_cast<double>(std::clock() - cpuStart) / CLOCKS_PER_SEC};
  timed.gpuBytes = renderer.gpuBytes();
  timed.picture = render(bench, settingsOf(bench, point.picture, Component::direct), 1).picture;
  for (std::size_t i = 0; i < indirect.pixels.size(); ++i) timed.picture.pixels[i] += indirect.pixels[i];
  return rowOf(bench, point, point.picture, timed, [&] { return indirect; });
}

namespace {

/// A row's time and its l2 (errors: the row, or its inside_model), with their standard errors.
measure::CostAndError pointOf(const ErrorRow& row, const ErrorRow& errors) {
  std::vector<double> samples;
  if (const auto found = row.find("wall_ms_samples"); found != row.end() && found->is_array())
    for (const auto& value : *found) samples.push_back(value.get<double>());
  const auto orNone = [](double spread) { return std::isfinite(spread) ? spread : 0.0; };
  const auto noise = errors.find("at_noise");
  const bool atNoise = noise != errors.end() && noise->is_boolean() && noise->get<bool>();
  return {number(row, "ms"), rankedError(errors, "l2"), orNone(medianError(samples)),
          atNoise ? 0.0 : orNone(number(errors, "l2_error"))};
}

/// The front by time and l2 of all light among some rows.
template <class IsCandidate>
std::vector<bool> frontAmong(const std::vector<ErrorRow>& rows, const IsCandidate& isCandidate) {
  std::vector<measure::CostAndError> points;
  for (const ErrorRow& row : rows) {
    points.push_back(pointOf(row, row));
    if (!isCandidate(row)) points.back().cost = NAN;
  }
  return measure::paretoFront(points);
}

bool isInsideFront(const ErrorRow& row) { return row.at("inside_front").get<bool>(); }

}  // namespace

void markFront(std::vector<ErrorRow>& rows) {
  // Settings of one technique are ranked inside their model: against all light, errors of the model and of the settings
  // may cancel.
  std::map<std::string, std::vector<std::size_t>> groups;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i]["inside_front"] = !rows[i].contains("inside_model");
    if (rows[i].contains("inside_model"))
      groups[rows[i].at("technique").get<std::string>() + rows[i].at("inside_model").at("model").get<std::string>()]
          .push_back(i);
  }
  for (const auto& [name, group] : groups) {
    std::vector<measure::CostAndError> points;
    for (const std::size_t i : group) points.push_back(pointOf(rows[i], rows[i].at("inside_model")));
    const std::vector<bool> front = measure::paretoFront(points);
    for (std::size_t k = 0; k < group.size(); ++k) rows[group[k]]["inside_front"] = static_cast<bool>(front[k]);
  }
  // The remaining rows are ranked by all light.
  const std::vector<bool> front = frontAmong(rows, isInsideFront);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    int rank = 0;  // number of front rows that are at most as slow
    for (std::size_t j = 0; j < rows.size(); ++j)
      rank += front[i] && front[j] && number(rows[j], "ms") <= number(rows[i], "ms");
    rows[i]["pareto"] = static_cast<bool>(front[i]);
    rows[i]["front"] = rank;
  }
}

std::vector<const ErrorRow*> correctedFront(const std::vector<ErrorRow>& rows) {
  const std::vector<bool> isOnFront =
      frontAmong(rows, [](const ErrorRow& row) { return isInsideFront(row) && row.at("fidelity") != "original"; });
  std::vector<const ErrorRow*> front;
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (isOnFront[i]) front.push_back(&rows[i]);
  std::ranges::sort(front, {}, [](const ErrorRow* row) { return number(*row, "ms"); });
  return front;
}

std::vector<Sweep> sweepsOf(const std::vector<ErrorRow>& rows) {
  std::vector<Sweep> sweeps;
  for (std::size_t first = 0, last = 0; first < rows.size(); first = last) {
    const std::string series = rows[first].at("series").get<std::string>();
    while (last < rows.size() && rows[last].at("series") == series) ++last;
    const auto is = [&](auto&& what) { return std::all_of(&rows[first], &rows[0] + last, what); };
    if (last - first < 2 || !is([](const ErrorRow& row) { return row.value("step", false); })) continue;
    const auto modelOfRow = [](const ErrorRow& row) {
      return row.contains("inside_model") ? row.at("inside_model").at("model").get<std::string>() : std::string();
    };
    Sweep sweep{series, modelOfRow(rows[first]), {}, {}, {}};
    if (!is([&](const ErrorRow& row) { return modelOfRow(row) == sweep.model; })) sweep.model.clear();
    double before = NAN, beforeError = NAN;
    for (std::size_t i = first; i < last; ++i) {
      const ErrorRow& errors = sweep.model.empty() ? rows[i] : rows[i].at("inside_model");
      const double error = number(errors, "l2_error"),
                   value = errors.value("at_noise", false) ? NAN : number(errors, "l2");
      sweep.labels.push_back(rows[i].at("label").get<std::string>());
      sweep.errors.push_back(value);
      if (measure::isBelow(before, beforeError, value, error))
        sweep.rises.push_back({i - first, value - before, std::hypot(error, beforeError)});
      before = value, beforeError = error;
    }
    sweeps.push_back(std::move(sweep));
  }
  return sweeps;
}

}  // namespace lucerna::demo::bench
