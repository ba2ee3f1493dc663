// lucerna bench tables --original rad: the published figures stand in it as published, ratios are what they say.
#include "base/image.hpp"
#include "support/subprocess.hpp"
#include "support/temp_folder.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <fstream>
#include <map>

namespace {

using lucerna::test::RunResult;
using lucerna::test::TempFolder;

TEST(BenchRad, TablesHoldWhatWasPublishedAndWhatItIsHere) {
  const TempFolder folder;
  const std::string file = (folder / "t.json").string();
  const RunResult result = RUN_LUCERNA("bench tables --original rad --scale 0.005 --quiet --json '" + file + "'");
  ASSERT_EQ(result.exitCode, 0) << result.err;
  const nlohmann::json json = nlohmann::json::parse(std::ifstream(file));
  EXPECT_NE(result.out.find("extrapolated"), std::string::npos);
  EXPECT_NE(result.out.find("GeForce 7600GT with 256 MB"), std::string::npos);
  // Published, of [RAD2008 tables 4.1 and 4.2].
  const std::map<std::pair<std::string, std::string>, double> published{
      {{"4.1", "100x100, 26360 triangles"}, 280.0 / 60.0},   {{"4.1", "200x200, 26360 triangles"}, 525.0 / 60.0},
      {{"4.1", "500x500, 26360 triangles"}, 2380.0 / 60.0},  {{"4.1", "100x100, 136512 triangles"}, 3500.0 / 60.0},
      {{"4.1", "200x200, 136512 triangles"}, 4900.0 / 60.0}, {{"4.1", "500x500, 136512 triangles"}, 233.0},
      {{"4.1", "100x100, 546048 triangles"}, 583.0},         {{"4.1", "200x200, 546048 triangles"}, 700.0},
      {{"4.1", "500x500, 546048 triangles"}, 1516.0},        {{"4.2", "100x100, 26360 triangles"}, 0.011},
      {{"4.2", "200x200, 26360 triangles"}, 0.020},          {{"4.2", "500x500, 26360 triangles"}, 0.091},
      {{"4.2", "100x100, 136512 triangles"}, 0.026},         {{"4.2", "200x200, 136512 triangles"}, 0.036},
      {{"4.2", "500x500, 136512 triangles"}, 0.102},         {{"4.2", "100x100, 546048 triangles"}, 0.064},
      {{"4.2", "200x200, 546048 triangles"}, 0.077},         {{"4.2", "500x500, 546048 triangles"}, 0.166},
  };
  std::size_t found = 0;
  for (const auto& row : json["rows"]) {
    EXPECT_NEAR(row["ratio"].get<double>(), row["measured"].get<double>() / row["published"].get<double>(), 1e-9);
    EXPECT_GT(row["measured"].get<double>(), 0.0);
    if (row["unit"] == "sweeps") {
      EXPECT_EQ(row["published"], 7);
      EXPECT_GE(row["measured"].get<int>(), 5);
      EXPECT_LE(row["measured"].get<int>(), 12);
      continue;
    }
    const auto at = published.find({row["table"], row["row"]});
    ASSERT_NE(at, published.end()) << row;
    EXPECT_NEAR(row["published"].get<double>(), at->second, 1e-9) << row;
    EXPECT_TRUE(row["extrapolated"].get<bool>());
    // Seven sweeps over all triangles at this rate; five views of the whole scene a hemicube.
    const double triangles = row["triangles"].get<double>(), rate = row["hemicubes_per_s"].get<double>();
    EXPECT_NEAR(row["measured"].get<double>(), row["table"] == "4.1" ? 7.0 * triangles / rate / 60.0 : 7.0 / rate,
                1e-6 * row["measured"].get<double>());
    EXPECT_NEAR(row["mtriangles_per_s"].get<double>(), 5.0 * triangles * rate / 1e6,
                1e-3 * row["mtriangles_per_s"].get<double>());
    ++found;
  }
  EXPECT_EQ(found, published.size());

  // Both boxes, three ways to tell what pixels see; nothing is compared with figures from elsewhere.
  ASSERT_EQ(json["closed_box"].size(), 6u);
  for (const auto& row : json["closed_box"]) {
    EXPECT_TRUE(row["triangles"] == 2028 || row["triangles"] == 25392) << row;
    EXPECT_GE(row["hemicubes"].get<int>(), 16);
    EXPECT_FALSE(row.contains("library_per_s"));
    EXPECT_GT(row["least"].get<double>(), 0.0);
    EXPECT_LE(row["least"].get<double>(), row["hemicubes_per_s"].get<double>());
    EXPECT_LE(row["hemicubes_per_s"].get<double>(), row["most"].get<double>());
  }

  std::map<std::string, double> nrmse;
  for (const auto& row : json["deviations"]) nrmse[row["name"]] = row["nrmse"];
  ASSERT_EQ(nrmse.size(), 7u);
  EXPECT_LT(nrmse["radiosity.published-map=off"], 0.9 * nrmse["as published"]);
  EXPECT_LT(nrmse["all off but radiosity.centroid"], nrmse["as published"]);
}

TEST(BenchRad, PicturesShowWhatTheFiguresShow) {
  const TempFolder folder;
  const std::string file = (folder / "p.json").string(), sheet = (folder / "p.png").string();
  const RunResult result = RUN_LUCERNA("bench pictures --original rad --scale 0.05 --size 96x72 --quiet -o '" + sheet +
                                       "' --json '" + file + "'");
  ASSERT_EQ(result.exitCode, 0) << result.err;
  const nlohmann::json json = nlohmann::json::parse(std::ifstream(file));
  EXPECT_EQ(json["pictures"].size(), 32u);
  // The right map's weights over all five faces come to pi where its middle is 1; the published map gives more, most of
  // it at the faces' rims.
  const double faces = std::pow(0.24 * 72.0, 2.0) / (96.0 * 72.0);
  EXPECT_EQ(json["pictures"][3]["picture"], "the delta form factor: 1/r^4 and b/r^4");
  EXPECT_NEAR(json["pictures"][3]["mean"].get<double>(), M_PI * faces, 0.02 * M_PI * faces);
  EXPECT_GT(json["pictures"][2]["mean"].get<double>(), 1.3 * M_PI * faces);
  std::map<std::string, double> mean;  // by figure, the first word
  for (const auto& picture : json["pictures"]) {
    const std::string label = picture["picture"];
    mean[label.substr(0, label.find(' '))] = picture["mean"];
    EXPECT_GT(picture["mean"].get<double>(), 0.01) << label;
    EXPECT_LT(picture["mean"].get<double>(), 0.95) << label;
  }
  EXPECT_GT(mean["4.5b"], 1.01 * mean["4.5a"]) << "a second sweep brings light";
  EXPECT_NE(mean["3.10a"], mean["3.10b"]);
  EXPECT_NE(mean["3.16a"], mean["3.16b"]) << "packed colours are not what is shown";
  const lucerna::Bitmap bitmap = lucerna::readBitmap(sheet);
  EXPECT_GE(bitmap.width, 4 * 96);
  EXPECT_GE(bitmap.height, 5 * 72);
  for (const char* wrong : {"--scale 0", "--scale 2", "--camera 0,0,0,1,0,0,60"}) {
    const RunResult refused = RUN_LUCERNA("bench pictures --original rad -o '" + sheet + "' " + wrong);
    EXPECT_EQ(refused.exitCode, 2) << wrong;
  }
}

TEST(BenchRad, ProgressiveRefinementIsAheadOnItsWay) {
  const TempFolder folder;
  const std::string file = (folder / "p.json").string(), sheet = (folder / "p.png").string();
  const std::string command = "bench pictures --original rad --progressive --scale 0.2 --size 96x72 --quiet";
  const RunResult result = RUN_LUCERNA(command + " -o '" + sheet + "' --json '" + file + "'");
  ASSERT_EQ(result.exitCode, 0) << result.err;
  const nlohmann::json json = nlohmann::json::parse(std::ifstream(file));
  ASSERT_EQ(json["pictures"].size(), 12u);
  std::map<std::string, std::map<int, double>> error;  // by solver and hemicubes
  for (const auto& picture : json["pictures"]) error[picture["solver"]][picture["hemicubes"]] = picture["error"];
  for (const auto& [solver, errors] : error) {
    ASSERT_EQ(errors.size(), 4u) << solver;
    EXPECT_GT(errors.at(1), errors.at(10)) << solver;
    EXPECT_GT(errors.at(10), errors.at(100)) << solver;
    EXPECT_GT(errors.at(100), errors.at(1000)) << solver;
  }
  for (const int hemicubes : {1, 10}) {
    EXPECT_LT(error["progressive"][hemicubes], 0.9 * error["jacobi"][hemicubes]);
    EXPECT_LT(error["progressive"][hemicubes], 0.9 * error["gauss-seidel"][hemicubes]);
  }
  EXPECT_LT(error["gauss-seidel"][100], error["jacobi"][100]);
  EXPECT_LT(error["progressive"][1000], 1e-3);
  EXPECT_EQ(RUN_LUCERNA("bench pictures --original lpv --progressive -o '" + sheet + "'").exitCode, 2);
}

TEST(BenchRad, ScenesAreRefused) {
  const RunResult result = RUN_LUCERNA("bench tables --original rad some.obj");
  EXPECT_EQ(result.exitCode, 2);
  EXPECT_NE(result.err.find("makes its own models"), std::string::npos) << result.err;
}

}  // namespace
