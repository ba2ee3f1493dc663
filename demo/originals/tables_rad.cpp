// lucerna bench tables --original rad: the published program's times on model 2, and the cost of each of its
// deviations.
//
// A whole published run takes minutes to days. Here hemicubes of triangles spread evenly over the scene are drawn for a
// while, and the time of a run of 7 sweeps, as published, is extrapolated from their rate: every hemicube costs the
// same, since every view draws the whole scene.
#include "base/provenance.hpp"
#include "originals/rad.hpp"

#include "base/clock.hpp"
#include "base/error.hpp"
#include "radiosity/form_factor_matrix.hpp"
#include "radiosity/hemicubes.hpp"
#include "radiosity/original/rad_models.hpp"
#include "radiosity/original/solver.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <ctime>
#include <functional>
#include <optional>

namespace lucerna::demo::bench {

namespace {

constexpr int kSweeps = 7;
constexpr const char* kPublishedOn = "GeForce 7600GT";
constexpr const char* kPublishedMachine = "Athlon X2 4600+, 2 GB, nVidia GeForce 7600GT with 256 MB (4.1)";

// [RAD2008 tables 4.1 and 4.2]: minutes for a whole run, seconds per triangle.
struct Published {
  double threshold;
  int triangles;
  std::array<double, 3> minutes, secondsATriangle;  // at 100, 200 and 500 pixels
};
constexpr std::array kPublishedSolutions{
    Published{5.0, 26360, {4.0 + 40.0 / 60.0, 8.75, 39.0 + 40.0 / 60.0}, {0.011, 0.020, 0.091}},
    Published{1.0, 136512, {58.0 + 20.0 / 60.0, 81.0 + 40.0 / 60.0, 233.0}, {0.026, 0.036, 0.102}},
    Published{0.25, 546048, {583.0, 700.0, 1516.0}, {0.064, 0.077, 0.166}}};
constexpr std::array kViews{100, 200, 500};

struct Rate {
  std::size_t hemicubes = 0, triangles = 0;
  double seconds = 0.0;
  double hemicubesASecond() const { return static_cast<double>(hemicubes) / seconds; }
  double mtrianglesASecond() const { return static_cast<double>(triangles) / seconds / 1e6; }
};

Rate measure(gl::ProgramLibrary& programs, std::span<const RadTriangle> triangles, int view, std::size_t most,
             double mostSeconds) {
  OriginalRadiosity::Settings settings;
  settings.view = view;
  OriginalRadiosity solver(programs, triangles, settings);
  solver.gather(0);  // warm-up
  const std::size_t warm = solver.hemicubes(), warmTriangles = solver.drawnTriangles();
  const auto start = Clock::now();
  for (std::size_t i = 0; i < most && !interrupted(); ++i) {
    solver.gather((2 * i + 1) * triangles.size() / (2 * most));
    if (i >= 3 && secondsSince(start) > mostSeconds) break;
  }
  return {solver.hemicubes() - warm, solver.drawnTriangles() - warmTriangles, secondsSince(start)};
}

/// Sweeps until the published solver stops changing, with the numbers of the manual's example; empty if interrupted.
std::optional<std::uint32_t> sweepsToRest(gl::ProgramLibrary& programs, std::span<const RadTriangle> triangles,
                                          int view, bool quiet) {
  OriginalRadiosity::Settings settings;
  settings.view = view;
  OriginalRadiosity solver(programs, triangles, settings);
  OriginalProgress progress = solver.start();
  do {
    Progress bar(fmt::format("sweep {}", progress.sweeps + 1), static_cast<int>(triangles.size()), quiet);
    const auto goOn = [&](const OriginalProgress& now) {
      bar.update(static_cast<int>(now.done));
      return !interrupted();
    };
    if (!solver.sweep(progress, goOn)) return std::nullopt;
  } while (progress.change > 0.0 && progress.sweeps < 100);
  return progress.sweeps;
}

struct Cost {
  std::string name;
  double nrmse = 0.0, most = 0.0, bias = 0.0;
};

/// The lit cube as published, with one deviation turned off, and with all but the centroid off, each compared with the
/// last one at four times the pixels.
std::vector<Cost> deviationCosts(gl::ProgramLibrary& programs, int view, bool quiet) {
  const std::vector<RadTriangle> cube = makeRadModel(1, {20.0, 0.5, 100000});
  Progress bar("deviations", 8, quiet);
  int done = 0;
  const auto solve = [&](const RadiosityDeviations& deviations, int pixels) {
    OriginalRadiosity::Settings settings;
    settings.view = pixels;
    settings.gaussSeidel = true;
    settings.deviations = deviations;
    OriginalRadiosity solver(programs, cube, settings);
    OriginalProgress progress = solver.start();
    for (int sweep = 0; sweep < 6 && !interrupted(); ++sweep)
      solver.sweep(progress, [](const OriginalProgress&) { return !interrupted(); });
    bar.update(++done);
    return progress.received;
  };
  RadiosityDeviations right;
  right.centroid = true;  // keep the receiving points the same
  const std::vector<float> reference = solve(right, 4 * view);
  const auto costOf = [&](const std::string& name, const RadiosityDeviations& deviations) {
    const std::vector<float> received = solve(deviations, view);
    double squares = 0.0, sum = 0.0, area = 0.0, difference = 0.0;
    Cost cost;
    cost.name = name;
    for (std::size_t i = 0; i < cube.size(); ++i) {
      const double a = areaOf(cube[i]), is = static_cast<double>(reference[i]),
                   error = static_cast<double>(received[i]) - is;
      squares += a * error * error, sum += a * is, difference += a * error, area += a;
      cost.most = std::max(cost.most, std::abs(error) / is);
    }
    cost.nrmse = std::sqrt(squares / area) / (sum / area);
    cost.bias = difference / sum;
    return cost;
  };
  std::vector<Cost> costs{costOf("as published", publishedRadiosity())};
  for (const RadiosityDeviation& deviation : allRadiosityDeviations()) {
    RadiosityDeviations one = publishedRadiosity();
    one.*deviation.member = false;
    costs.push_back(costOf(fmt::format("{}=off", deviation.name), one));
  }
  costs.push_back(costOf("all off but radiosity.centroid", right));
  return costs;
}

/// A closed box of 12 n n triangles, a lamp in its ceiling.
Scene closedBox(int n) {
  Scene scene;
  for (const float emission : {0.0f, 1.0f}) {
    Material& material = scene.materials.emplace_back();
    material.diffuse = glm::vec3(0.5f);
    material.emission = glm::vec3(emission);
  }
  std::array<std::vector<std::uint32_t>, 2> indices;
  for (int wall = 0; wall < 6; ++wall) {
    const int axis = wall / 2;
    glm::vec3 normal(0.0f), u(0.0f), v(0.0f);
    normal[axis] = wall % 2 ? -1.0f : 1.0f;
    u[(axis + 1) % 3] = 1.0f;
    v[(axis + 2) % 3] = wall % 2 ? -1.0f : 1.0f;
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        const auto first = static_cast<std::uint32_t>(scene.vertices.size());
        for (const glm::vec2& corner : {glm::vec2(0, 0), glm::vec2(1, 0), glm::vec2(1, 1), glm::vec2(0, 1)}) {
          const glm::vec2 at = (glm::vec2(i, j) + corner) / static_cast<float>(n) - 0.5f;
          scene.vertices.push_back({-0.5f * normal + at.x * u + at.y * v, {}, normal});
          scene.bounds.add(glm::dvec3(scene.vertices.back().position));
        }
        const bool lamp = wall == 3 && std::max(std::abs(2 * i + 1 - n), std::abs(2 * j + 1 - n)) * 4 < n;
        for (const std::uint32_t k : {0u, 1u, 2u, 0u, 2u, 3u}) indices[lamp].push_back(first + k);
      }
  }
  for (std::size_t k = 0; k < 2; ++k) {
    Mesh& mesh = scene.meshes.emplace_back();
    mesh.material = static_cast<int>(k);
    mesh.firstIndex = static_cast<std::uint32_t>(scene.indices.size());
    mesh.indexCount = static_cast<std::uint32_t>(indices[k].size());
    scene.indices.insert(scene.indices.end(), indices[k].begin(), indices[k].end());
  }
  return scene;
}

/// The units of these tables in order: each is read from where it is stored, or computed and stored.
class Units {
 public:
  Units(const PartOptions& options, const std::string& identity, std::size_t count)
      : part_(options, "bench tables", identity, count) {}
  /// Empty if the next unit belongs to another part, or the work was interrupted.
  std::optional<PartFolder::Json> next(const std::function<PartFolder::Json()>& make) {
    const std::size_t unit = next_++;
    if (unit < part_.first() || unit >= part_.last() || interrupted()) return std::nullopt;
    if (auto kept = part_.load(unit)) return kept;
    PartFolder::Json made = make();
    if (interrupted()) return std::nullopt;
    part_.store(unit, made);
    return made;
  }
  const PartFolder& part() const { return part_; }

