// lucerna bench all --out DIR: the whole report on one page, with an index: error, deviations, stability, features,
// rays, and the three originals' tables and pictures.
#include "base/clock.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "bench/bench.hpp"
#include "bench/error_bench.hpp"
#include "originals/lpv_pictures.hpp"
#include "bench/features_bench.hpp"
#include "originals/rad.hpp"
#include "bench/rays_bench.hpp"
#include "bench/stability.hpp"
#include "shared/completions.hpp"
#include "shared/parts.hpp"

#include <fmt/core.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace lucerna::demo {

namespace bench {

namespace {

namespace fs = std::filesystem;

struct AllOptions {
  CommonOptions common;
  std::string out;
  double scale = 0.25;
  std::vector<std::string> scenes;  ///< for error, features and rays; empty: Cornell and atrium
  std::vector<std::string> parts;  ///< empty: all
};

constexpr const char* kParts[] = {"error", "deviations", "stability", "features", "rays", "tables", "pictures"};

/// Scales for --scale, so that the originals' own sizes finish in minutes on a software renderer.
constexpr double kVptTables = 0.04, kVptPictures = 0.01, kRadTables = 0.2, kRadPictures = 0.2;
constexpr glm::ivec2 kSheetTile{160, 90};

/// "WxH" with about 160x90 pixels at scale 1.
std::string sizeOf(double scale) {
  const int width = std::max(32, 16 * static_cast<int>(std::lround(20.0 * std::sqrt(scale))));
  return fmt::format("{}x{}", width, width * 9 / 16);
}

class Report {
 public:
  Report(const AllOptions& options, const gl::Context& context, const std::string& host)
      : options_(options), context_(context), host_(host), page_("Lucerna: measurements") {
    page_.preformatted(fmt::format("Renderer {}\nHost     {}, {}\nScale    {}; pictures {}\n",
                                   context.capabilities().renderer, host, cpuName(), options.scale,
                                   sizeOf(options.scale)));
  }

  void errors(const std::string& file, bool deviations) {
    const Scene scene = loadScene(file);
    gl::ProgramLibrary programs;
    ErrorBenchOptions options;
    options.scene = file;
    options.size = sizeOf(options_.scale);
    options.out =
        (fs::path(options_.out) / fmt::format("{}-{}", deviations ? "deviations" : "error", scene.name)).string();
    options.budget = 240.0 * options_.scale;
    options.small = options_.scale < 0.5;
    options.deviations = deviations;
    options.frames = 3;
    options.quiet = options_.common.quiet;
    const auto result = runErrorBench(context_, programs, scene, options, host_);
    if (!result->complete) return;
    HtmlPage part("");
    addToPage(part, options.out, result->report,
              kPageBytes / (options_.scenes.size() + 1));  // the scenes, and a study of deviations
    page_.append(part);
    json_[deviations ? "deviations" : "error"].push_back(errorBenchJson(*result, options));
  }

  void stability() {
    gl::ProgramLibrary programs;
    const std::vector<StabilityRow> rows = runStability({context_, programs}, "", options_.common.quiet, {});
    page_.section("Stability");
    HtmlPage::Table table{{"technique", "case", "parameter", "expected", "measured", "verdict"}, {}, {}};
    int failed = 0;
    for (const StabilityRow& row : rows) {
      table.rows.push_back({row.technique, row.name, row.parameter, expectedText(row.measurement),
                            fmt::format("{:.7g}", row.measurement.measured), row.passed ? "pass" : "FAIL " + row.note});
      table.marked.push_back(!row.passed);
      failed += !row.passed;
    }
    page_.paragraph(fmt::format("{} rows, {} failed (marked).", rows.size(), failed));
    page_.table(table);
    json_["stability"] = stabilityJson(rows);
  }

  void features(const std::vector<std::string>& files) {
    page_.section("Features that scenes do not need");
    HtmlPage::Table table{
        {"scene", "left out", "compile ms", "GPU MiB", "ms a picture", "largest pixel difference"}, {}, {}};
    for (const std::string& file : files) {
      const Scene scene = loadScene(file);
      RenderSettings settings;
      settings.size = parseSize(sizeOf(options_.scale));
      const FeaturesResult r = measureFeatures(context_, scene, scene.cameras.front(), settings, 3);
      std::string names;
      for (const std::string& name : r.leftOut) names += (names.empty() ? "" : ", ") + name;
      const auto both = [](double with, double without) {
        return fmt::format("{:.1f} instead of {:.1f}", without, with);
      };
      table.rows.push_back(
          {r.scene, names, both(r.with.compileMs, r.without.compileMs),
           both(static_cast<double>(r.with.gpuBytes) / 1048576.0, static_cast<double>(r.without.gpuBytes) / 1048576.0),
           both(r.with.ms, r.without.ms), fmt::format("{:.2g} of {:.2g}", r.maxDifference, r.maxRadiance)});
      json_["features"].push_back(featuresJson(r));
    }
    page_.paragraph(
        "Features the scene does not need are left out, compared with being forced on with data that change nothing.");
    page_.table(table);
  }

