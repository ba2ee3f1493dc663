// Reproduces tables 7.2 to 7.8 of the LPV original [LPV2015, 7.2] and its comparison of methods to clear textures.
//
// Every configuration keeps its own volume. A round runs each of them once, with the published and the best method for
// a setting next to each other (A B A B), so that other load on the machine affects both. The first round is a warm-up
// and is dropped.
#include "base/error.hpp"
#include "base/statistics.hpp"
#include "base/provenance.hpp"
#include "originals/originals.hpp"
#include "forward/gpu_scene.hpp"
#include "forward/sun_frustum.hpp"
#include "gl/pass.hpp"
#include "gl/time_query.hpp"
#include "lpv/light_propagation_volume.hpp"
#include "measure/reference.hpp"
#include "rsm/reflective_shadow_map.hpp"
#include "render/deviations.hpp"
#include "shared/frame.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace lucerna::demo::bench {

namespace {

// ---------------------------------------------------------------------------------------------------- what was
// published

enum class Way { anyPath, geometryShader, atomics };

/// RSM, injection, propagation in ms; 0: not in the table.
struct Times {
  double rsm = 0.0, injection = 0.0, propagation = 0.0;
};

struct PublishedRow {
  const char* table;
  const char* setting;
  Way way;
  int rsmSize, cells, grids, iterations;
  bool blocking;
  Times nvidia, amd;
};

constexpr const char* kNvidia = "NVIDIA GTX 960";
constexpr const char* kAmd = "AMD R9 270";

/// Maps of 256 texels a side, grids of 32^3 cells.
constexpr PublishedRow row(const char* table, const char* setting, int grids, int iterations, bool blocking,
                           const Times& nvidia, const Times& amd) {
  return {table, setting, Way::anyPath, 256, 32, grids, iterations, blocking, nvidia, amd};
}

constexpr PublishedRow kPublishedTimes[] = {
    row("7.2", "8 iterations, blocking", 1, 8, true, {0.274104, 0.375929, 3.3704}, {0.363047, 1.35305, 9.99295}),
    row("7.2", "8 iterations, blocking", 3, 8, true, {0.274104, 0.999607, 8.75379}, {0.363047, 3.48448, 29.2733}),
    row("7.3", "8 iterations, no blocking", 1, 8, false, {0.265721, 0.397134, 3.05226}, {0.362724, 1.35732, 6.81374}),
    row("7.3", "8 iterations, no blocking", 3, 8, false, {0.265721, 0.932677, 7.31519}, {0.362724, 3.50141, 19.7886}),
    row("7.4", "12 iterations, blocking", 1, 12, true, {0.274104, 0.401629, 6.07258}, {0.363047, 1.35242, 15.5127}),
    row("7.4", "12 iterations, blocking", 3, 12, true, {0.274104, 0.999594, 13.8813}, {0.363047, 3.4849, 45.6326}),
    row("7.5", "12 iterations, no blocking", 1, 12, false, {0.265721, 0.399961, 5.02879}, {0.362724, 1.35757, 10.4721}),
    row("7.5", "12 iterations, no blocking", 3, 12, false, {0.265721, 0.96792, 11.3734}, {0.362724, 3.50252, 30.7741}),
    {"7.6", "geometry shader, 32^3", Way::geometryShader, 256, 32, 1, 8, true, {0.0, 0.375929, 3.3704}, {}},
    {"7.6", "atomics, 32^3", Way::atomics, 256, 32, 1, 8, true, {0.0, 0.397899, 3.76333}, {}},
    {"7.6", "geometry shader, 32^3", Way::geometryShader, 256, 32, 3, 8, true, {0.0, 0.999607, 8.75379}, {}},
    {"7.6", "atomics, 32^3", Way::atomics, 256, 32, 3, 8, true, {0.0, 0.998954, 10.4171}, {}},
    {"7.7", "geometry shader, 64^3", Way::geometryShader, 256, 64, 1, 8, true, {0.0, 0.796672, 15.6416}, {}},
    {"7.7", "geometry shader, 32^3", Way::geometryShader, 256, 32, 3, 8, true, {0.0, 0.999607, 8.75379}, {}},
    {"7.7", "atomics, 64^3", Way::atomics, 256, 64, 1, 8, true, {0.0, 0.44032, 25.0573}, {}},
    {"7.7", "atomics, 32^3", Way::atomics, 256, 32, 3, 8, true, {0.0, 0.998954, 10.4171}, {}},
    {"7.8", "RSM 128", Way::anyPath, 128, 32, 3, 0, true, {0.232448, 0.41984, 0.0}, {}},
    {"7.8", "RSM 256", Way::anyPath, 256, 32, 3, 0, true, {0.246784, 0.999594, 0.0}, {}},
    {"7.8", "RSM 512", Way::anyPath, 512, 32, 3, 0, true, {0.37376, 4.46874, 0.0}, {}},
};
constexpr double kClearTexImage = 0.0049, kTexSubImage = 0.09958;

// ---------------------------------------------------------------------------------------------------- configurations

struct Config {
  int rsmSize, cells, grids, iterations;  // iterations 0: only injection is timed, for 7.8
  bool blocking;
  LpvFill fill;
  LpvPropagate propagate;
  bool published = false;  // cell sizes, steps, formats and atomics of the text, without joining; otherwise ours
  auto operator<=>(const Config&) const = default;
  /// Our atomics are one per tile of texels that fall into the same cell; the published ones are one per light.
  std::string fillName() const {
    return std::string(nameOf(fill)) + (fill == LpvFill::layered || published ? "" : " tiles");
  }
  std::string key() const {
    return fmt::format("{} {} {} {} {} {}/{} {}", rsmSize, cells, grids, iterations, blocking, nameOf(fill),
                       nameOf(propagate), published ? "published" : "ours");
  }
};

LpvSettings settingsOf(const Config& config) {
  RenderSettings settings;
  if (config.published) applyFidelity(settings, Fidelity::thesis);
  LpvSettings& lpv = settings.of<LpvSettings>();
  if (config.published && config.fill != LpvFill::layered) {
    lpv.tile = 1;
    lpv.deviations.halfGrids = false;  // filling by layered passes needs this off
  }
  lpv.cascades.cells = config.cells;
  lpv.cascades.cascades = config.grids;
  lpv.iterations = std::max(config.iterations, 2);  // with fewer there would be no geometry volume
  lpv.blocking = config.blocking;
  lpv.fill = config.fill;
  lpv.propagate = config.propagate;
  return lpv;
}

std::string rsmStage(int size) { return fmt::format("rsm {}", size); }

/// The scene in the sun's view, and the volumes of all configurations.
class Bench {
 public:
  explicit Bench(const TablesInput& input)
      : input_(input),
        capabilities_(input.context.capabilities()),
        features_(analyse(input.scene)),
        gpuScene_(input.scene, features_, capabilities_),
        timer_(capabilities_.softwareRenderer) {
    if (!LightPropagationVolume::isNeeded(features_))
      throwBadInput("{}: no sun, or nothing that reflects it: no indirect light to measure", input.scene.file.string());
    sunFrustum_ = fitSunFrustum(input.scene, input.scene.sun->direction);
    shared::FrameConstants frame{};
    frame.sunClipFromWorld = glm::mat4(sunFrustum_.clipFromWorld);
    frame.sunDirection = glm::vec3(input.scene.sun->direction);
    frame.sunIrradiance = input.scene.sun->irradiance;
    frameConstants_ = gl::Buffer("frame constants", sizeof frame, &frame, gl::Usage::staticDraw);
    frameConstants_.bindUniform(0);
  }

