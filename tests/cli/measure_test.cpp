// lucerna compare, bench error|frame|stability|needs, tune, --settings: contracts, what is refused, and that an
// interrupted bench goes on.
#include "base/files.hpp"
#include "base/image.hpp"
#include "support/long_tests.hpp"
#include "support/subprocess.hpp"
#include "support/temp_folder.hpp"

#include <fmt/core.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <numeric>
#include <set>

namespace {

namespace fs = std::filesystem;
using namespace lucerna;
using test::RunResult;

const char* kMeasuredScene =
    "mtllib scene.mtl\nv -2 0 -2\nv 2 0 -2\nv 2 0 2\nv -2 0 2\nv -2 3 -2\nv 2 3 -2\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
    "usemtl white\nf 1/1 4/4 3/3 2/2\nusemtl red\nf 1/1 2/2 6/3 5/4\n";

class Measure : public ::testing::Test {
 protected:
  void SetUp() override {
    std::ofstream(path("scene.obj")) << kMeasuredScene;
    std::ofstream(path("scene.mtl")) << "newmtl white\nKd 0.8 0.8 0.8\nnewmtl red\nKd 0.7 0.1 0.1\n";
    ::setenv("LUCERNA_REFERENCES", path("references").c_str(), 1);
  }
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
  nlohmann::json json(const std::string& name) const { return nlohmann::json::parse(std::ifstream(path(name))); }
  std::string benchError(const std::string& more) const {
    return "bench error '" + path("scene.obj") +
           "' --size 32x16 --reference-spp 32 --budget 1 --frames 1 --small --out '" + path("out") + "' --json '" +
           path("error.json") + "' " + more;
  }
  void expectOneLine(const RunResult& result, int exitCode, const std::vector<std::string>& parts) const {
    EXPECT_EQ(result.exitCode, exitCode) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    for (const std::string& part : parts)
      EXPECT_NE(result.err.find(part), std::string::npos) << "'" << part << "' is not in: " << result.err;
  }

