// lucerna bench: the published tables stand in the output exactly as they were published, ratios are what they say,
// wrong options are refused.
#include "base/image.hpp"
#include "support/long_tests.hpp"
#include "support/subprocess.hpp"
#include "support/temp_folder.hpp"

#include <fmt/core.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <fstream>
#include <map>
#include <set>
#include <tuple>

namespace {

namespace fs = std::filesystem;
using lucerna::test::RunResult;
using lucerna::test::TempFolder;

const char* kScene =
    "mtllib scene.mtl\n"
    "v -2 0 -2\nv 2 0 -2\nv 2 0 2\nv -2 0 2\nv -2 3 -2\nv 2 3 -2\n"
    "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
    "usemtl white\nf 1/1 4/4 3/3 2/2\nusemtl red\nf 1/1 2/2 6/3 5/4\n";

class Bench : public ::testing::Test {
 protected:
  void SetUp() override {
    std::ofstream(path("scene.obj")) << kScene;
    std::ofstream(path("scene.mtl")) << "newmtl white\nKd 0.8 0.8 0.8\nnewmtl red\nKd 0.7 0.1 0.1\n";
  }
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
  nlohmann::json json(const std::string& name) const { return nlohmann::json::parse(std::ifstream(path(name))); }
  /// Of the VPT original: some forty programs, each of which draws a few pixels. Mesa's compiler optimizes none of
  /// them; pictures are the same to the last bit.
  static RunResult runVpt(const std::string& arguments) {
    return lucerna::test::run("GALLIVM_PERF=nopt '" LUCERNA_BINARY "' bench " + arguments);
  }
  /// Draws one of the pictures of the tables, and makes a checkpoint of all units of it ("whole") in which the thirteen
  /// estimators, the last unit, are taken for measured: they are eleven programs more. What they are is VptEstimators'
  /// in tests/unit, and long tests measure them.
  void takeEstimatorsForMeasured(const std::string& command, int unit, int units) const {
    const RunResult part = runVpt(fmt::format("{} --part {}/{}", command, unit, units));
    ASSERT_EQ(part.exitCode, 0) << part.err;
    nlohmann::json description = json("whole/part.json");
    EXPECT_EQ(description.at("units"), units);
    description["first"] = 0;
    description["last"] = units;
    std::ofstream(path("whole/part.json")) << description;
    std::ofstream(path(fmt::format("whole/{:06}.json", units - 1)))
        << R"({"summary": "", "estimators": [{"estimator": "that was measured before"}]})";
  }
  void expectRefused(const std::string& arguments, const std::vector<std::string>& parts) const {
    const RunResult result = RUN_LUCERNA("bench " + arguments);
    EXPECT_EQ(result.exitCode, 2) << arguments << "\n" << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << arguments << "\n" << result.err;
    for (const std::string& part : parts)
      EXPECT_NE(result.err.find(part), std::string::npos) << "'" << part << "' is not in: " << result.err;
  }