  gl::TimeQuery& timer() { return timer_; }

  void add(const Config& config) {
    if (volumes_.contains(config)) return;
    if (!maps_.contains(config.rsmSize)) {
      ReflectiveShadowMap::Settings settings;
      settings.size = config.rsmSize;
      maps_.try_emplace(config.rsmSize, input_.programs, gpuScene_, settings);
    }
    volumes_.try_emplace(config, input_.programs, capabilities_, settingsOf(config));
    order_.push_back(config);
  }
  void removeVolumes() {
    volumes_.clear();
    order_.clear();
  }

  /// Draws every map once, then runs every configuration once.
  void runRound() {
    std::map<int, ReflectiveShadowMap::Outputs> outputs;
    for (auto& [size, map] : maps_) {
      const gl::TimeQuery::Scope stage(timer_, rsmStage(size));
      outputs.emplace(size, map.record(gpuScene_, sunFrustum_));
    }
    const glm::vec3 sun = input_.scene.sun->irradiance;
    const Camera& camera = input_.scene.cameras.front();
    for (const Config& config : order_) {
      if (interrupted()) return;
      LightPropagationVolume& volume = volumes_.at(config);
      const LpvInputs inputs{
          {outputs.at(config.rsmSize)},
          placeCascades(volume.settings().cascades, input_.scene.bounds, camera.position, camera.direction),
          std::max({sun.x, sun.y, sun.z})};
      {
        const gl::TimeQuery::Scope stage(timer_, config.key() + " injection");
        volume.place(inputs);
        volume.inject(inputs);
        volume.fillGeometryVolume(inputs);
      }
      if (config.iterations == 0) continue;
      const gl::TimeQuery::Scope stage(timer_, config.key() + " propagation");
      volume.propagate();
      volume.join();
    }
    timer_.collect();
  }