 private:
  test::TempFolder folder_;
};

TEST_F(Measure, CompareSaysHowFarTwoPicturesAreApart) {
  Image reference(20, 10, glm::vec3(2.0f)), image(20, 10, glm::vec3(2.2f));
  image.at(3, 4).y = 5.0f;
  writeImage(path("a.pfm"), image);
  writeImage(path("b.pfm"), reference);
  const RunResult result = RUN_LUCERNA("compare '" + path("a.pfm") + "' '" + path("b.pfm") + "' --heatmap '" +
                                       path("heat.png") + "' --json '" + path("c.json") + "'");
  ASSERT_EQ(result.exitCode, 0) << result.err;
  const auto c = json("c.json");
  EXPECT_NEAR(c.at("rmse"), std::sqrt((0.04 * 599 + 9.0) / 600.0), 1e-6);
  EXPECT_NEAR(c.at("nrmse"), c.at("rmse").get<double>() / 2.0, 1e-12);
  EXPECT_NEAR(c.at("l2"), c.at("rmse").get<double>() / 2.0, 1e-12);
  EXPECT_NEAR(c.at("nrmse_black"), 1.0, 1e-6);
  EXPECT_EQ(c.at("block_side"), 1);  // a sixteenth of 20
  EXPECT_NEAR(c.at("bias"), 0.2 + 2.8 / 600.0, 1e-6);
  EXPECT_NEAR(c.at("max"), 3.0, 1e-6);
  EXPECT_NEAR(c.at("p99"), 0.2, 1e-6);
  EXPECT_TRUE(c.contains("relmse"));
  EXPECT_GT(c.at("flip").get<double>(), 0.0);
  EXPECT_GT(readBitmap(path("heat.png")).width, 40);
  writeImage(path("small.pfm"), Image(3, 3));
  expectOneLine(RUN_LUCERNA("compare '" + path("a.pfm") + "' '" + path("small.pfm") + "'"), 2, {"20x10", "3x3"});
  expectOneLine(RUN_LUCERNA("compare '" + path("a.pfm") + "' '" + path("b.pfm") + "' --heatmap x.jpg"), 2,
                {"--heatmap", "png"});
}

TEST_F(Measure, FrameHasEveryPassWithItsTimeAndError) {
  const std::string cornell = "'" LUCERNA_SOURCE_DIR "/assets/cornell/cornell.json' --size 48x27 ";
  const std::string cache = "irradiance-cache cache.samples=64";
  const RunResult result =
      RUN_LUCERNA("bench frame " + cornell + "--frames 2 --reference-spp 64 --technique '" + cache +
                  "' --technique lpv --technique rsm -o '" + path("page.md") + "' --json '" + path("frame.json") + "'");
  ASSERT_EQ(result.exitCode, 0) << result.err;
  const std::string page = readFileText(path("page.md"));
  const auto report = json("frame.json");
  EXPECT_LT(report.at("noise_l2").get<double>(), 0.1);
  ASSERT_EQ(report.at("frames").size(), 3u);
  for (const auto& frame : report.at("frames")) {
    const std::string technique = frame.at("technique");
    // The passes are those that a frame's timer reports.
    ASSERT_EQ(RUN_LUCERNA("render " + cornell + "--technique " + technique + " --repeat 2 -o '" + path("p.png") +
                          "' --json '" + path("render.json") + "'")
                  .exitCode,
              0);
    std::set<std::string> expected, names;
    const auto stages = json("render.json").at("stages");
    for (const auto& [name, stage] : stages.items()) expected.insert(name);
    for (const auto& pass : frame.at("passes")) names.insert(pass.at("name"));
    EXPECT_EQ(names, expected) << technique;
    const double finished = frame.at("light").back().at("l2");
    for (const auto& pass : frame.at("passes")) {
      EXPECT_GT(pass.at("ms").get<double>(), 0.0) << pass;
      EXPECT_NE(page.find(". " + pass.at("title").get<std::string>() + "\n"), std::string::npos) << pass;
      for (const std::string name : pass.at("pictures")) EXPECT_GT(readBitmap(path("page/" + name)).width, 40);
      // lpv does not have the light of the lamp, in whose place unblocked light of the sun may come.
      const bool mayBeWorse = pass.at("name") == "geometry volume" || pass.at("name") == "interpolation";
      EXPECT_TRUE(mayBeWorse || pass.at("l2_without").get<double>() >= finished) << pass;
    }
    // From black to the finished picture the error only falls.
    double before = 1.0;
    for (const auto& step : frame.at("light")) {
      EXPECT_LT(step.at("l2").get<double>(), before - 0.02) << step;
      before = step.at("l2");
      EXPECT_EQ(readBitmap(path("page/" + step.at("picture").get<std::string>())).width, 48);
    }
    EXPECT_EQ(frame.at("light").size(), 3u);  // emission, direct, indirect: nothing surrounds the box
  }
  EXPECT_LT(report.at("frames")[0].at("light").back().at("l2").get<double>(), 0.1);
  expectOneLine(RUN_LUCERNA("bench frame " + cornell + "--technique radiosity -o '" + path("r.md") + "'"), 2,
                {"--technique radiosity", "irradiance-cache"});
  expectOneLine(RUN_LUCERNA("bench frame " + cornell + "-o '" + path("r.html") + "'"), 2, {"-o", "md"});
}

TEST_F(Measure, BenchErrorReportsAndGoesOnWhereItWas) {
  const RunResult first = RUN_LUCERNA(benchError("--techniques direct,rsm,path"));
  ASSERT_EQ(first.exitCode, 0) << first.err;
  const auto report = json("error.json");
  ASSERT_GT(report.at("rows").size(), 10u);
  bool pareto = false;
  for (const auto& row : report.at("rows")) {
    for (const char* key : {"technique", "fidelity",  "settings", "ms",       "nrmse",  "bias",        "bias_error",
                            "pareto",    "gpu_bytes", "wall_ms",  "setup_ms", "relmse", "p99",         "flip",
                            "at_noise",  "l2",        "blocks",   "lit",      "other",  "inside_front"})
      EXPECT_TRUE(row.contains(key)) << key;
    pareto |= row.at("pareto").get<bool>();
    EXPECT_EQ(row.contains("inside_model"), row.at("technique") != "path");
  }
  // The sentence at the end: from the fastest picture of the front on, each technique where it is worth the time.
  const nlohmann::json choices = report.at("choices");
  ASSERT_FALSE(choices.empty());
  EXPECT_NE(first.out.find("What to use for a picture's time: "), std::string::npos) << first.out;
  double from = -1.0;
  for (const auto& choice : choices) {
    EXPECT_GT(choice.at("from_ms").get<double>(), from);
    from = choice.at("from_ms");
    EXPECT_NE(first.out.find(choice.at("first").get<std::string>() + " (error "), std::string::npos) << first.out;
    const auto isItsRow = [&](const nlohmann::json& row) {
      return row.at("label") == choice.at("first") && row.at("inside_front") && row.at("fidelity") != "original";
    };
    EXPECT_TRUE(std::ranges::any_of(report.at("rows"), isItsRow)) << choice;
  }
  EXPECT_TRUE(pareto);
  // Settings of a technique are ranked inside its model: what is not on that front is beaten there, and is on no other.
  // Equal within two standard errors is equal, in l2 and in time; what is at the reference's noise is three times that.
  const auto number = [](const nlohmann::json& row, const char* key) {
    const auto& value = row.at("inside_model").at(key);
    return value.is_number() ? value.get<double>() : 0.0;
  };
  const auto atNoise = [](const nlohmann::json& row) { return row.at("inside_model").at("at_noise") == true; };
  const auto ranked = [&](const nlohmann::json& row) {
    return atNoise(row) ? 3.0 * number(row, "noise_l2") : number(row, "l2");
  };
  const auto rankedError = [&](const nlohmann::json& row) { return atNoise(row) ? 0.0 : number(row, "l2_error"); };
  const auto timeError = [](const nlohmann::json& row) {  // of a median
    const std::vector<double> ms = row.at("wall_ms_samples");
    const double n = static_cast<double>(ms.size());
    const double mean = std::accumulate(ms.begin(), ms.end(), 0.0) / n;
    double squares = 0.0;
    for (const double v : ms) squares += (v - mean) * (v - mean);
    return n < 2.0 ? 0.0 : std::sqrt(squares / (n - 1.0)) * (n == 3.0 ? 0.67 : std::sqrt(0.5 * M_PI / n));
  };
  const auto isBeatenBy = [&](const nlohmann::json& row, const nlohmann::json& other) {
    return other.at("ms").get<double>() - row.at("ms").get<double>() <=
               2.0 * std::hypot(timeError(row), timeError(other)) &&
           ranked(other) - ranked(row) <= 2.0 * std::hypot(rankedError(row), rankedError(other));
  };
  int beaten = 0;
  for (const auto& row : report.at("rows")) {
    if (row.at("inside_front")) continue;
    ++beaten;
    EXPECT_FALSE(row.at("pareto")) << row.at("label");
    EXPECT_TRUE(std::any_of(report.at("rows").begin(), report.at("rows").end(), [&](const nlohmann::json& other) {
      return other.at("technique") == row.at("technique") && other != row &&
             other.at("inside_model").at("model") == row.at("inside_model").at("model") && isBeatenBy(row, other);
    })) << row.dump();
  }
  EXPECT_GT(beaten, 0);
  std::map<std::string, int> ofPath;
  for (const auto& row : report.at("rows"))
    if (row.at("technique") == "path") ++ofPath[row.at("fidelity").get<std::string>()];
  EXPECT_GE(ofPath["corrected"], 3);
  EXPECT_GE(ofPath["original"], 3);
  EXPECT_EQ(report.at("references").size(),
            6u);  // the light given to paths and that given to propagation are two
  EXPECT_EQ(report.at("model").size(), 5u);
  // What techniques must beat stands beside them: nothing scattered has 100 %, by pixels and in blocks, of all light
  // and inside each model.
  ASSERT_EQ(report.at("baselines").size(), 2u);
  const auto expectBaselines = [](const nlohmann::json& black, const nlohmann::json& constant) {
    EXPECT_NEAR(black.at("l2"), 1.0, 1e-5);
    EXPECT_NEAR(black.at("blocks").at("l2"), 1.0, 1e-5);
    EXPECT_FALSE(black.at("at_noise"));
    EXPECT_GE(black.at("blocks").at("noise_nrmse").get<double>(), 0.0);
    EXPECT_GT(constant.at("l2").get<double>(), 0.0);
    EXPECT_LT(constant.at("l2").get<double>(), 1.0);
  };
  expectBaselines(report.at("baselines")[0], report.at("baselines")[1]);
  ASSERT_EQ(report.at("inside_models").size(), 2u);  // direct light, and the gather's
  for (const auto& model : report.at("inside_models")) expectBaselines(model.at("black"), model.at("constant"));
  for (const char* file : {"report.html", "error.csv", "error.json"})
    EXPECT_TRUE(fs::exists(path("out") + "/" + file)) << file;
  // A page of its own: nothing is fetched.
  const std::string page = readFileText(path("out") + "/report.html");
  EXPECT_EQ(page.find("src=\"http"), std::string::npos);
  EXPECT_NE(page.find("data:image/png;base64,"), std::string::npos);
  EXPECT_NE(page.find("data-plane=\"r0\""), std::string::npos);

  // One row is lost and one damaged: these are measured again, the others stay as they are.
  std::vector<fs::path> rows;
  for (const auto& entry : fs::directory_iterator(path("out") + "/rows"))
    if (entry.path().extension() == ".json" && !entry.path().filename().string().starts_with("path"))
      rows.push_back(entry.path());
  std::sort(rows.begin(), rows.end());
  fs::remove(rows[0]);
  std::ofstream(rows[1]) << "{ half";
  const std::string kept = readFileText(rows[2]);
  const auto time = fs::last_write_time(rows[2]);
  ASSERT_EQ(RUN_LUCERNA(benchError("--techniques direct,rsm,path")).exitCode, 0);
  EXPECT_EQ(readFileText(rows[2]), kept);
  EXPECT_EQ(fs::last_write_time(rows[2]), time);
  EXPECT_TRUE(fs::exists(rows[0]));
  EXPECT_TRUE(nlohmann::json::accept(readFileText(rows[1])));
  EXPECT_EQ(json("error.json").at("rows").size(), report.at("rows").size());

  // More is better, or the sweep says where not: by more than twice what the reference's noise gives.
  const nlohmann::json sweeps = json("error.json").at("sweeps");
  ASSERT_EQ(sweeps.size(), 2u);
  for (const auto& sweep : sweeps) {
    std::vector<const nlohmann::json*> steps;
    for (const auto& row : report.at("rows"))
      if (row.at("series") == sweep.at("series")) steps.push_back(&row.at("inside_model"));
    ASSERT_EQ(steps.size(), sweep.at("labels").size());
    std::size_t rises = 0;
    for (std::size_t k = 1; k < steps.size(); ++k) {
      const auto of = [&](std::size_t i, const char* key) { return steps[i]->at(key).get<double>(); };
      if (steps[k]->at("at_noise") == true || steps[k - 1]->at("at_noise") == true) continue;
      rises += of(k, "l2") - of(k - 1, "l2") > 2.0 * std::hypot(of(k, "l2_error"), of(k - 1, "l2_error"));
    }
    EXPECT_EQ(sweep.at("rises").size(), rises) << sweep;
  }

  // An earlier report beside it: with half of its times and errors, this one takes eight times as long to its error.
  nlohmann::json earlier = json("error.json");
  for (auto& row : earlier.at("rows"))
    for (const char* key : {"ms", "l2"}) row.at(key) = 0.5 * row.at(key).get<double>();
  std::ofstream(path("earlier.json")) << earlier;
  const std::string beside = benchError("--techniques direct,rsm,path --before '" + path("earlier.json") + "'");
  ASSERT_EQ(RUN_LUCERNA(beside).exitCode, 0);
  const std::string both = readFileText(path("out") + "/report.html");
  EXPECT_NE(both.find("Beside an earlier program"), std::string::npos);
  EXPECT_NE(both.find(">8.00<"), std::string::npos);
  EXPECT_NE(both.find("path, before"), std::string::npos);
  earlier.at("bench") = "another, camera default, 32x18";
  std::ofstream(path("earlier.json")) << earlier;
  expectOneLine(RUN_LUCERNA(beside), 2, {"--before", "another, camera default"});

  // Another scene or size is another bench.
  expectOneLine(RUN_LUCERNA("bench error '" + path("scene.obj") + "' --size 32x18 --reference-spp 16 --out '" +
                            path("out") + "'"),
                2, {"another bench", "out"});
}

TEST_F(Measure, PicturesThatAreAskedForAndBounds) {
  const std::string bench = "bench error '" + path("scene.obj") +
                            "' --size 32x16 --reference-spp 2048 --frames 1 --out '" + path("out") + "' --json '" +
                            path("error.json") + "' ";
  ASSERT_EQ(RUN_LUCERNA(bench + "--point 'rsm rsm.samples=20 rsm.interpolate=off' --bounds").exitCode, 0);
  std::map<std::string, nlohmann::json> rows;
  const nlohmann::json report = json("error.json");
  for (const auto& row : report.at("rows")) rows[row.at("label")] = row;
  EXPECT_EQ(rows.size(), 7u);
  ASSERT_TRUE(rows.contains("rsm samples=20 rsm.interpolate=off") || rows.contains("rsm samples=20 interpolate=off"));
  for (const char* of : {"lpv", "irradiance-cache transport=gather bounces=1"}) {
    const std::string bound = std::string(of) + ", bound: the map at each pixel";
    ASSERT_TRUE(rows.contains(of) && rows.contains(bound)) << of;
    const auto inside = [&](const std::string& label) { return rows.at(label).at("inside_model"); };
    EXPECT_EQ(inside(of).at("model"), inside(bound).at("model"));
    // Gathering at each pixel is far better than propagation. Here it is as good as gathering in cells, since a plain
    // wall needs no finer ones. All light is the technique's direct light plus what is measured.
    const double most = std::string_view(of) == "lpv" ? 0.2 : 1.25;
    EXPECT_LT(inside(bound).at("l2").get<double>(), most * inside(of).at("l2").get<double>()) << of;
    EXPECT_LT(rows.at(bound).at("l2").get<double>(), 0.5) << of;
  }
  EXPECT_TRUE(rows.contains("lpv, bound: exact radiance in the cells"));
  EXPECT_NE(report.at("command").get<std::string>().find("--bounds --point"), std::string::npos);
  expectOneLine(RUN_LUCERNA(bench + "--point 'smoke a=1'"), 2, {"--point", "smoke", "rsm"});
  expectOneLine(RUN_LUCERNA(bench + "--point 'rsm rsm.samplez=1'"), 2, {"rsm.samplez"});
}

// A sun and an emissive lamp. Forward shading and RSM know no emissive surfaces: what they are judged by holds none of
// the lamp's light, as if it were off. Radiosity has it.
TEST_F(Measure, TechniquesAreJudgedByTheLightThatTheyAreGiven) {
  const auto bench = [&](const char* emission, const char* techniques) {
    std::ofstream(path("scene.mtl"))
        << "newmtl white\nKd 0.8 0.8 0.8\nnewmtl red\nKd 0.7 0.1 0.1\nnewmtl lamp\nKd 0.5 0.5 0.5\nKe " << emission
        << "\n";
    std::ofstream(path("lit.obj")) << kMeasuredScene
                                   << "v -1 2 -1\nv 1 2 -1\nv 1 2 1\nv -1 2 1\nusemtl lamp\nf -4/1 -3/2 -2/3 -1/4\n";
    std::ofstream(path("lit.json"))
        << R"({"model": "lit.obj", "sun": {"direction": [0.2, -1, -0.3], "irradiance": [3, 3, 3]},
               "camera": {"position": [2.5, 3, 6], "target": [0, 1, 0], "fov": 50}})";
    fs::remove_all(path("out"));
    const RunResult result =
        RUN_LUCERNA("bench error '" + path("lit.json") +
                    "' --size 32x16 --reference-spp 256 --budget 1 --frames 1 --small --techniques " + techniques +
                    " --out '" + path("out") + "' --json '" + path("error.json") + "'");
    EXPECT_EQ(result.exitCode, 0) << result.err;
    return json("error.json");
  };
  struct Mean {
    double value = 0.0, error = 0.0;
  };
  const auto mean = [](const nlohmann::json& report, const std::string& transport, const std::string& lights) {
    for (const auto& r : report.at("references"))
      if (r.at("transport") == transport && r.at("lights") == lights)
        return Mean{
            (r.at("mean")[0].get<double>() + r.at("mean")[1].get<double>() + r.at("mean")[2].get<double>()) / 3.0,
            r.at("mean_error")};
    ADD_FAILURE() << "no reference " << transport << " of " << lights;
    return Mean{};
  };
  const auto on = bench("20 20 20", "direct,rsm,radiosity"), off = bench("0 0 0", "direct,rsm");
  for (const char* transport : {"direct", "one-bounce", "one-bounce-unoccluded"}) {
    const Mean given = mean(on, transport, "sun"), asIfOff = mean(off, transport, "sun");
    EXPECT_NEAR(given.value, asIfOff.value, 5.0 * std::hypot(given.error, asIfOff.error) + 1e-6 * asIfOff.value)
        << transport;
    EXPECT_GT(given.value, 0.0);
  }
  for (const char* transport : {"direct", "one-bounce"})
    EXPECT_GT(mean(on, transport, "sun, emissive surfaces").value, 1.5 * mean(on, transport, "sun").value) << transport;
  // What they have not is a line of its own, of direct light and of what is reflected; nothing where there is no such
  // lamp.
  std::map<std::string, double> lines;
  for (const auto& line : on.at("model"))
    if (line.at("leaves_out").get<std::string>().starts_with("no light of: emissive surfaces"))
      lines[line.at("leaves_out").get<std::string>() + " " + line.at("of").get<std::string>()] =
          line.at("relative_bias");
  ASSERT_EQ(lines.size(), 2u) << on.at("model").dump(1);
  EXPECT_LT(lines.at("no light of: emissive surfaces (direct, rsm) direct light"), -0.3);
  EXPECT_LT(lines.at("no light of: emissive surfaces (rsm) one bounce of all lights"), -0.3);
  for (const auto& line : off.at("model"))
    EXPECT_FALSE(line.at("leaves_out").get<std::string>().starts_with("no light of")) << line.dump();
  for (const auto& row : on.at("rows")) {
    EXPECT_EQ(row.contains("inside_model"), row.at("technique") != "radiosity") << "it has all of this scene's lights";
    if (row.contains("inside_model")) { EXPECT_EQ(row.at("inside_model").at("lights"), "sun"); }
    // Forward shading of the sun is right inside its model, and far off all light.
    if (row.at("technique") == "direct") {
      EXPECT_LT(row.at("inside_model").at("l2").get<double>(), 0.15);
      EXPECT_GT(row.at("l2").get<double>(), 0.3);
    }
  }
}