 private:
  PartFolder part_;
  std::size_t next_ = 0;
};

/// Squares per side of each wall: boxes of 2,028 and 25,392 triangles.
constexpr std::array kBoxes{13, 46};

template <class... Values>
void say(bool prints, fmt::format_string<Values...> format, Values&&... values) {
  if (!prints) return;
  fmt::print(format, std::forward<Values>(values)...);
  std::fflush(stdout);
}

/// Hemicubes per second of the corrected solver: the whole stage, with rows computed, sorted and stored. Median,
/// minimum and maximum of five runs.
PartFolder::Json closedBox(const gl::Context& context, gl::ProgramLibrary& programs, double scale, int squares,
                           HemicubeVisibility way) {
  PatchSettings whole;
  whole.longestEdge = 0.0;
  const RadiosityMesh mesh = makePatches(closedBox(squares), whole);
  HemicubeSettings settings;
  settings.visibility = way;
  Hemicubes hemicubes(programs, context.capabilities(), mesh, settings);
  const int count = std::min(hemicubes.patchCount(), std::max(16, static_cast<int>(2000.0 * scale)));
  hemicubes.rows(0, std::min(count, hemicubes.batchSize()));
  std::vector<double> rates;
  const std::clock_t processor = std::clock();
  for (int run = 0; run < 5; ++run) {
    FormFactorMatrix matrix;
    const int first = static_cast<int>(static_cast<std::int64_t>(hemicubes.patchCount() - count) * run / 4);
    const auto start = Clock::now();
    hemicubes.stream(first, first + count, [&](const FormFactorRows& rows) {
      std::size_t at = 0;
      for (const std::uint32_t entries : rows.counts) {
        matrix.appendRow(std::span(rows.patches).subspan(at, entries), std::span(rows.factors).subspan(at, entries));
        at += entries;
      }
    });
    rates.push_back(count / secondsSince(start));
  }
  const double milliseconds = 1000.0 * static_cast<double>(std::clock() - processor) / CLOCKS_PER_SEC / (5.0 * count);
  std::sort(rates.begin(), rates.end());
  return {{"triangles", hemicubes.patchCount()},
          {"view", settings.resolution},
          {"visibility", nameOf(way)},
          {"hemicubes", count},
          {"hemicubes_per_s", rates[2]},
          {"least", rates[0]},
          {"most", rates[4]},
          {"processor_ms", milliseconds},
          {"renderer", context.capabilities().renderer}};
}

constexpr std::array kWays{HemicubeVisibility::raster, HemicubeVisibility::rays, HemicubeVisibility::itemBuffer};

void closedBoxes(const gl::Context& context, gl::ProgramLibrary& programs, double scale, nlohmann::ordered_json& json,
                 bool prints, Units& units) {
  say(prints,
      "\nCorrected: hemicubes/s in a closed box, 64x64, near pairs and closed forms included; 5 "
      "runs\n{:<24}{:<14}{:>10}{:>10}{:>10}{:>12}\n",
      "", "", "median", "least", "most", "CPU ms each");
  for (const int squares : kBoxes)
    for (const HemicubeVisibility way : kWays) {
      const auto box = units.next([&] { return closedBox(context, programs, scale, squares, way); });
      if (!box) continue;
      say(prints, "{:<24}{:<14}{:>10.0f}{:>10.0f}{:>10.0f}{:>12.3f}\n",
          fmt::format("{} triangles", box->at("triangles").get<int>()), box->at("visibility").get<std::string>(),
          box->at("hemicubes_per_s").get<double>(), box->at("least").get<double>(), box->at("most").get<double>(),
          box->at("processor_ms").get<double>());
      json["closed_box"].push_back(*box);
    }
}

}  // namespace