  /// Stored samples if any, otherwise the measured ones.
  const std::vector<double>& samples(const std::string& stage) const {
    if (const auto found = kept_.find(stage); found != kept_.end()) return found->second;
    return capabilities_.softwareRenderer ? timer_.wallSamples(stage) : timer_.querySamples(stage);
  }
  void keep(const std::string& stage, std::vector<double> samples) { kept_.try_emplace(stage, std::move(samples)); }
  const std::vector<double>& injection(const Config& config) const { return samples(config.key() + " injection"); }
  const std::vector<double>& propagation(const Config& config) const { return samples(config.key() + " propagation"); }
  /// Injection and propagation of each frame together.
  std::vector<double> total(const Config& config) const {
    std::vector<double> sum = injection(config);
    const std::vector<double>& more = propagation(config);
    sum.resize(std::min(sum.size(), more.size()));
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += more[i];
    return sum;
  }

 private:
  const TablesInput& input_;
  const gl::Capabilities& capabilities_;
  SceneFeatures features_;
  GpuScene gpuScene_;
  gl::TimeQuery timer_;
  SunFrustum sunFrustum_;
  gl::Buffer frameConstants_;
  std::map<int, ReflectiveShadowMap> maps_;
  std::map<Config, LightPropagationVolume> volumes_;
  std::vector<Config> order_;
  std::map<std::string, std::vector<double>> kept_;
};

/// Reads and writes grids of that size once per step, lit or not: the least work of propagation in all cells.
class Copy {
 public:
  Copy(gl::ProgramLibrary& programs, int cells, int grids, int iterations)
      : iterations_(iterations), cells_(cells * cells * cells * grids) {
    for (int withSum = 0; withSum < 2; ++withSum)
      copy_[static_cast<std::size_t>(withSum)] = &programs.loadCompute(
          withSum ? "bench copy and sum" : "bench copy", "bench/copy_grids.comp", {{"WITH_SUM", withSum}});
    for (gl::BufferTexture& grid : grids_) {
      grid = gl::BufferTexture("bench grids", gl::Format::rgba32f, 3 * 16 * static_cast<std::size_t>(cells_), nullptr,
                               gl::Usage::dynamicCopy);
      grid.clear();
    }
  }

  void run(gl::TimeQuery& timer) const {
    for (std::size_t withSum = 0; withSum < 2; ++withSum) {
      const gl::TimeQuery::Scope stage(timer, withSum ? "copy and sum" : "copy");
      for (int step = 0; step < iterations_; ++step) {
        const gl::ComputePass pass("bench copy", gl::Barrier::textureFetch | gl::Barrier::storage);
        copy_[withSum]->use();
        copy_[withSum]->set("count", cells_);
        grids_[step % 2 ? 1 : 0].bind(0);
        grids_[step % 2 ? 0 : 1].buffer().bindStorage(0);
        grids_[2].bind(1);
        grids_[2].buffer().bindStorage(1);
        pass.dispatch(glm::ivec3(cells_, 1, 1), glm::ivec3(64, 1, 1));
      }
    }
  }