TEST_F(Measure, RadiosityHasASweepAndDeviationsOfItsOwn) {
  ASSERT_EQ(RUN_LUCERNA(benchError("--techniques radiosity")).exitCode, 0);
  std::map<std::string, nlohmann::json> edges, resolutions;  // by the value of the setting that a series changes
  const nlohmann::json sweep = json("error.json");
  nlohmann::json published;
  for (const auto& row : sweep.at("rows")) {
    EXPECT_EQ(row.at("technique"), "radiosity");
    EXPECT_FALSE(row.contains("inside_model")) << "sun and environment: it has all of this scene's lights";
    if (row.contains("published")) published = row;
    if (row.at("fidelity") == "original") continue;
    for (const std::string setting : row.at("settings")) {
      if (row.at("series") == "radiosity patches" && setting.starts_with("radiosity.edge="))
        edges[setting.substr(15)] = row;
      if (setting.starts_with("radiosity.resolution=")) resolutions[setting.substr(21)] = row;
    }
  }
  ASSERT_EQ(edges.size(), 3u);
  EXPECT_EQ(resolutions.size(), 3u);
  // Solving is baking, and the settings reach the solver: smaller patches take more memory, and the biases differ
  // (errors may both be below the reference's noise).
  const auto &coarse = edges.at("1.33333"), &fine = edges.at("0.333333");
  EXPECT_GT(fine.at("setup_ms").get<double>(), 0.0);
  EXPECT_GT(fine.at("gpu_bytes").get<double>(), coarse.at("gpu_bytes").get<double>());
  EXPECT_NE(fine.at("bias"), coarse.at("bias"));
  // The published program on the same patches: the same picture but for its map's error in what is reflected.
  ASSERT_TRUE(published.is_object()) << "a row by glReadPixels";
  EXPECT_NE(published.at("label").get<std::string>().find("edge=1.33333"), std::string::npos);
  const auto& solved = published.at("published");
  for (const int sweeps : solved.at("sweeps")) EXPECT_TRUE(sweeps >= 2 && sweeps <= 7) << sweeps;
  EXPECT_GE(solved.at("hemicubes").get<int>(), 6 * solved.at("triangles").get<int>());
  EXPECT_GE(published.at("setup_ms").get<double>(), 1e3 * solved.at("seconds").get<double>());
  const double here = published.at("relative_bias"), there = coarse.at("relative_bias");
  EXPECT_NEAR(here, there, 0.1);
  EXPECT_NE(here, there);

  fs::remove_all(path("out"));
  ASSERT_EQ(RUN_LUCERNA(benchError("--techniques radiosity --deviations")).exitCode, 0);
  std::map<std::string, double> bias;
  const nlohmann::json deviations = json("error.json");
  for (const auto& row : deviations.at("rows"))
    bias[row.at("fidelity") == "original" ? "original"
         : row.at("deviations").empty()   ? ""
                                          : row.at("deviations")[0].get<std::string>()] = row.at("bias");
  for (const char* name : {"", "original", "radiosity.published-map=on", "radiosity.centroid=on",
                           "radiosity.fixed-orientation=on", "radiosity.no-near-field=on"})
    EXPECT_TRUE(bias.contains(name)) << name;
  EXPECT_NE(bias[""], bias["radiosity.published-map=on"]);
}