  /// The published tables of all three originals; VPT's with the published estimator and the corrected one next to it.
  void tables(const std::string& file) {
    gl::ProgramLibrary programs;
    page_.section("Published tables, measured again");
    const double scale = std::min(1.0, options_.scale);
    const Scene scene = loadScene(file);
    add("Light propagation volumes, on " + scene.name,
        measureLpvTables({context_, programs, scene, scale, options_.common.quiet}), "lpv");
    if (interrupted()) return;
    add("Participating media",
        measureVptTables({context_, programs, kVptTables * scale, options_.common.quiet, Fidelity::original}), "vpt");
    if (interrupted()) return;
    const nlohmann::ordered_json rad =
        measureRadTables(context_, programs, kRadTables * scale, options_.common.quiet, false);
    page_.heading("Radiosity");
    HtmlPage::Table table{{"table", "row", "published", "here", "unit", "here / published"}, {}, {}};
    for (const auto& row : rad.at("rows"))
      table.rows.push_back({row.at("table").get<std::string>(), row.at("row").get<std::string>(),
                            fmt::format("{:.4g}", row.at("published").get<double>()),
                            fmt::format("{:.4g}", row.at("measured").get<double>()), row.at("unit").get<std::string>(),
                            fmt::format("{:.3g}", row.at("ratio").get<double>())});
    std::string notes;
    for (const auto& note : rad.at("notes")) notes += note.get<std::string>() + "\n";
    page_.preformatted(notes);
    page_.table(table);
    json_["tables"]["rad"] = rad;
  }

  /// The published pictures of all three, one sheet each, stored in the report's folder too.
  void pictures(const std::string& file) {
    gl::ProgramLibrary programs;
    page_.section("Published pictures, reproduced");
    const double scale = std::min(1.0, options_.scale);
    const auto keep = [&](const char* name, const char* caption, const VptSheet& sheet) {
      if (interrupted()) return;
      const fs::path png = fs::path(options_.out) / (std::string("pictures-") + name + ".png");
      writePng(png, sheet.sheet);
      page_.pictures({{png, caption}});
      json_["pictures"][name] = sheet.json;
    };
    const Scene scene = loadScene(file);
    RenderSettings usual;
    usual.technique = "lpv";
    applyFidelity(usual, Fidelity::original);
    usual.size = kSheetTile;
    keep("lpv", "Light propagation volumes as published",
         drawLpvPictures(
             {context_, programs, scene, scene.cameras.front(), usual, "original", {}, options_.common.quiet}));
    if (!interrupted())
      keep("vpt", "Participating media as published, next to the corrected estimator",
           drawVptPictures({context_, programs, kVptPictures * scale, options_.common.quiet, Fidelity::original},
                           kSheetTile, {}));
    if (!interrupted())
      keep("rad", "Radiosity as published",
           drawRadPictures(programs, kSheetTile, kRadPictures * scale, options_.common.quiet));
    if (!interrupted())
      keep("rad-progressive", "Progressive refinement beside Jacobi and Gauss-Seidel",
           drawProgressivePictures(context_, programs, kSheetTile, scale, options_.common.quiet));
  }

  void rays(const std::vector<std::string>& files) {
    gl::ProgramLibrary programs;
    RaysOptions options;
    options.rays = std::clamp(static_cast<int>(options.rays * options_.scale), 1024, 1 << 22);
    options.repeats = 5;
    page_.section("Rays per second");
    HtmlPage::Table table{{"scene", "rays", "million rays a second", "Embree's", "ratio", "nodes a ray",
                           "triangles a ray", "answers that differ"},
                          {},
                          {}};
    for (const std::string& file : files) {
      const Scene scene = loadScene(file);
      const RaysResult result = measureRays(context_, programs, scene, options, options_.common.quiet);
      const auto figure = [](const nlohmann::ordered_json& row, const char* key, const char* format) {
        const auto& value = row.at(key);
        return value.is_number() ? fmt::format(fmt::runtime(format), value.get<double>()) : std::string("not here");
      };
      for (const auto& row : result.json.at("rows"))
        table.rows.push_back({scene.name, row.at("rays").get<std::string>(), figure(row, "mrays_per_s", "{:.3f}"),
                              figure(row, "embree_mrays_per_s", "{:.3f}"), figure(row, "ratio", "{:.3f}"),
                              figure(row, "nodes_per_ray", "{:.1f}"), figure(row, "triangles_per_ray", "{:.1f}"),
                              fmt::format("{} of {}", row.at("differ").dump(), row.at("count").dump())});
      json_["rays"].push_back(result.json);
    }
    page_.paragraph(fmt::format(
        "The compute-shader hierarchy compared with Embree's single rays on the same {} rays of each kind, in "
        "turn, medians of {}; both use all of this machine's cores.",
        options.rays, options.repeats));
    page_.table(table);
  }