 private:
  TempFolder folder_;
};

struct PublishedFigure {
  const char* table;
  const char* setting;
  int grids;
  const char* stage;
  const char* gpu;
  double ms;
  auto key() const {
    return std::tuple<std::string, std::string, int, std::string, std::string>(table, setting, grids, stage, gpu);
  }
};

// RSM, injection, propagation of one grid, then of three.
std::vector<PublishedFigure> stagesOf(const char* table, const char* setting, const char* gpu, double rsm,
                                      double inject1, double propagate1, double inject3, double propagate3) {
  return {{table, setting, 1, "RSM", gpu, rsm},
          {table, setting, 1, "injection", gpu, inject1},
          {table, setting, 1, "propagation", gpu, propagate1},
          {table, setting, 3, "RSM", gpu, rsm},
          {table, setting, 3, "injection", gpu, inject3},
          {table, setting, 3, "propagation", gpu, propagate3}};
}

std::vector<PublishedFigure> publishedFigures() {
  const char *nvidia = "NVIDIA GTX 960", *amd = "AMD R9 270";
  std::vector<PublishedFigure> all;
  const auto add = [&](std::vector<PublishedFigure> figures) { all.insert(all.end(), figures.begin(), figures.end()); };
  add(stagesOf("7.2", "8 iterations, blocking", nvidia, 0.274104, 0.375929, 3.3704, 0.999607, 8.75379));
  add(stagesOf("7.2", "8 iterations, blocking", amd, 0.363047, 1.35305, 9.99295, 3.48448, 29.2733));
  add(stagesOf("7.3", "8 iterations, no blocking", nvidia, 0.265721, 0.397134, 3.05226, 0.932677, 7.31519));
  add(stagesOf("7.3", "8 iterations, no blocking", amd, 0.362724, 1.35732, 6.81374, 3.50141, 19.7886));
  add(stagesOf("7.4", "12 iterations, blocking", nvidia, 0.274104, 0.401629, 6.07258, 0.999594, 13.8813));
  add(stagesOf("7.4", "12 iterations, blocking", amd, 0.363047, 1.35242, 15.5127, 3.4849, 45.6326));
  add(stagesOf("7.5", "12 iterations, no blocking", nvidia, 0.265721, 0.399961, 5.02879, 0.96792, 11.3734));
  add(stagesOf("7.5", "12 iterations, no blocking", amd, 0.362724, 1.35757, 10.4721, 3.50252, 30.7741));
  const auto both = [&](const char* table, const char* setting, int grids, double injection, double propagation) {
    add({{table, setting, grids, "injection", nvidia, injection},
         {table, setting, grids, "propagation", nvidia, propagation}});
  };
  both("7.6", "geometry shader, 32^3", 1, 0.375929, 3.3704);
  both("7.6", "geometry shader, 32^3", 3, 0.999607, 8.75379);
  both("7.6", "atomics, 32^3", 1, 0.397899, 3.76333);
  both("7.6", "atomics, 32^3", 3, 0.998954, 10.4171);
  both("7.7", "geometry shader, 64^3", 1, 0.796672, 15.6416);
  both("7.7", "geometry shader, 32^3", 3, 0.999607, 8.75379);
  both("7.7", "atomics, 64^3", 1, 0.44032, 25.0573);
  both("7.7", "atomics, 32^3", 3, 0.998954, 10.4171);
  const auto map = [&](const char* setting, double rsm, double injection) {
    add({{"7.8", setting, 3, "RSM", nvidia, rsm}, {"7.8", setting, 3, "injection", nvidia, injection}});
  };
  map("RSM 128", 0.232448, 0.41984);
  map("RSM 256", 0.246784, 0.999594);
  map("RSM 512", 0.37376, 4.46874);
  add({{"clear", "one channel of a 32^3 grid", 0, "glClearTexImage", "as published", 0.0049},
       {"clear", "one channel of a 32^3 grid", 0, "glTexSubImage3D", "as published", 0.09958}});
  return all;
}

TEST_F(Bench, TablesOfTheLpvOriginalStandBesideOurs) {
  const RunResult result =
      RUN_LUCERNA("bench tables --original lpv " + path("scene.obj") + " --scale 0.04 --quiet --chart " +
                  path("chart.png") + " --json " + path("tables.json"));
  ASSERT_EQ(result.exitCode, 0) << result.err;
  EXPECT_GT(lucerna::readBitmap(path("chart.png")).width, 2 * 760);
  for (const char* text : {"llvmpipe", "Scale    0.04", "of 8^3 where 32^3", "Crytek Sponza", "Speed:", "Bound:"})
    EXPECT_NE(result.out.find(text), std::string::npos) << text;
  const auto tables = json("tables.json");
  std::map<decltype(PublishedFigure{}.key()), double> expected;
  for (const PublishedFigure& figure : publishedFigures()) expected[figure.key()] = figure.ms;
  std::set<decltype(PublishedFigure{}.key())> seen;
  std::set<std::string> fills, names;
  for (const auto& row : tables.at("rows")) {
    const std::tuple key(row.at("table").get<std::string>(), row.at("setting").get<std::string>(),
                         row.value("grids", 0), row.at("stage").get<std::string>(),
                         row.at("published_on").get<std::string>());
    const std::string name = row.at("table").get<std::string>() + " " + row.at("row").get<std::string>();
    ASSERT_TRUE(expected.contains(key)) << row.dump();
    seen.insert(key);
    EXPECT_TRUE(names.insert(name).second) << name << " is there twice";
    EXPECT_EQ(row.at("published").get<double>(), expected.at(key)) << name;
    EXPECT_EQ(row.at("renderer"), tables.at("renderer"));
    fills.insert(row.at("fill").get<std::string>() + "/" + row.at("propagate").get<std::string>());
    if (row.contains("note")) {
      EXPECT_TRUE(row.at("measured").is_null()) << name;
      EXPECT_NE(row.at("note").get<std::string>().find("not here: "), std::string::npos);
      continue;
    }
    const double measured = row.at("measured");
    EXPECT_GT(measured, 0.0) << name;
    EXPECT_DOUBLE_EQ(row.at("ratio").get<double>(), measured / expected.at(key)) << name;
    EXPECT_GT(row.at("count"), 0) << name;
    EXPECT_LE(row.at("spread").at(0), row.at("spread").at(1)) << name;
    if (row.at("statistic") == "median") {
      EXPECT_LE(row.at("spread").at(0), measured) << name;
      EXPECT_GE(row.at("spread").at(1), measured) << name;
    }
  }
  for (const auto& [key, ms] : expected)
    EXPECT_TRUE(seen.contains(key)) << std::get<0>(key) << " " << std::get<1>(key) << " " << std::get<2>(key) << " "
                                    << std::get<3>(key) << " " << std::get<4>(key);
  for (const char* paths :
       {"layered/layered", "atomic/layered", "fixed/layered", "atomic tiles/compute", "fixed tiles/compute", "/"})
    EXPECT_TRUE(fills.contains(paths)) << paths;
  EXPECT_GT(tables.at("speed").at("speedup"), 0.0);
  EXPECT_GT(tables.at("bound").at("over_copy"), 0.0);
}

TEST_F(Bench, PicturesOfTheLpvOriginalAreOneSheet) {
  const RunResult result = RUN_LUCERNA("bench pictures --original lpv " + path("scene.obj") + " --size 96x54 --json " +
                                       path("p.json") + " -o " + path("p.png"));
  ASSERT_EQ(result.exitCode, 0) << result.err;
  const lucerna::Bitmap sheet = lucerna::readBitmap(path("p.png"));
  EXPECT_GT(sheet.width, 3 * 96);
  EXPECT_LT(sheet.width, 4 * 96);
  EXPECT_GT(sheet.height, 6 * 54);
  EXPECT_EQ(json("p.json").at("pictures").size(), 11u);
  // The reflective shadow map's normals: the floor's is up, 0.5 + 0.5 (0, 1, 0).
  int up = 0;
  for (std::size_t i = 0; i < sheet.rgba.size(); i += 4)
    up += sheet.rgba[i] == 128 && sheet.rgba[i + 1] == 255 && sheet.rgba[i + 2] == 128;
  EXPECT_GT(up, 200);
}

TEST_F(Bench, PicturesOfTheVptOriginalAreOneSheet) {
  const RunResult result = runVpt("pictures --original vpt --scale 0.0005 --size 48x27 --quiet --json " +
                                  path("p.json") + " -o " + path("p.png"));
  ASSERT_EQ(result.exitCode, 0) << result.err;
  EXPECT_EQ(json("p.json").at("pictures").size(), 21u);
  const lucerna::Bitmap sheet = lucerna::readBitmap(path("p.png"));
  EXPECT_GE(sheet.width * sheet.height, 21 * 48 * 27);
  // Every tile shows something.
  std::set<std::array<int, 3>> colours;
  for (std::size_t i = 0; i + 3 < sheet.rgba.size(); i += 4)
    colours.insert({sheet.rgba[i], sheet.rgba[i + 1], sheet.rgba[i + 2]});
  EXPECT_GT(colours.size(), 1000u);
}

TEST_F(Bench, VptAsPublishedHasTheCorrectedBeside) {
  const RunResult result =
      runVpt("pictures --original vpt --fidelity original --scale 0.0005 --size 24x14 --quiet --json " +
             path("p.json") + " -o " + path("p.png"));
  ASSERT_EQ(result.exitCode, 0) << result.err;
  const auto pictures = json("p.json").at("pictures");
  ASSERT_EQ(pictures.size(), 2u + 2u * 21u + 1u);  // figure 5.7, each picture twice, the cure of black pixels
  EXPECT_EQ(pictures[0].at("picture"), "5.7 a  grape juice, probability as it is");
  // A series on samples has more in each picture, whatever the scale.
  for (std::size_t i = 0; i < 6; ++i)
    EXPECT_NEAR(pictures[2 + 2 * i].at("spp").get<double>(), static_cast<double>(i + 1), 1e-9)
        << pictures[2 + 2 * i].at("picture");
  const std::string command = "tables --original vpt --fidelity original --scale 0.001 --quiet --json " +
                              path("vpt.json") + " --checkpoint " + path("whole");
  const bool isLong = lucerna::test::longTests();
  if (!isLong) {
    // All but one picture by each estimator is taken for measured, for a picture of the published one. Pictures are
    // drawn above, and VptTablesHoldWhatWasPublished measures them.
    takeEstimatorsForMeasured(command, 6, 43);
    for (int unit = 0; unit < 42; ++unit)
      if (unit != 6 && unit != 27)
        fs::copy_file(path("whole/000006.json"), path(fmt::format("whole/{:06}.json", unit)));
  }
  const RunResult measured = runVpt(command);
  ASSERT_EQ(measured.exitCode, 0) << measured.err;
  const auto tables = json("vpt.json");
  EXPECT_EQ(tables.at("fidelity"), "original");
  EXPECT_EQ(tables.at("rows").size(), 21u + 8u + 21u + 7u);
  if (isLong) {
    EXPECT_EQ(tables.at("estimators")[0].at("estimator"), "original");
    EXPECT_EQ(tables.at("estimators")[2].at("estimator"), "path.distance-without-pdf off");
  } else {
    EXPECT_EQ(tables.at("estimators")[0].at("estimator"), "that was measured before");
  }
  // The published estimator draws the original's file, the corrected one the scene with an area light.
  EXPECT_EQ(tables.at("pictures")[6].at("scene"), "block/milk_original.json");
  EXPECT_EQ(tables.at("pictures")[27].at("scene"), "block/milk.json");
}

TEST_F(Bench, RaysHitWhatEmbreeHits) {
  const RunResult result =
      RUN_LUCERNA("bench rays " + path("scene.obj") + " --rays 4096 --repeats 2 --quiet --json " + path("rays.json"));
  ASSERT_EQ(result.exitCode, 0) << result.err;
  if (result.out.find("built without Embree") != std::string::npos) GTEST_SKIP() << "built without Embree";
  const auto rays = json("rays.json");
  ASSERT_EQ(rays.at("rows").size(), 3u);
  for (const auto& row : rays.at("rows")) {
    EXPECT_GT(row.at("count").get<int>(), 500) << row.dump();
    EXPECT_GT(row.at("mrays_per_s").get<double>(), 0.0) << row.dump();
    EXPECT_LE(row.at("differ").get<int>(), row.at("count").get<int>() / 100) << row.dump();  // rays that graze an edge
  }
  EXPECT_GT(rays.at("embree_mrays_per_s").get<double>(), 0.0);
  EXPECT_GT(rays.at("ratio").get<double>(), 0.0);
}

TEST_F(Bench, WrongOptionsAreRefused) {
  const std::string scene = path("scene.obj");
  expectRefused("", {"subcommand", "bench --help"});
  expectRefused("paint", {"paint", "bench --help"});
  expectRefused("tables " + scene, {"--original"});
  expectRefused("tables --original crytek " + scene, {"crytek", "lpv"});
  expectRefused("tables --original vpt " + scene, {"SCENE", "own scenes"});
  expectRefused("tables --original vpt --scale 2", {"--scale"});
  expectRefused("pictures --original vpt -o " + path("x.png") + " " + scene, {"SCENE", "own scenes"});
  expectRefused("pictures --original vpt --scale 0 -o " + path("x.png"), {"--scale"});
  expectRefused("pictures --original vpt --fidelity published -o " + path("x.png"), {"--fidelity", "original"});
  expectRefused("tables --original vpt --fidelity published", {"--fidelity", "original"});
  expectRefused("tables --original rad --fidelity original", {"--fidelity", "vpt"});
  expectRefused("pictures --original lpv --scale 0.5 -o " + path("x.png") + " " + scene, {"--scale"});
  expectRefused("tables --original lpv --colour red " + scene, {"--colour", "bench tables --help"});
  for (const char* scale : {"0", "-1", "1.5", "nan", "half"})
    expectRefused("tables --original lpv --scale " + std::string(scale) + " " + scene, {"--scale"});
  expectRefused("tables --original lpv --host vulkan " + scene, {"vulkan", "osmesa"});
  expectRefused("tables --original lpv " + path("nothing.obj"), {"nothing.obj"});
  expectRefused("pictures --original lpv " + scene, {"--output"});
  expectRefused("pictures --original lpv -o " + path("x.exr") + " " + scene, {"x.exr", "png"});
  expectRefused("pictures --original lpv --size 4000x4000 -o " + path("x.png") + " " + scene, {"--size", "4000x4000"});
  expectRefused("pictures --original lpv --fidelity exact -o " + path("x.png") + " " + scene,
                {"--fidelity", "exact", "original"});
  expectRefused("pictures --original lpv --exposure 0 -o " + path("x.png") + " " + scene, {"--exposure"});
  expectRefused("pictures --original lpv --camera nowhere -o " + path("x.png") + " " + scene, {"--camera", "nowhere"});
  EXPECT_FALSE(fs::exists(path("x.png")));
}

TEST_F(Bench, VptTablesHoldWhatWasPublished) {
  const std::string command =
      "tables --original vpt --scale 0.001 --quiet --json " + path("vpt.json") + " --checkpoint " + path("whole");
  const bool isLong = lucerna::test::longTests();
  if (!isLong) takeEstimatorsForMeasured(command, 0, 22);
  const RunResult result = runVpt(command);
  ASSERT_EQ(result.exitCode, 0) << result.err;
  EXPECT_NE(result.out.find("Scaled by 0.001: 16x9 pixels instead of 1920x1080"), std::string::npos) << result.out;
  const double published[] = {
      14,    61,    445,   3619,  7289,  14580, 15500, 23300, 36500, 38000, 14500,
      16700, 21900, 24300, 25800, 15100, 23300, 14500, 18500, 27200, 51300};  // ms, figures 5.8 a to 5.20
  const auto tables = json("vpt.json");
  const auto& rows = tables.at("rows");
  ASSERT_EQ(rows.size(), std::size(published) + 7);  // and the preparation of seven scenes
  for (std::size_t i = std::size(published); i < rows.size(); ++i) {
    EXPECT_EQ(rows[i].at("published"), 500.0) << rows[i].at("row");
    EXPECT_GT(rows[i].at("measured").get<double>(), 0.0) << rows[i].at("row");
  }
  for (std::size_t i = 0; i < std::size(published); ++i) {
    EXPECT_EQ(rows[i].at("published"), published[i]) << rows[i].at("row");
    EXPECT_GT(rows[i].at("measured").get<double>(), 0.0) << rows[i].at("row");
    EXPECT_NEAR(rows[i].at("ratio").get<double>(), rows[i].at("measured").get<double>() / published[i],
                1e-9 * rows[i].at("ratio").get<double>());
    const auto& picture = tables.at("pictures")[i];
    // Multiplied up from the samples that were drawn to the published ones.
    const double samples = i < 6 ? std::array{1, 8, 64, 512, 1024, 2048}[i] : i < 17 ? 2048 : 1024;
    const double factor = samples * 1920 * 1080 / (picture.at("spp").get<double>() * 16 * 9);
    EXPECT_NEAR(rows[i].at("measured").get<double>(), picture.at("ms").get<double>() * factor,
                1e-6 * rows[i].at("measured").get<double>());
  }
  if (!isLong) return;
  // The estimator: corrected, as published, and each deviation alone.
  const auto& estimators = tables.at("estimators");
  ASSERT_EQ(estimators.size(), 13u);
  EXPECT_EQ(estimators[0].at("estimator"), "corrected");
  EXPECT_EQ(estimators[0].at("time_ratio"), 1.0);
  EXPECT_EQ(estimators[1].at("estimator"), "original");
  for (const auto& estimator : estimators) {
    EXPECT_GT(estimator.at("ms_a_sample").get<double>(), 0.0) << estimator.dump();
    EXPECT_GT(estimator.at("nrmse").get<double>(), 0.0) << estimator.dump();
    EXPECT_GT(estimator.at("bias_error").get<double>(), 0.0) << estimator.dump();
  }
  // Espresso's paths end early where survivors of roulette are not weighted: another picture from the same numbers.
  EXPECT_NE(estimators[4].at("bias"), estimators[0].at("bias"));
}

}  // namespace