// A scene of more triangles than the published solver gets through in a minute has a row of a coarser model, and a line
// that says how coarse.
TEST_F(Measure, ThePublishedRowOfALargeSceneIsOfACoarserModel) {
  std::ofstream scene(path("scene.obj"));
  scene << "mtllib scene.mtl\nusemtl white\n";
  constexpr int kSide = 16;  // 512 triangles of floor, gently curved
  for (int z = 0; z <= kSide; ++z)
    for (int x = 0; x <= kSide; ++x)
      scene << fmt::format("v {} {} {}\n", 4.0 * x / kSide - 2.0, 0.2 * std::sin(0.3 * x), 4.0 * z / kSide - 2.0);
  for (int z = 0; z < kSide; ++z)
    for (int x = 0; x < kSide; ++x) {
      const int i = z * (kSide + 1) + x + 1;
      scene << fmt::format("f {} {} {} {}\n", i, i + kSide + 1, i + kSide + 2, i + 1);
    }
  scene.close();
  const RunResult result = RUN_LUCERNA(benchError("--techniques radiosity"));
  ASSERT_EQ(result.exitCode, 0) << result.err;
  const nlohmann::json sweep = json("error.json");
  const auto& rows = sweep.at("rows");
  const auto row = std::find_if(rows.begin(), rows.end(), [](const auto& r) { return r.contains("published"); });
  ASSERT_NE(row, rows.end());
  const auto& published = row->at("published");
  EXPECT_EQ(published.at("scene_triangles"), 2 * kSide * kSide);
  const int triangles = published.at("model_triangles"), patches = published.at("triangles");
  EXPECT_LE(patches, 400);
  EXPECT_GE(patches, triangles);
  EXPECT_GT(triangles, 40);
  EXPECT_GT(published.at("model_cell").get<double>(), 4.0 / kSide);
  EXPECT_NEAR(published.at("model_area").get<double>(), 1.0, 0.1);
  EXPECT_NE(result.out.find(fmt::format("{} triangles of the scene's {}", triangles, 2 * kSide * kSide)),
            std::string::npos)
      << result.out;
}