  /// Rows with the published values next to them.
  void add(const std::string& heading, const Tables& tables, const char* key) {
    page_.heading(heading);
    HtmlPage::Table table{{"table", "row", "published ms", "here ms", "here / published"}, {}, {}};
    for (const Row& row : tables.rows)
      for (const Row::Published& published : row.published)
        table.rows.push_back({row.table, row.name() + ", " + published.gpu, fmt::format("{:.4g}", published.ms),
                              fmt::format("{:.4g}", row.measured()),
                              fmt::format("{:.3g}", row.measured() / published.ms)});
    std::string notes;
    for (const std::string& note : tables.notes) notes += note + "\n";
    page_.preformatted(notes + tables.summary);
    page_.table(table);
    json_["tables"][key] = tables.json;
  }

  void missing(const char* part, const std::string& why) {
    page_.section(part);
    page_.paragraph("Not here: " + why);
    json_["missing"].push_back({{"part", part}, {"why", why}});
  }

  void write(double seconds) {
    page_.paragraph(fmt::format("The whole report took {:.0f} s.", seconds));
    writeFileAtomically(fs::path(options_.out) / "index.html", page_.text());
  }
  nlohmann::ordered_json& json() { return json_; }

 private:
  const AllOptions& options_;
  const gl::Context& context_;
  std::string host_;
  HtmlPage page_;
  nlohmann::ordered_json json_;
};

int runAll(AllOptions options) {
  options.common.apply();
  if (!(options.scale > 0.0 && options.scale <= 4.0))
    throwBadInput("--scale {}: expected a number above 0, at most 4", options.scale);
  for (const std::string& name : options.parts)
    if (std::find(std::begin(kParts), std::end(kParts), name) == std::end(kParts))
      throwBadInput("--parts {}: unknown; expected one of {}", name, fmt::join(kParts, ", "));
  std::error_code error;
  fs::create_directories(options.out, error);
  if (error || !fs::is_directory(options.out))
    throwBadInput("--out {}: cannot create folder ({})", options.out,
                  error ? error.message() : "a file of that name exists");
  const std::string originals = sceneOrAtrium(
      options.scenes.empty() ? "" : options.scenes.front());  // what has a scene of its own is made on that
  if (options.scenes.empty()) options.scenes = {asset("cornell/cornell.json"), asset("atrium/atrium.json")};
  const auto host = options.common.makeHost(false);
  const gl::Context context;
  watchForInterrupt();
  const auto start = Clock::now();
  Report report(options, context, std::string(nameOf(host->kind())));
  const auto part = [&](const char* name, auto make) {
    if (interrupted() ||
        (!options.parts.empty() && std::find(options.parts.begin(), options.parts.end(), name) == options.parts.end()))
      return;
    if (!options.common.quiet) fmt::print("{}\n", name);
    try {
      make();
    } catch (const Error& e) {
      if (e.kind() == ErrorKind::badInput) throw;  // such as a full disk, which would make everything after it fail too
      report.missing(name, e.what());
    }
  };
  for (const std::string& scene : options.scenes) part("error", [&] { report.errors(scene, false); });
  part("deviations", [&] { report.errors(options.scenes.front(), true); });
  part("stability", [&] { report.stability(); });
  part("features", [&] { report.features(options.scenes); });
  part("rays", [&] { report.rays(options.scenes); });
  part("tables", [&] { report.tables(originals); });
  part("pictures", [&] { report.pictures(originals); });
  const double seconds = secondsSince(start);
  if (interrupted()) {
    fmt::print(stderr, "lucerna: interrupted; the same command with --out {} resumes\n", options.out);
    return exitCode();
  }
  report.write(seconds);
  if (!options.common.quiet) fmt::print("{}/index.html, {:.0f} s\n", options.out, seconds);
  report.json()["renderer"] = context.capabilities().renderer;
  report.json()["host"] = std::string(nameOf(host->kind()));
  report.json()["cpu"] = cpuName();
  report.json()["scale"] = options.scale;
  report.json()["seconds"] = seconds;
  options.common.writeJson(report.json());
  return 0;
}

}  // namespace

}  // namespace bench

Work addBenchAll(Command app) {
  auto options = std::make_shared<bench::AllOptions>();
  app.addOption(
         "SCENE", options->scenes,
         "scene files for error and features (default: the Cornell box and the atrium); the first for the tables "
         "and pictures of lpv (default: the atrium)")
      .scene();
  app.addOption("--out", options->out, "folder for the report; an interrupted one is resumed").required();
  addCompletions(app.addOption("--parts", options->parts,
                               "of error, deviations, stability, features, rays, tables, pictures; default: all")
                     .delimiter(','),
                 {std::begin(bench::kParts), std::end(bench::kParts)});
  app.addOption("--scale", options->scale,
                "amount of work: pixels and seconds; 1 takes four times as long as the default")
      .showDefault();
  options->common.declare(app);
  return [options] { return bench::runAll(*options); };
}

}  // namespace lucerna::demo