 private:
  int iterations_, cells_;
  std::array<const gl::Program*, 2> copy_{};
  std::array<gl::BufferTexture, 3> grids_;
};

/// Sets one channel of a 32^3 grid to zero, alternating between both methods.
void measureClearing(gl::TimeQuery& timer, bool haveClearTexture, int count) {
  gl::Texture grid("bench cleared", gl::Format::rgba16f, glm::ivec3(32));
  const std::vector<std::uint8_t> zeros(grid.bytes(), 0);
  for (int i = 0; i <= count && !interrupted(); ++i) {
    if (haveClearTexture) {
      const gl::TimeQuery::Scope stage(timer, "glClearTexImage");
      const std::array<const gl::Texture*, 1> all{&grid};
      gl::clearToZero(all, true);
    }
    {
      const gl::TimeQuery::Scope stage(timer, "glTexSubImage3D");
      grid.upload(gl::Texels::rgbaHalf, zeros.data());
    }
    timer.collect();
  }
  timer.drain();
}

std::string spreadText(const std::vector<double>& samples) {
  return fmt::format("{:.3f} ms ({:.3f} .. {:.3f}, {})", median(samples), percentile(samples, 0.05),
                     percentile(samples, 0.95), samples.size());
}

nlohmann::ordered_json samplesJson(const std::vector<double>& samples) {
  return {{"measured", median(samples)},
          {"spread", {percentile(samples, 0.05), percentile(samples, 0.95)}},
          {"count", samples.size()}};
}

/// One way in which a published row is measured.
struct Planned {
  const PublishedRow* row;
  Config config;
  bool first;  // includes the stage of the map, which is the same for all methods
  bool there;
};

/// The measurement, part by part.
struct LpvTables {
  explicit LpvTables(const TablesInput& given) : input(given) {}

  const TablesInput& input;
  const gl::Capabilities& capabilities = input.context.capabilities();
  const bool haveAtomic = capabilities.shaderAtomicFloat || capabilities.shaderAtomicFp16Vector;
  const int frames = std::max(1, static_cast<int>(std::ceil(10.0 * input.scale - 1e-9)));
  const int shrink = input.scale < 0.05 ? 4 : input.scale < 0.5 ? 2 : 1;  // divides the cells a side
  const PublishedRow& usual = kPublishedTimes[1];  // 3 x 32^3, 8 iterations, blocking
  Bench bench{input};
  LpvFill bestFill = LpvFill::layered;
  std::string trialText;
  std::vector<Planned> plan;  // in the order of a round
  std::vector<Config> wanted;  // without duplicates
  Tables tables;

  /// A published row at this scale.
  Config config(const PublishedRow& row, LpvFill fill, LpvPropagate propagate, bool published = false) const {
    return {row.rsmSize, row.cells / shrink, row.grids, row.iterations, row.blocking, fill, propagate, published};
  }
  Config usualPublished() const { return config(usual, LpvFill::layered, LpvPropagate::layered); }

  /// The fastest way to fill here: each is tried with three grids.
  void findBestFill() {
    const Config trial{256, 32 / shrink, 3, 0, false, LpvFill::layered, LpvPropagate::compute};
    std::vector<LpvFill> fills{LpvFill::layered, LpvFill::fixed};
    if (haveAtomic) fills.push_back(LpvFill::atomic);
    const auto trialOf = [&](LpvFill fill) {
      Config result = trial;
      result.fill = fill;
      return result;
    };
    if (input.fill && std::find(fills.begin(), fills.end(), *input.fill) == fills.end())
      throwMissingCapability("--fill {}: this driver has no atomic additions of floats", nameOf(*input.fill));
    if (!input.fill) {
      for (LpvFill fill : fills) bench.add(trialOf(fill));
      for (int round = 0; round <= std::min(frames, 5) && !interrupted(); ++round) bench.runRound();
      bench.timer().drain();
    }
    // The minimum, not the median: other load on the machine only ever adds time.
    const auto fastest = [&](LpvFill fill) { return percentile(bench.injection(trialOf(fill)), 0.0); };
    bestFill = input.fill ? *input.fill : *std::min_element(fills.begin(), fills.end(), [&](LpvFill a, LpvFill b) {
      return fastest(a) < fastest(b);
    });
    for (LpvFill fill : fills)
      if (!input.fill)
        trialText += fmt::format("{}{} {:.2f}", trialText.empty() ? "" : ", ", nameOf(fill), fastest(fill));
    bench.removeVolumes();
    bench.timer().reset();
  }

  void want(const Config& one) {
    if (std::find(wanted.begin(), wanted.end(), one) == wanted.end()) wanted.push_back(one);
  }