TEST_F(Measure, TuneWritesSettingsThatRenderTakes) {
  const std::string common =
      "tune '" + path("scene.obj") +
      "' --size 32x16 --reference-spp 16 --budget 1 --frames 1 --small --techniques direct,rsm --out '" + path("out") +
      "' ";
  ASSERT_EQ(RUN_LUCERNA(common + "--frame-time 100000 -o '" + path("s.json") + "'").exitCode, 0);
  const auto settings = json("s.json");
  EXPECT_TRUE(settings.contains("technique"));
  EXPECT_GT(settings.at("measured").at("setup_ms").get<double>(), 0.0);
  const RunResult picture =
      RUN_LUCERNA("render '" + path("scene.obj") + "' --size 32x16 --settings '" + path("s.json") + "' -o '" +
                  path("p.pfm") + "' --json '" + path("p.json") + "'");
  ASSERT_EQ(picture.exitCode, 0) << picture.err;
  EXPECT_EQ(json("p.json").at("technique"), settings.at("technique"));
  EXPECT_EQ(json("p.json").at("settings"), settings.at("settings"));
  // With the filter and the samples that were measured.
  ASSERT_EQ(RUN_LUCERNA("tune '" + path("scene.obj") + "' --size 32x16 --reference-spp 16 --frames 1 --small --out '" +
                        path("filtered") + "' --techniques direct --filter gaussian --pixel-samples 4 --quiet " +
                        "--frame-time 100000 -o '" + path("f.json") + "'")
                .exitCode,
            0);
  EXPECT_EQ(json("f.json").at("settings"), nlohmann::json({"picture.filter=gaussian", "picture.samples=4"}));
  ASSERT_EQ(RUN_LUCERNA("render '" + path("scene.obj") + "' --size 32x16 --settings '" + path("f.json") + "' -o '" +
                        path("p.pfm") + "' --json '" + path("p.json") + "'")
                .exitCode,
            0);
  EXPECT_EQ(json("p.json").at("settings"), json("f.json").at("settings"));
  expectOneLine(RUN_LUCERNA(common + "--quiet --error 1e-9 -o '" + path("s.json") + "'"), 2,
                {"no settings meet", "closest", "set-up"});
  expectOneLine(RUN_LUCERNA(common + "--quiet --frame-time 100000 --setup-time 1e-6 -o '" + path("s.json") + "'"), 2,
                {"--setup-time", "fastest"});
  expectOneLine(RUN_LUCERNA(common + "-o '" + path("s.json") + "'"), 2, {"--frame-time", "--error"});
  std::ofstream(path("bad.json")) << "[1, 2";
  expectOneLine(RUN_LUCERNA("render '" + path("scene.obj") + "' --settings '" + path("bad.json") + "' -o '" +
                            path("p.pfm") + "'"),
                2, {"--settings", "bad.json"});
}