nlohmann::ordered_json measureRadTables(const gl::Context& context, gl::ProgramLibrary& programs, double scale,
                                        bool quiet, bool prints, const PartOptions& part) {
  // The configurations at this scale.
  const std::string& renderer = context.capabilities().renderer;
  const auto most = static_cast<std::size_t>(std::max(4.0, std::round(400.0 * scale)));
  const double mostSeconds = std::max(1.0, 40.0 * scale);

  Units units(part, fmt::format("rad, scale {}, {} on {}", scale, renderer, cpuName()),
              kPublishedSolutions.size() * kViews.size() + 2 + kBoxes.size() * kWays.size());
  nlohmann::ordered_json json;
  const std::vector<std::string> notes{
      fmt::format("Published on {}", kPublishedMachine), fmt::format("Here     on {}", renderer),
      fmt::format("Scale    {}: at most {} hemicubes or {:.0f} s a figure, of triangles spread evenly over the scene",
                  scale, most, mostSeconds),
      fmt::format("Whole    not run: {} sweeps over all triangles, computed from the rate (extrapolated); published "
                  "are whole runs of {} sweeps",
                  kSweeps, kSweeps),
      "Scene    model 2; its measures are ours, its numbers of triangles within 2 % of the published"};
  json["notes"] = notes;
  for (const std::string& note : notes) say(prints, "{}\n", note);

  // Each published model at each view size: the rate, and the extrapolated total.
  say(prints, "\nTables 4.1 and 4.2\n{:<28}{:>14}{:>14}{:>9}{:>14}{:>14}{:>13}{:>14}\n", "", "whole, min", "here, min",
      "ratio", "s a triangle", "here, s", "hemicubes/s", "Mtriangles/s");
  json["rows"] = nlohmann::ordered_json::array();
  for (const Published& published : kPublishedSolutions) {
    if (interrupted()) break;
    RadModelSettings model;
    model.areaThreshold = published.threshold;
    std::vector<RadTriangle> triangles;  // generated when measured
    for (std::size_t v = 0; v < kViews.size() && !interrupted(); ++v) {
      const auto kept = units.next([&] {
        if (triangles.empty()) triangles = makeRadModel(2, model);
        const Rate rate = measure(programs, triangles, kViews[v], most, mostSeconds);
        return PartFolder::Json{{"model_triangles", triangles.size()},
                                {"hemicubes", rate.hemicubes},
                                {"triangles", rate.triangles},
                                {"seconds", rate.seconds}};
      });
      if (!kept) continue;
      const Rate rate{kept->at("hemicubes").get<std::size_t>(), kept->at("triangles").get<std::size_t>(),
                      kept->at("seconds").get<double>()};
      const auto modelTriangles = kept->at("model_triangles").get<std::size_t>();
      const double secondsATriangle = kSweeps / rate.hemicubesASecond(),
                   minutes = secondsATriangle * static_cast<double>(modelTriangles) / 60.0;
      const std::string name = fmt::format("{}x{}, {} triangles", kViews[v], kViews[v], published.triangles);
      say(prints, "{:<28}{:>14.2f}{:>14.2f}{:>9.3g}{:>14.3f}{:>14.4f}{:>13.1f}{:>14.2f}\n", name, published.minutes[v],
          minutes, minutes / published.minutes[v], published.secondsATriangle[v], secondsATriangle,
          rate.hemicubesASecond(), rate.mtrianglesASecond());
      for (const bool whole : {true, false}) {
        nlohmann::ordered_json row;
        row["table"] = whole ? "4.1" : "4.2";
        row["row"] = name;
        row["published"] = whole ? published.minutes[v] : published.secondsATriangle[v];
        row["measured"] = whole ? minutes : secondsATriangle;
        row["ratio"] = row["measured"].get<double>() / row["published"].get<double>();
        row["unit"] = whole ? "min" : "s";
        row["renderer"] = renderer;
        row["published_on"] = kPublishedOn;
        row["triangles"] = modelTriangles;
        row["view"] = kViews[v];
        row["sweeps"] = kSweeps;
        row["extrapolated"] = true;
        row["hemicubes"] = rate.hemicubes;
        row["hemicubes_per_s"] = rate.hemicubesASecond();
        row["mtriangles_per_s"] = rate.mtrianglesASecond();
        json["rows"].push_back(std::move(row));
      }
    }
  }

  // Model 2 at its coarsest; one of the others if even that is too much.
  const bool hall = scale >= 0.5;
  RadModelSettings model;
  model.areaThreshold = hall ? 100.0 : 30.0;
  const auto rest = units.next([&] {
    const std::vector<RadTriangle> coarse = makeRadModel(hall ? 2 : 3, model);
    const auto sweeps = sweepsToRest(programs, coarse, 32, quiet);
    return PartFolder::Json{{"triangles", coarse.size()}, {"sweeps", sweeps.value_or(0)}};
  });
  if (rest) {
    const auto sweeps = rest->at("sweeps").get<std::uint32_t>();
    const auto count = rest->at("triangles").get<std::size_t>();
    say(prints,
        "\nSweeps   {} until nothing changes (model {}, {} triangles, 32x32, reflectance 0.15, power 100000); "
        "published {} (model 2)\n",
        sweeps, hall ? 2 : 3, count, kSweeps);
    json["rows"].push_back({{"table", "4.1"},
                            {"row", fmt::format("sweeps, model {}, {} triangles", hall ? 2 : 3, count)},
                            {"published", kSweeps},
                            {"measured", sweeps},
                            {"ratio", sweeps / static_cast<double>(kSweeps)},
                            {"unit", "sweeps"},
                            {"renderer", renderer}});
  }

  const int view = scale >= 0.5 ? 100 : scale >= 0.1 ? 64 : 32;
  const auto costs = units.next([&] {
    PartFolder::Json list = PartFolder::Json::array();
    for (const Cost& cost : deviationCosts(programs, view, quiet))
      list.push_back({{"name", cost.name}, {"nrmse", cost.nrmse}, {"worst", cost.most}, {"bias", cost.bias}});
    return list;
  });
  if (costs) {
    say(prints,
        "\nDeviations: model 1, threshold 20, reflectance 0.5, {}x{}; against floats, exact map, random roll at {}x{} "
        "and the same points\n{:<32}{:>10}{:>10}{:>10}\n",
        view, view, 4 * view, 4 * view, "", "NRMSE %", "worst %", "bias %");
    for (const auto& cost : *costs)
      say(prints, "{:<32}{:>10.2f}{:>10.2f}{:>+10.2f}\n", cost.at("name").get<std::string>(),
          100.0 * cost.at("nrmse").get<double>(), 100.0 * cost.at("worst").get<double>(),
          100.0 * cost.at("bias").get<double>());
    json["deviations"] = *costs;
    say(prints,
        "radiosity.centroid=off samples three corners; those on another wall see it edge on and lose its light\n");
  }
  if (!interrupted()) closedBoxes(context, programs, scale, json, prints, units);
  if (!interrupted()) units.part().finish();
  if (units.part().isPart()) json["rows_here"] = units.part().last() - units.part().first();
  return json;
}

int runRadTables(const CommonOptions& common, double scale, const PartOptions& part) {
  const auto host = common.makeHost(false);
  const gl::Context context;
  gl::ProgramLibrary programs;
  watchForInterrupt();
  nlohmann::ordered_json json;
  json["renderer"] = context.capabilities().renderer;
  json["host"] = nameOf(host->kind());
  json["original"] = "rad";
  json["scale"] = scale;
  const nlohmann::ordered_json tables = measureRadTables(context, programs, scale, common.quiet, !part.isPart(), part);
  if (part.isPart()) {
    if (!common.quiet) fmt::print("{}: {} rows\n", part.checkpoint, tables.at("rows_here").dump());
    common.writeJson({{"part", part.part}, {"rows", tables.at("rows_here")}});
    return exitCode();
  }
  json.update(tables);
  common.writeJson(json);
  return exitCode();
}

}  // namespace lucerna::demo::bench