  /// The ways in which each published row is measured, adjacent in the order of a round.
  void makePlan() {
    for (const PublishedRow& row : kPublishedTimes) {
      const auto add = [&](LpvFill fill, LpvPropagate propagate, bool first, bool published = false) {
        const bool there = fill != LpvFill::atomic || haveAtomic;
        plan.push_back({&row, config(row, fill, propagate, published), first, there});
        if (there) want(plan.back().config);
      };
      if (row.way != Way::atomics) add(LpvFill::layered, LpvPropagate::layered, true, true);
      if (row.way == Way::anyPath && (row.iterations > 0 || bestFill != LpvFill::layered))
        add(bestFill, LpvPropagate::compute, false);
      if (row.way == Way::atomics) {
        add(LpvFill::atomic, LpvPropagate::layered, true, true);
        add(LpvFill::fixed, LpvPropagate::layered, false, true);
        add(LpvFill::atomic, LpvPropagate::compute, false);
        add(LpvFill::fixed, LpvPropagate::compute, false);
      }
    }
    want(usualPublished());
  }

  /// One unit per configuration, with the map it is filled from; copying and clearing are the last.
  std::vector<std::string> stagesOf(std::size_t unit) const {
    if (unit == wanted.size()) return {"copy", "copy and sum", "glClearTexImage", "glTexSubImage3D"};
    return {rsmStage(wanted[unit].rsmSize), wanted[unit].key() + " injection", wanted[unit].key() + " propagation"};
  }

  /// False: only a part was measured, and the tables are made when it is merged.
  bool measure() {
    const PartFolder part(
        input.part, "bench tables",
        fmt::format(
            "lpv, scene {}, scale {}, fill {}, {} on {}{}",
            measure::keyOf(input.scene, input.scene.cameras.front(), glm::ivec2(0), Transport::all, "tables").name(),
            input.scale, nameOf(bestFill), capabilities.renderer, cpuName(),
            capabilities.clearTexture ? "" : ", no clearing of textures"),
        wanted.size() + 1);
    // Units that a part already has are read from it; the others are measured round by round.
    std::vector<std::size_t> measured;
    for (std::size_t unit = part.first(); unit < part.last(); ++unit) {
      if (const auto kept = part.load(unit)) {
        for (const std::string& stage : stagesOf(unit)) bench.keep(stage, kept->at(stage).get<std::vector<double>>());
        continue;
      }
      measured.push_back(unit);
      if (unit < wanted.size()) bench.add(wanted[unit]);
    }
    const bool copies = !measured.empty() && measured.back() == wanted.size();
    std::optional<Copy> copy;
    if (copies) copy.emplace(input.programs, usual.cells / shrink, usual.grids, usual.iterations);
    Progress progress("bench tables", frames + 1, input.quiet);
    for (int round = 0; round <= frames && !interrupted() && !measured.empty(); ++round) {
      bench.runRound();
      if (copies) copy->run(bench.timer());
      if (round == 0) bench.timer().reset();  // the warm-up
      progress.update(round + 1);
    }
    bench.timer().drain();
    const int clears = std::max(10, static_cast<int>(std::lround(100.0 * input.scale)));
    if (copies) measureClearing(bench.timer(), capabilities.clearTexture, clears);
    if (!interrupted()) {
      for (const std::size_t unit : measured) {
        PartFolder::Json samples;
        for (const std::string& stage : stagesOf(unit)) samples[stage] = bench.samples(stage);
        part.store(unit, samples);
      }
      part.finish();
    }
    if (part.isPart()) tables.json["rows_here"] = part.last() - part.first();
    return !part.isPart();
  }

  /// How to read the tables.
  void explain() {
    tables.notes = {
        fmt::format(
            "Scale    {}: {} frame{} a figure after one of warm-up{}", input.scale, frames, frames > 1 ? "s" : "",
            shrink == 1
                ? ""
                : fmt::format("; grids of {}^3 where 32^3 was published, {}^3 for 64^3", 32 / shrink, 64 / shrink)),
        fmt::format("Clock    {}", capabilities.softwareRenderer ? "wall clock between glFinish (software renderer)"
                                                                 : "GL_TIME_ELAPSED"),
        fmt::format("Paths    fill/propagate; layered/layered as published (the text's steps, formats and cell sizes, "
                    "nothing joined), {}/compute {}",
                    nameOf(bestFill),
                    input.fill ? "as asked for by --fill"
                               : fmt::format("the fastest here (filling 3 grids, least of {}: {} ms)",
                                             std::min(frames, 5), trialText)),
        "Stages   injection has the geometry volume's in it where there is blocking, propagation the joining of "
        "several "
        "grids (ours; the text joins none)",
        "Atomics  atomic (floats, an extension) and fixed (integers, core): one a light and channel as published, "
        "propagated by layered passes; 'tiles' are ours: one a run of texels in the same cell, propagated by a compute "
        "shader"};
    if (input.scene.triangleCount() != 262267)
      tables.notes.push_back(
          "Scene    not the published one: that is Crytek Sponza (262,267 triangles), no part of this repository; give "
          "its OBJ as SCENE");
  }