TEST_F(Measure, WhatCannotBeIsOneLine) {
  std::ofstream(path("file")) << "x";
  expectOneLine(RUN_LUCERNA("bench error '" + path("scene.obj") + "' --out '" + path("file") + "'"), 2,
                {"--out", "file"});
  expectOneLine(RUN_LUCERNA(benchError("--techniques magic")), 2, {"magic", "rsm"});
  expectOneLine(RUN_LUCERNA("bench stability --technique magic"), 2, {"magic", "lpv"});
  expectOneLine(RUN_LUCERNA("bench all --out '" + path("file") + "'"), 2, {"--out"});
  expectOneLine(RUN_LUCERNA("bench all --parts magic --out '" + path("out") + "'"), 2,
                {"--parts", "magic", "stability"});
}

TEST_F(Measure, StabilityRowsSayWhatWasExpected) {
  const RunResult result = RUN_LUCERNA("bench stability --technique direct --json '" + path("s.json") + "'");
  EXPECT_EQ(result.exitCode, 0) << result.out;
  const auto rows = json("s.json").at("rows");
  EXPECT_GE(rows.size(), 10u);
  for (const auto& row : rows) {
    for (const char* key : {"technique", "case", "parameter", "expected", "measured", "verdict"})
      EXPECT_TRUE(row.contains(key)) << key;
    EXPECT_EQ(row.at("verdict"), "pass") << row.dump();
  }
}

TEST_F(Measure, StabilityIsComparedWithATableThatWasKept) {
  const std::string run = "bench stability --quiet --technique direct ";
  ASSERT_EQ(RUN_LUCERNA(run + "--json '" + path("kept.json") + "'").exitCode, 0);
  const auto kept = json("kept.json");
  const auto against = [&](const nlohmann::json& table) {
    std::ofstream(path("old.json")) << table;
    return RUN_LUCERNA(run + "--compare '" + path("old.json") + "' --json '" + path("now.json") + "'");
  };
  RunResult same = against(kept);
  EXPECT_EQ(same.exitCode, 0) << same.out;
  EXPECT_TRUE(json("now.json").at("worse").empty());

  // A row that is gone, one that allowed less, one that expected something else, and one of another technique, which is
  // not asked for.
  auto stricter = kept;
  auto gone = kept.at("rows")[0];
  gone["case"] = "no such case";
  stricter["rows"].push_back(gone);
  gone["technique"] = "lpv";
  stricter["rows"].push_back(gone);
  stricter["rows"][0]["tolerance"] = 1e-9;
  stricter["rows"][1]["expected"] = 7.0;
  const RunResult worse = against(stricter);
  EXPECT_EQ(worse.exitCode, 1) << worse.out;
  EXPECT_EQ(json("now.json").at("worse").size(), 3u) << worse.out;
  for (const char* part : {"no such case, sun 1e-09x: gone", "allows", "expects 1, was 7"})
    EXPECT_NE(worse.out.find(part), std::string::npos) << part << " in " << worse.out;

  expectOneLine(against({{"rows", {{{"case", 1}}}}}), 2, {"--compare", "old.json"});
  expectOneLine(RUN_LUCERNA(run + "--compare '" + path("scene.obj") + "'"), 2, {"--compare", "scene.obj"});
}