  /// One row for each published number and method.
  void addRows() {
    for (const Planned& planned : plan) {
      const PublishedRow& row = *planned.row;
      const auto add = [&](const char* stage, double nvidia, double amd, const std::vector<double>& samples,
                           bool usesFill, bool usesPropagate) {
        if (nvidia == 0.0) return;
        Row result;
        result.table = row.table;
        result.setting = row.setting;
        result.stage = stage;
        result.grids = row.grids;
        result.published.push_back({kNvidia, nvidia});
        if (amd > 0.0) result.published.push_back({kAmd, amd});
        if (usesFill) result.fill = planned.config.fillName();
        if (usesPropagate) result.propagate = nameOf(planned.config.propagate);
        result.samples = samples;
        if (!planned.there) result.missing = "NV_shader_atomic_float";
        tables.rows.push_back(std::move(result));
      };
      if (planned.first) add("RSM", row.nvidia.rsm, row.amd.rsm, bench.samples(rsmStage(row.rsmSize)), false, false);
      add("injection", row.nvidia.injection, row.amd.injection, bench.injection(planned.config), true, true);
      add("propagation", row.nvidia.propagation, row.amd.propagation, bench.propagation(planned.config), true, true);
    }
  }

  void addClearing() {
    for (const auto& [name, ms] :
         {std::pair("glClearTexImage", kClearTexImage), std::pair("glTexSubImage3D", kTexSubImage)}) {
      Row row;
      row.table = "clear";
      row.setting = "one channel of a 32^3 grid";
      row.stage = name;
      row.published.push_back({"as published", ms});
      row.samples = bench.samples(name);
      row.isMean = true;
      if (std::string(name) == "glClearTexImage" && !capabilities.clearTexture) row.missing = "ARB_clear_texture";
      tables.rows.push_back(std::move(row));
    }
  }

  void summarize() {
    const Config best = config(usual, bestFill, LpvPropagate::compute);
    const std::vector<double> publishedTotal = bench.total(usualPublished()), bestTotal = bench.total(best);
    const std::vector<double>&copied = bench.samples("copy"), &copiedAndSummed = bench.samples("copy and sum");
    const double propagation = median(bench.propagation(best));
    const std::string paths = fmt::format("{}/compute", nameOf(bestFill));
    tables.summary = fmt::format(
        "Speed: injection, geometry volume and propagation together; {} x {}^3, 8 iterations, RSM 256, our settings, "
        "same answer\n"
        "  layered/layered   {}\n  {:<18}{}\n  {:.2f} times as fast\n"
        "Bound: propagation, {}: {}\n"
        "  reading and writing the grids once an iteration     {}: {:.2f} of it\n"
        "  the same, with the sum that they are added to       {}: {:.2f} of it\n",
        usual.grids, usual.cells / shrink, spreadText(publishedTotal), paths, spreadText(bestTotal),
        median(publishedTotal) / median(bestTotal), paths, spreadText(bench.propagation(best)), spreadText(copied),
        propagation / median(copied), spreadText(copiedAndSummed), propagation / median(copiedAndSummed));
    tables.json["frames"] = frames;
    tables.json["speed"] = {
        {"cells", usual.cells / shrink},           {"grids", usual.grids},
        {"iterations", usual.iterations},          {"rsm", usual.rsmSize},
        {"best_fill", nameOf(bestFill)},           {"published_paths_ms", samplesJson(publishedTotal)},
        {"best_paths_ms", samplesJson(bestTotal)}, {"speedup", median(publishedTotal) / median(bestTotal)}};
    tables.json["bound"] = {{"propagation_ms", samplesJson(bench.propagation(best))},
                            {"copy_ms", samplesJson(copied)},
                            {"copy_and_sum_ms", samplesJson(copiedAndSummed)},
                            {"over_copy", propagation / median(copied)},
                            {"over_copy_and_sum", propagation / median(copiedAndSummed)}};
  }
};

}  // namespace

Tables measureLpvTables(const TablesInput& input) {
  LpvTables all(input);
  all.findBestFill();
  all.makePlan();
  if (!all.measure()) return all.tables;
  all.explain();
  all.addRows();
  all.addClearing();
  all.summarize();
  return all.tables;
}

}  // namespace lucerna::demo::bench