// What continuous integration keeps: tests/stability.json, made by `lucerna bench stability --json
// tests/stability.json`. The short form leaves out the techniques whose rows take long.
TEST_F(Measure, NoStabilityRowIsWorseThanTheKeptTable) {
  const std::vector<std::string> techniques =
      test::longTests() ? std::vector<std::string>{"direct", "rsm", "lpv", "irradiance-cache", "radiosity", "path"}
                        : std::vector<std::string>{"direct", "rsm"};
  std::size_t rows = 0;
  double seconds = 0.0;
  for (const std::string& technique : techniques) {
    const RunResult result =
        RUN_LUCERNA("bench stability --technique " + technique +
                    " --compare '" LUCERNA_SOURCE_DIR "/tests/stability.json' --json '" + path("s.json") + "'");
    EXPECT_EQ(result.exitCode, 0) << result.out << result.err;
    const auto table = json("s.json");
    EXPECT_GE(table.at("rows").size(), 14u) << technique;
    for (const auto& row : table.at("rows")) EXPECT_EQ(row.at("technique"), technique);
    rows += table.at("rows").size();
    seconds += table.at("seconds").get<double>();
  }
  EXPECT_LT(seconds, 600.0);
  if (test::longTests()) { EXPECT_GE(rows, 247u); }
}

TEST_F(Measure, TenThousandFramesOfALoopEndAsTheyBegan) {
  if (!test::longTests()) GTEST_SKIP() << "takes minutes; run by tests/long";
  const RunResult result = RUN_LUCERNA("bench stability --technique motion --json '" + path("s.json") + "'");
  EXPECT_EQ(result.exitCode, 0) << result.out;
  EXPECT_EQ(json("s.json").at("rows").size(), 35u);
}

TEST_F(Measure, AFullDiskIsOneLine) {
  if (test::run("unshare -rm sh -c 'mount -t tmpfs -o size=64k none /mnt'").exitCode != 0)
    GTEST_SKIP() << "no permission to mount a tmpfs";
  fs::create_directory(path("small"));
  const std::string small = path("small");
  const RunResult result = test::run(
      "unshare -rm sh -c \"mount -t tmpfs -o size=32k none '" + small + "' && " + LUCERNA_BINARY + " bench error '" +
      path("scene.obj") +
      "' --size 32x16 --reference-spp 32 --budget 1 --frames 1 --small --quiet --techniques direct,rsm --out '" +
      small + "/out'\"");
  expectOneLine(result, 2, {"No space left on device", small});
  // Nor a page half written, where the rows fit and the page does not.
  const RunResult all =
      test::run("unshare -rm sh -c \"mount -t tmpfs -o size=32k none '" + small + "' && " + LUCERNA_BINARY +
                " bench all '" + path("scene.obj") + "' --scale 0.01 --quiet --out '" + small +
                "/out'; code=\\$?; test -e '" + small + "/out/index.html' && exit 99; exit \\$code\"");
  expectOneLine(all, 2, {"No space left on device", small});
}

TEST_F(Measure, FeaturesSayWhatLeavingOutSaves) {
  const RunResult result = RUN_LUCERNA("bench features '" + path("scene.obj") +
                                       "' --size 32x16 --frames 1 --technique direct --json '" + path("n.json") + "'");
  ASSERT_EQ(result.exitCode, 0) << result.err;
  const auto n = json("n.json");
  for (const char* key : {"left_out", "gpu_bytes_with", "gpu_bytes_without", "ms_with", "ms_without", "max_difference"})
    ASSERT_TRUE(n.contains(key)) << key;
  EXPECT_GE(n.at("left_out").size(), 5u);
  EXPECT_LT(n.at("gpu_bytes_without").get<double>(), n.at("gpu_bytes_with").get<double>());
  EXPECT_LE(n.at("max_difference").get<double>(), 1e-5 * n.at("max_radiance").get<double>());
  EXPECT_EQ(n.at("picture").at("verdict"), "too few pictures to tell");
  // Path tracing is timed to the same error, and what runs alike differ by is no saving.
  ASSERT_EQ(RUN_LUCERNA("bench features '" + path("scene.obj") + "' --size 16x8 --frames 6 --technique path --json '" +
                        path("n.json") + "'")
                .exitCode,
            0);
  const auto p = json("n.json");
  EXPECT_EQ(p.at("samples"), 8);
  EXPECT_GT(p.at("variance_with").get<double>(), 0.0);
  for (const auto& saving : {p.at("picture"), p.at("compile")}) {
    EXPECT_LE(saving.at("low").get<double>(), saving.at("ratio").get<double>());
    EXPECT_GE(saving.at("high").get<double>(), saving.at("ratio").get<double>());
    const double apart = std::abs(std::log(saving.at("ratio").get<double>()));
    if (apart <= std::log1p(saving.at("same_runs").get<double>())) {
      EXPECT_EQ(saving.at("verdict"), "no difference") << saving;
    }
  }
}

}  // namespace
