// The walkthrough's window, driven by recorded input (demo/walk/input_file.hpp): on the off-screen test host, and in a
// window of a virtual display. LUCERNA_LONG_TESTS=1: every control, in some thousand frames.
#include "base/image.hpp"
#include "scene/key_frames.hpp"
#include "support/long_tests.hpp"
#include "support/subprocess.hpp"
#include "support/temp_folder.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

namespace {

namespace fs = std::filesystem;
using lucerna::test::run;
using lucerna::test::RunResult;
using lucerna::test::TempFolder;

// Two walls and a floor, a lamp, two views.
const char* kWindowScene = R"({"model": "room.obj", "sun": {"direction": [-0.5, -1, -0.3], "irradiance": [3, 3, 3]},
  "cameras": [{"name": "first", "position": [1.5, 1.2, 1.8], "target": [0, 0.6, 0], "fov": 55}, {"name": "second",
  "position": [-1, 1, 1.8], "target": [0, 0.5, 0], "fov": 50}]})";
const char* kRoom =
    "mtllib room.mtl\n"
    "v -2 0 -2\nv 2 0 -2\nv 2 0 2\nv -2 0 2\nv -2 3 -2\nv 2 3 -2\nv -2 3 2\n"
    "usemtl white\nf 1 4 3 2\nusemtl red\nf 1 2 6 5\nusemtl white\nf 1 5 7 4\n";
const char* kWindowMaterials = "newmtl white\nKd 0.8 0.8 0.8\nnewmtl red\nKd 0.7 0.1 0.1\n";

class Window : public ::testing::Test {
 protected:
  void SetUp() override {
    write("room.json", kWindowScene);
    write("room.obj", kRoom);
    write("room.mtl", kWindowMaterials);
    write("path.txt", "p 1.5 1.2 1.8 d -0.6 -0.3 -0.7 u 0 1 0\np -1 1 1.8 d 0.4 -0.2 -0.8 u 0 1 0\n");
  }
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
  void write(const std::string& name, const std::string& text) const { std::ofstream(path(name)) << text; }
  std::string read(const std::string& name) const {
    std::ostringstream text;
    text << std::ifstream(path(name), std::ios::binary).rdbuf();
    return text.str();
  }
  /// Plays an input file in a small window; GL errors end the command with exit code 1.
  RunResult play(const std::string& input, const std::string& arguments = "", const std::string& before = "",
                 const std::string& size = "128x72") const {
    return run("cd '" + folder_.path().string() + "' && " + before + " LUCERNA_VERBOSE=1 LUCERNA_REFERENCES=" +
               path("references") + " '" LUCERNA_BINARY "' walk room.json --keys path.txt --size " + size +
               " --set lpv.cells=8 --set cache.cells=8 --set cache.samples=64 --set radiosity.edge=1 --play-input '" +
               input + "' --json walk.json " + arguments);
  }
  /// Runs a script with the program and an argument on a display of its own.
  RunResult runInDisplay(const std::string& script, const std::string& argument) const {
    return run("cd '" + folder_.path().string() + "' && timeout 200 xvfb-run -a -s '-screen 0 1280x800x24 -noreset' " +
               "bash " + script + " '" LUCERNA_BINARY "' '" + argument + "'");
  }
  static std::string kept(const std::string& name) { return LUCERNA_SOURCE_DIR "/tests/input/" + name; }
  nlohmann::json json() const { return nlohmann::json::parse(std::ifstream(path("walk.json"))); }

 private:
  TempFolder folder_;
};

/// Lines of a verbose run that tell of GL errors or hazards.
std::string glComplaints(const std::string& err) {
  std::istringstream lines(err);
  std::string line, found;
  while (std::getline(lines, line))
    if (line.find("OpenGL error: ") != std::string::npos || line.find("OpenGL: ") != std::string::npos)
      found += line + "\n";
  return found;
}

TEST_F(Window, EveryKeyDoesItsWork) {
  const RunResult result = play(kept("keys.txt"), "--shots shots");
  ASSERT_EQ(result.exitCode, 0) << result.err;
  EXPECT_EQ(glComplaints(result.err), "");
  // F12: a PNG and an HDR of the window's size, with what made them inside.
  EXPECT_EQ(lucerna::readImage(path("shots/room_0001.hdr")).width, 128);
  EXPECT_EQ(lucerna::readBitmap(path("shots/room_0001.png")).height, 72);
  for (const char* file : {"shots/room_0001.hdr", "shots/room_0001.png"})
    for (const char* part :
         {"render", "room.json", "--technique direct", "picture.reprojection=off", "--camera ", "exposure "})
      EXPECT_NE(read(file).find(part), std::string::npos) << file << ": " << part;
}

// Minutes of a core of software GL: most changes make the technique anew. Controls that a choice takes away are told as
// gone.
TEST_F(Window, EveryControlOnce) {
  if (!lucerna::test::longTests()) GTEST_SKIP() << "LUCERNA_LONG_TESTS is not set";
  const RunResult result = play(kept("every_control.txt"), "", "", "320x240");
  ASSERT_EQ(result.exitCode, 0) << result.err;
  EXPECT_EQ(glComplaints(result.err), "");
  const auto window = json().at("window");
  const auto controls = window.at("controls").get<std::vector<std::string>>(),
             touched = window.at("touched").get<std::vector<std::string>>();
  EXPECT_GT(controls.size(), 199u);
  EXPECT_GE(json().at("frames"), 1000);
  for (const char* label : {"Technique A/technique: rsm", "Compare/layout: wipe", "Light/sun height", "Camera/second",
                            "Timings/begin again", "Record and window/add key frame"})
    EXPECT_NE(std::find(touched.begin(), touched.end(), label), touched.end()) << label;
  // What went away is settings of a technique that another control has left.
  const auto gone = window.at("gone").get<std::vector<std::string>>();
  EXPECT_LT(gone.size(), controls.size() / 8);
  for (const std::string& label : gone) EXPECT_TRUE(label.starts_with("Settings and deviations/")) << label;
  for (const std::string& label : controls)
    EXPECT_TRUE(std::find(touched.begin(), touched.end(), label) != touched.end() ||
                std::find(gone.begin(), gone.end(), label) != gone.end())
        << label << " was never touched";
}

// The picture of a stage: as bright as it needs to be, and another than the frame's.
TEST_F(Window, DebugViewsShowWhatStagesMade) {
  write("input.txt",
        "1 key R\n6 save frame.png\n7 touch Debug view\n8 touch Debug view/picture of\n9 touch Debug view/picture of: "
        "rsm 1 flux\n10 save flux.png\n11 touch Debug view/picture of\n12 touch Debug view/picture of: normals\n"
        "13 save normals.png\n");
  const RunResult result =
      play(path("input.txt"), "--technique rsm --set rsm.samples=4 --set rsm.interpolate=off", "", "700x400");
  ASSERT_EQ(result.exitCode, 0) << result.err;
  EXPECT_EQ(glComplaints(result.err), "");
  const auto brightest = [&](const char* name) {
    const lucerna::Bitmap picture = lucerna::readBitmap(path(name));
    int most = 0;
    for (int y = 50; y < 300; ++y)  // beside the panel and the hint
      for (int x = 50; x < 350; ++x)
        most = std::max<int>(most,
                             picture.rgba[4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) +
                                               static_cast<std::size_t>(x))]);
    return most;
  };
  EXPECT_GT(brightest("flux.png"), 200);
  EXPECT_GT(brightest("normals.png"), 120);
  EXPECT_NE(read("flux.png"), read("frame.png"));
  EXPECT_NE(read("normals.png"), read("flux.png"));
}

// The pixel under the cursor: its light in the file that the button writes, its lines in the picture.
TEST_F(Window, APixelIsAskedWhatLitIt) {
  write("input.txt",
        "1 key R\n4 save before.png\n5 cursor 200.5 250.5\n6 key I\n10 touch Pixel/export as JSON\n12 save lines.png\n"
        "13 touch Pixel/draw its light\n15 save hidden.png\n16 touch Pixel/forget\n"
        "17 touch Pixel/inspect by clicking\n18 click 100 300\n40 touch Pixel/export as JSON\n");
  const RunResult result =
      play(path("input.txt"), "--technique rsm --set rsm.samples=4 --set rsm.interpolate=off --shots .", "", "700x400");
  ASSERT_EQ(result.exitCode, 0) << result.err;
  EXPECT_EQ(glComplaints(result.err), "");
  const auto file = nlohmann::json::parse(std::ifstream(path("room_pixel_200_250.json")));
  EXPECT_EQ(file.at("technique"), "rsm");
  double shares = 0.0;
  for (const auto& share : file.at("shares")) shares += share.at("share").get<double>();
  EXPECT_NEAR(shares, 1.0, 0.01);
  EXPECT_TRUE(fs::exists(path("room_pixel_100_300.json")))
      << "a click asks, too, in the frame in which it leaves the panel";
  // Yellow lines and a green cross, where walls are white and red.
  const auto lineColours = [&](const char* name) {
    const lucerna::Bitmap picture = lucerna::readBitmap(path(name));
    int count = 0;
    for (std::size_t i = 0; i < picture.rgba.size(); i += 4)
      count += static_cast<int>(i / 4) % picture.width < 380 && picture.rgba[i + 1] > 180 && picture.rgba[i] < 100;
    return count;
  };
  EXPECT_GT(lineColours("lines.png"), 10);
  EXPECT_EQ(lineColours("hidden.png"), 0);
  EXPECT_EQ(lineColours("before.png"), 0);
}

// The cursor at whole numbers, a pixel's upper left corner, means that pixel, as anywhere else in it: for the question
// what lit it, and for the magnifier.
TEST_F(Window, TheCursorMeansThePixelThatItIsIn) {
  write("input.txt",
        "1 key R\n2 key Z\n3 cursor 120 315\n5 save corner.png\n6 cursor 120.9 315.9\n8 save end.png\n"
        "9 cursor 120 316\n11 save below.png\n12 key Z\n13 cursor 100 0\n14 key I\n16 touch Pixel/export as JSON\n"
        "18 cursor 200 250\n19 key I\n21 touch Pixel/export as JSON\n"
        "23 cursor 300.9 260.9\n24 key I\n26 touch Pixel/export as JSON\n");
  const RunResult result =
      play(path("input.txt"), "--technique direct --set picture.samples=1 --shots .", "", "800x700");
  ASSERT_EQ(result.exitCode, 0) << result.err;
  for (const char* pixel : {"100_0", "200_250", "300_260"})
    EXPECT_TRUE(fs::exists(path(std::string("room_pixel_") + pixel + ".json"))) << pixel;
  const auto magnified = [&](const char* name) {  // within 70 pixels of pixel 120, 315, at the end of a wall
    const lucerna::Bitmap picture = lucerna::readBitmap(path(name));
    std::vector<std::uint8_t> part;
    for (int y = 245; y < 385; ++y)
      for (int x = 50; x < 190; ++x)
        part.push_back(picture.rgba[4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) +
                                         static_cast<std::size_t>(x))]);
    return part;
  };
  EXPECT_EQ(magnified("corner.png"), magnified("end.png"));
  EXPECT_NE(magnified("corner.png"), magnified("below.png"));
}

// Counts a pixel instead of the picture, and lobes and boxes in the scene. The short form has one that counts
// and one that is drawn into the scene.
TEST_F(Window, DebugViewsOfTheSceneItself) {
  const bool isLong = lucerna::test::longTests();
  const std::string first =
      "1 key R\n3 save frame.png\n4 touch Debug view\n5 touch Debug view/count of\n6 touch Debug view/count of: "
      "surfaces a pixel\n7 save overdraw.png\n";
  const std::string visits =
      "8 touch Debug view/count of\n9 touch Debug view/count of: visits a ray\n10 save visits.png\n"
      "10 touch Debug view/white is\n";
  const std::string lobes =
      "11 touch Debug view/count of\n12 touch Debug view/count of: nothing\n"
      "13 touch Debug view/in the scene\n14 touch Debug view/in the scene: lobes of cells\n15 save lobes.png\n";
  const std::string geometry =
      "15 touch Debug view/cascade\n15 touch Debug view/at most\n16 touch Debug view/in the scene\n"
      "17 touch Debug view/in the scene: geometry volume\n18 save geometry.png\n";
  write("input.txt", first + (isLong ? visits : "") + lobes + (isLong ? geometry : ""));
  const RunResult result = play(path("input.txt"), "--technique lpv --set lpv.blocking=rsm", "", "700x400");
  ASSERT_EQ(result.exitCode, 0) << result.err;
  EXPECT_EQ(glComplaints(result.err), "");
  const auto pixels = [&](const char* name) {  // of the picture, beside the panel and above the hint
    const lucerna::Bitmap picture = lucerna::readBitmap(path(name));
    std::vector<std::uint8_t> part;
    for (int y = 50; y < 300; ++y)
      for (int x = 0; x < 380; ++x)
        for (int c = 0; c < 3; ++c)
          part.push_back(picture.rgba[4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) +
                                           static_cast<std::size_t>(x)) +
                                      static_cast<std::size_t>(c)]);
    return part;
  };
  const auto frame = pixels("frame.png");
  std::vector<const char*> names{"overdraw.png", "lobes.png"};
  if (isLong) names.insert(names.end(), {"visits.png", "geometry.png"});
  for (const char* name : names) EXPECT_NE(pixels(name), frame) << name;
}

// The steps' light: all of it after none; clamped lobes gain at most 1.138208 in the first step
// (shaders/lpv/reflect.comp); then less, as it leaves the grid.
TEST_F(Window, StepsOfPropagationAndBoxesOfTheHierarchyAreShown) {
  write(
      "input.txt",
      "1 key R\n2 touch Timings\n3 touch Compare\n4 touch Debug view\n20 save frame.png\n"
      "21 touch Debug view/in the scene\n22 touch Debug view/in the scene: boxes of the hierarchy\n40 save boxes.png\n"
      "41 touch Debug view/in the scene\n42 touch Debug view/in the scene: nothing\n"
      "43 touch Debug view/measure the steps of propagation\n60 save step.png\n");
  const RunResult result = play(path("input.txt"), "--technique lpv", "", "800x400");
  ASSERT_EQ(result.exitCode, 0) << result.err;
  EXPECT_EQ(glComplaints(result.err), "");
  const auto amber = [&](const char* name) {
    const lucerna::Bitmap picture = lucerna::readBitmap(path(name));
    int count = 0;
    for (std::size_t i = 0; i < picture.rgba.size(); i += 4)
      count += picture.rgba[i + 1] > 130 && picture.rgba[i + 1] > picture.rgba[i] + 60 &&
               picture.rgba[i + 1] > picture.rgba[i + 2] + 60;
    return count;
  };
  EXPECT_EQ(amber("frame.png"), 0);
  EXPECT_GT(amber("boxes.png"), 50) << "leaves are green";
  EXPECT_TRUE(read("step.png") != read("frame.png"));
  const std::vector<double> flux = json().at("window").at("flux_by_step");
  ASSERT_EQ(flux.size(), 9u);
  EXPECT_EQ(flux[0], 1.0);
  for (std::size_t k = 1; k < flux.size(); ++k) {
    EXPECT_LT(flux[k], flux[k - 1] * (k == 1 ? 1.1383 : 1.0)) << k;
    EXPECT_GT(flux[k], 0.0) << k;
  }
}

// The hemicube of the patch in the middle, and that of one that is clicked on; its pixels' weights give the share of
// the hemisphere that shows fronts. The curve of the solution falls to the error that was asked for.
TEST_F(Window, HemicubesAndTheResidualAreShown) {
  write("input.txt",
        "1 key R\n2 touch Timings\n3 touch Compare\n4 touch Debug view\n20 save frame.png\n"
        "21 touch Debug view/hemicube of the middle\n40 save middle.png\n41 touch Debug view/back to the picture\n"
        "60 save back.png\n61 touch Debug view/hemicubes by clicking\n80 click 100 330\n84 save clicked.png\n");
  const RunResult result = play(path("input.txt"),
                                "--technique radiosity --set radiosity.solver=progressive "
                                "--set radiosity.visibility=rays --set radiosity.edge=0.7",
                                "", "800x400");
  ASSERT_EQ(result.exitCode, 0) << result.err;
  EXPECT_EQ(glComplaints(result.err), "");
  const auto difference = [&](const char* one, const char* other) {  // beside the panel and its hints
    const lucerna::Bitmap a = lucerna::readBitmap(path(one)), b = lucerna::readBitmap(path(other));
    double sum = 0.0;
    for (int y = 0; y < 340; ++y)
      for (int x = 0; x < 380; ++x) {
        const std::size_t at = 4 * static_cast<std::size_t>(y * a.width + x);
        sum += std::abs(a.rgba[at + 1] - b.rgba[at + 1]);
      }
    return sum / (340.0 * 380.0);
  };
  EXPECT_LT(difference("back.png", "frame.png"), 1.0);
  for (const char* name : {"middle.png", "clicked.png"}) EXPECT_GT(difference(name, "frame.png"), 10.0) << name;
  EXPECT_GT(difference("clicked.png", "middle.png"), 5.0);
  const auto window = json().at("window");
  EXPECT_GT(window.at("hemicube").at("fronts").get<double>(), 0.02);
  EXPECT_LT(window.at("hemicube").at("fronts").get<double>(), 0.6) << "the room has two walls";
  const std::vector<std::array<double, 2>> curve = window.at("residuals");
  ASSERT_GT(curve.size(), 4u);
  for (std::size_t i = 1; i < curve.size(); ++i) EXPECT_GT(curve[i][0], curve[i - 1][0]);
  EXPECT_LT(curve.back()[1], 1e-3);
  EXPECT_GT(curve.front()[1], 10.0 * curve.back()[1]);
}

// Disks where light is kept, while the picture below them stays as it is.
TEST_F(Window, CacheRecordsAreDrawnInTheScene) {
  write("input.txt",
        "1 key R\n2 touch Debug view\n12 save frame.png\n13 touch Debug view/in the scene\n14 touch Debug view/in the "
        "scene: cache records\n15 save records.png\n");
  const RunResult result = play(path("input.txt"), "--technique irradiance-cache", "", "700x400");
  ASSERT_EQ(result.exitCode, 0) << result.err;
  EXPECT_EQ(glComplaints(result.err), "");
  const lucerna::Bitmap frame = lucerna::readBitmap(path("frame.png")),
                        records = lucerna::readBitmap(path("records.png"));
  int changed = 0, count = 0;
  for (int y = 0; y < 300; ++y)
    for (int x = 0; x < 380; ++x, ++count) {
      const auto at =
          4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(frame.width) + static_cast<std::size_t>(x));
      changed += std::abs(frame.rgba[at] - records.rgba[at]) > 16;
    }
  EXPECT_GT(changed, count / 100);
  EXPECT_LT(changed, count / 2);
}

// The lamp's axis along x is dragged: the lamp is where it was let go, and another picture is made.
TEST_F(Window, LampsAreDraggedAlongTheirAxes) {
  write("room.json", R"({"model": "room.obj", "points": [{"position": [0, 1, 0], "intensity": [5, 5, 5]}],
    "cameras": [{"name": "first", "position": [0, 1, 4], "target": [0, 1, 0], "fov": 60}]})");
  write("path.txt", "p 0 1 4 d 0 0 -1 u 0 1 0 f 60\np 0 1 4 d 0 0 -1 u 0 1 0.001 f 60\n");
  // The lamp is in the middle of the picture, 490 x 700 beside the panel; the axis goes to the right from there.
  write("input.txt",
        "1 key R\n2 touch Light\n3 touch Light/move lamps in the picture\n30 save before.png\n31 cursor 265 350\n"
        "32 press left\n34 cursor 365 350\n36 release left\n40 save after.png\n");
  const RunResult result = play(path("input.txt"), "--technique direct", "", "800x700");
  ASSERT_EQ(result.exitCode, 0) << result.err;
  EXPECT_EQ(glComplaints(result.err), "");
  const auto lamps = json().at("window").at("lamps");
  ASSERT_EQ(lamps.size(), 1u);
  // 100 pixels of 700 over the height 2 tan(30 degrees) 4.
  EXPECT_NEAR(lamps.at(0).at(0).get<double>(), 100.0 / 700.0 * 2.0 * std::tan(M_PI / 6.0) * 4.0, 0.05);
  EXPECT_NEAR(lamps.at(0).at(1).get<double>(), 1.0, 1e-9);
  EXPECT_NE(read("after.png"), read("before.png"));
}

// Each step of the drag makes the technique anew, with a note over the picture meanwhile. The slider stays held through
// all of it: its last value is the end of its range, and what the cursor does after the release changes nothing.
TEST_F(Window, TheSunIsDraggedThroughAllSteps) {
  write("input.txt",
        "1 key R\n2 touch Light\n3 touch Light/sun azimuth\n30 press left\n32 cursor 590 360\n34 cursor 600 400\n"
        "36 cursor 610 420\n38 cursor 799 420\n40 release left\n42 cursor 520 350\n44 save after.png\n");
  const RunResult result = play(path("input.txt"), "--technique lpv", "", "800x700");
  ASSERT_EQ(result.exitCode, 0) << result.err;
  EXPECT_EQ(glComplaints(result.err), "");
  const auto sun = json().at("window").at("sun");
  EXPECT_NEAR(sun.at(0).get<double>(), 0.0, 1e-5);
  // The scene's sun comes from x 0.5, y 1, z 0.3; its height stays.
  EXPECT_NEAR(sun.at(2).get<double>(), -std::hypot(0.5, 0.3) / std::hypot(0.5, 1.0, 0.3), 1e-5);
  EXPECT_NEAR(sun.at(1).get<double>(), -1.0 / std::hypot(0.5, 1.0, 0.3), 1e-5);
}

// A drag is one edit, however many steps it had.
TEST_F(Window, LightIsUndoneAndMadeAgain) {
  const auto sunAfter = [&](const std::string& more) {
    write("input.txt",
          "1 key R\n2 touch Light\n3 touch Light/sun azimuth\n30 press left\n32 cursor 590 360\n"
          "36 cursor 610 420\n38 cursor 799 420\n40 release left\n" +
              more);
    const RunResult result = play(path("input.txt"), "--technique direct", "", "800x700");
    EXPECT_EQ(result.exitCode, 0) << result.err;
    return json().at("window").at("sun");
  };
  const auto turned = sunAfter("44 cursor 10 10\n");
  const auto before =
      sunAfter("44 key control+Z\n45 key control+Z\n50 cursor 10 10\n");  // the click of touch, and the drag
  EXPECT_NEAR(before.at(0).get<double>(), -0.5 / std::hypot(0.5, 1.0, 0.3), 1e-6);
  EXPECT_EQ(sunAfter("44 key control+Z\n45 key control+Z\n46 key control+Y\n47 key control+shift+Z\n50 cursor 10 10\n"),
            turned);
}

// Escape closes what is open, then asks; Escape again stays, Enter quits.
TEST_F(Window, EscapeClosesListsAndHelpBeforeItAsks) {
  write("input.txt",
        "1 key R\n2 touch Timings\n3 touch Technique A/technique\n40 save list.png\n41 key escape\n44 save after.png\n"
        "45 key F1\n48 save help.png\n49 key escape\n52 save closed.png\n53 key escape\n56 save asks.png\n"
        "57 key escape\n60 save stays.png\n61 key escape\n63 key enter\n70 save never.png\n");
  const RunResult result = play(path("input.txt"), "--technique direct", "", "800x700");
  ASSERT_EQ(result.exitCode, 0) << result.err;
  const auto controls = json().at("window").at("controls");
  EXPECT_EQ(std::count(controls.begin(), controls.end(), "Question/quit (Enter)"), 1);
  for (const char* open : {"list.png", "help.png", "asks.png"}) EXPECT_TRUE(read(open) != read("after.png")) << open;
  for (const char* shut : {"closed.png", "stays.png"}) EXPECT_TRUE(read(shut) == read("after.png")) << shut;
  EXPECT_FALSE(fs::exists(path("never.png")));
}

// About what is in the middle: that point stays where it is, at the same distance.
TEST_F(Window, TheMouseOrbitsPansAndDollies) {
  write("room.json", R"({"model": "room.obj", "sun": {"direction": [-0.5, -1, -0.3], "irradiance": [3, 3, 3]},
    "cameras": [{"name": "first", "position": [0, 1, 3], "target": [0, 1, -2], "fov": 60}]})");
  write("path.txt", "p 0 1 3 d 0 0 -1 u 0 1 0 f 60\np 0 1 3 d 0 0 -1 u 0 1 0.001 f 60\n");
  const auto viewAfter = [&](const std::string& mouse) {
    write("input.txt", "1 key R\n2 key C\n4 cursor 200 200\n" + mouse +
                           "30 key K\n31 key K\n"
                           "32 touch Record and window\n33 touch Record and window/write\n");
    const RunResult result = play(path("input.txt"), "--technique direct", "", "800x700");
    EXPECT_EQ(result.exitCode, 0) << result.err;
    return lucerna::readKeyFrames(path("key_frames.txt")).camera.front();
  };
  const glm::dvec3 pivot(0.0, 1.0, -2.0);
  const auto orbited = viewAfter("6 press left\n8 cursor 150 180\n10 release left\n");
  EXPECT_NEAR(glm::length(orbited.position - pivot), 5.0, 0.02);
  EXPECT_NEAR(glm::length(orbited.position + 5.0 * orbited.direction - pivot), 0.0, 0.02);
  EXPECT_GT(orbited.position.x, 1.0);
  const auto panned = viewAfter("6 press middle\n8 cursor 270 200\n10 release middle\n");
  EXPECT_NEAR(panned.position.x, -70.0 / 700.0 * 2.0 * std::tan(M_PI / 6.0) * 5.0, 0.02);
  EXPECT_NEAR(panned.position.z, 3.0, 1e-6);
  const auto nearer = viewAfter("6 wheel 2\n");
  EXPECT_NEAR(nearer.position.z, -2.0 + 5.0 * 0.85 * 0.85, 0.02);
}

// Without ffmpeg a line says so; with one, it is given every picture. Here one stands in for it that counts bytes.
TEST_F(Window, VideosGoToFfmpeg) {
  write("input.txt", "1 key R\n2 key V\n30 key V\n32 key F2\n");
  const RunResult without = play(path("input.txt"), "--technique direct --shots .", "PATH=/nowhere");
  ASSERT_EQ(without.exitCode, 0) << without.err;
  const auto messagesOf = [&] { return json().at("window").at("messages").dump(); };
  EXPECT_NE(messagesOf().find("ffmpeg cannot be started"), std::string::npos) << messagesOf();
  write("ffmpeg", "#!/bin/sh\nfor last; do :; done\necho \"$@\" >\"$last\"\nwc -c >>\"$last\"\n");
  fs::permissions(path("ffmpeg"), fs::perms::owner_all);
  const RunResult with = play(path("input.txt"), "--technique direct --shots .", "PATH=.:$PATH");
  ASSERT_EQ(with.exitCode, 0) << with.err;
  EXPECT_NE(messagesOf().find("room_video_0001.mp4: 14 pictures"), std::string::npos) << messagesOf();
  std::ifstream file(path("room_video_0001.mp4"));
  std::string arguments;
  long bytes = 0;
  std::getline(file, arguments);
  file >> bytes;
  EXPECT_NE(arguments.find("-video_size 128x72"), std::string::npos) << arguments;
  EXPECT_EQ(bytes, 14L * 128 * 72 * 4);  // 28 frames of 1/60 s, 30 pictures a second
  // The panel's button does the same, and is dead without ffmpeg.
  write("input.txt",
        "1 key R\n2 touch Record and window\n3 touch Record and window/record a video\n20 touch Record and "
        "window/end the video\n");
  const RunResult byButton = play(path("input.txt"), "--technique direct --shots .", "PATH=.:$PATH", "640x480");
  ASSERT_EQ(byButton.exitCode, 0) << byButton.err;
  EXPECT_NE(messagesOf().find("room_video_0002.mp4: "), std::string::npos) << messagesOf();
  write("input.txt", "1 key R\n2 touch Record and window\n3 touch Record and window/record a video\n20 key F2\n");
  const RunResult dead = play(path("input.txt"), "--technique direct --shots .", "PATH=/nowhere", "640x480");
  ASSERT_EQ(dead.exitCode, 0) << dead.err;
  EXPECT_EQ(messagesOf().find("video"), std::string::npos) << messagesOf();
}

TEST_F(Window, RenderDocIsAskedForOrSaidToBeMissing) {
  if (run("ldconfig -p | grep -q librenderdoc.so").exitCode == 0) GTEST_SKIP() << "RenderDoc is installed";
  write("input.txt", "1 key control+F11\n3 key F2\n");
  const RunResult inside = play(path("input.txt"), "--technique direct");
  ASSERT_EQ(inside.exitCode, 0) << inside.err;
  EXPECT_NE(json().at("window").at("messages").dump().find("RenderDoc is missing"), std::string::npos);
  const RunResult asked = play(path("input.txt"), "--technique direct --capture 2");
  EXPECT_EQ(asked.exitCode, 3);
  EXPECT_NE(asked.err.find("librenderdoc.so"), std::string::npos) << asked.err;
}

TEST_F(Window, SizesOfAllKinds) {
  const RunResult result = play(kept("resizes.txt"));
  ASSERT_EQ(result.exitCode, 0) << result.err;
  EXPECT_EQ(glComplaints(result.err), "");
}

// While the camera rests the reference comes, and the picture's error with its interval; what was sampled is in the
// cache for the next time.
TEST_F(Window, TheReferenceComesWhileTheCameraRests) {
  write("input.txt", "1 key R\n2 key T\n100 key F2\n");
  const RunResult result = play(path("input.txt"), "--technique direct", "", "64x36");
  ASSERT_EQ(result.exitCode, 0) << result.err;
  const auto reference = json().at("window").at("reference");
  EXPECT_GE(reference.at("samples"), 64) << reference;
  const double value = reference.at("a").at("nrmse"), low = reference.at("a").at("low"),
               high = reference.at("a").at("high");
  EXPECT_GT(value, 0.05) << "direct light alone lacks what surfaces throw on each other";
  EXPECT_LE(low, value);
  EXPECT_LE(value, high);
  EXPECT_LT(high - low, 0.5 * value);
  EXPECT_LT(reference.at("a").at("bias"), 0.0);
  EXPECT_FALSE(fs::is_empty(path("references")));
}

// A scene that moves has no reference of now and no error, also where it had both while its time was held.
TEST_F(Window, TheReferenceIsMovingWhileTheTimeRuns) {
  write("room.json", R"({"model": "room.obj", "environment": null,
      "sun": {"direction": {"times": [0, 60], "values": [[0, -1, 0.1], [1, -1, 0]]}, "irradiance": [3, 3, 3]}})");
  for (const bool holds : {false, true}) {
    write("input.txt", std::string("1 key R\n2 key T\n3 key P\n") + (holds ? "" : "80 key P\n") + "90 key F2\n");
    const RunResult result = play(path("input.txt"), "--technique direct", "", "32x18");
    ASSERT_EQ(result.exitCode, 0) << result.err;
    const auto reference = json().at("window").value("reference", nlohmann::json::object());
    EXPECT_EQ(reference.contains("a"), holds) << reference;
  }
}

// Errors have a colour scale in the picture, from blue over white to red; it is drawn by the colours of the errors.
TEST_F(Window, ErrorsHaveAColourScaleInThePicture) {
  write(
      "input.txt",
      "1 key R\n1 key F2\n2 key T\n60 save picture.png\n200 key H\n201 save error.png\n202 key X\n203 save wipe.png\n");
  const RunResult result = play(path("input.txt"), "--technique direct", "", "640x120");
  ASSERT_EQ(result.exitCode, 0) << result.err;
  const auto isBar = [&](const std::string& file, int x, std::array<int, 3> colour) {
    const lucerna::Bitmap shown = lucerna::readBitmap(path(file));
    const std::size_t at = 4 * (std::size_t{48} * static_cast<std::size_t>(shown.width) + static_cast<std::size_t>(x));
    for (std::size_t c = 0; c < 3; ++c)
      if (std::abs(shown.rgba[at + c] - colour[c]) > 12) return false;
    return true;
  };
  // 195 pixels from 13 on, three lines of text below the upper edge.
  EXPECT_FALSE(isBar("picture.png", 14, {0, 0, 255}));
  EXPECT_TRUE(isBar("error.png", 14, {0, 0, 255}));
  EXPECT_TRUE(isBar("error.png", 13 + 97, {255, 255, 255}));
  EXPECT_TRUE(isBar("error.png", 13 + 193, {255, 0, 0}));
  EXPECT_TRUE(isBar("wipe.png", 14, {0, 0, 255}));
  EXPECT_TRUE(isBar("wipe.png", 640 - 14, {255, 0, 0})) << "that of B ends at the right";
}

// While the picture is still being made the reference keeps to its share of what the frames take by themselves, which
// its own clock says: 0.1, but for what was begun last and is paid back later.
TEST_F(Window, TheReferenceTakesItsShareOfFramesAlone) {
  write("input.txt", "1 key R\n2 key T\n200 key F2\n");
  const RunResult result = play(path("input.txt"), "--technique irradiance-cache --set cache.samples=65536");
  ASSERT_EQ(result.exitCode, 0) << result.err;
  const auto reference = json().at("window").at("reference");
  const double spent = reference.at("seconds_in_frames"), frames = reference.at("seconds_of_frames"),
               longest = reference.at("longest_in_a_frame");
  EXPECT_GT(spent, 0.0);
  EXPECT_LE(spent, 0.1 * frames + longest) << reference;
}

TEST_F(Window, AFileThatFailsSaysWhyAndTheSceneStays) {
  write("broken.obj", "f 1 2 3\n");
  write("other.obj", kRoom);
  write("input.txt", "1 drop broken.obj\n5 drop missing.gltf\n9 key 1\n12 drop other.obj\n20 key F2\n");
  const RunResult result = play(path("input.txt"));
  ASSERT_EQ(result.exitCode, 0) << result.err;
  std::string all;
  const nlohmann::json told = json();
  for (const auto& message : told.at("window").at("messages")) all += message.get<std::string>() + "\n";
  EXPECT_NE(all.find("broken.obj"), std::string::npos) << all;
  EXPECT_NE(all.find("missing.gltf"), std::string::npos) << all;
  EXPECT_NE(all.find("other: 102 triangles"), std::string::npos) << all;  // 6, and the floor's 96
}

TEST_F(Window, ShippedScenesAreOpenedByName) {
  write("input.txt",
        "1 key R\n2 touch Scene\n3 touch Scene/shipped scenes\n4 touch Scene/shipped scenes: door\n"
        "40 touch Scene/recent files\n");
  const RunResult result = play(path("input.txt"), "--technique direct", "XDG_STATE_HOME=" + path("state"), "800x700");
  ASSERT_EQ(result.exitCode, 0) << result.err;
  const auto messages = json().at("window").at("messages");
  EXPECT_EQ(
      std::count_if(messages.begin(), messages.end(), [](const std::string& m) { return m.starts_with("door: "); }), 1)
      << messages;
  const RunResult typed = RUN_LUCERNA("walk corn");
  EXPECT_EQ(typed.exitCode, 2);
  EXPECT_NE(typed.err.find("no shipped scene; nearest: cornell, "), std::string::npos) << typed.err;
}

TEST_F(Window, KeyFramesAreWrittenAsTheyAreRead) {
  write(
      "input.txt",
      "1 key R\n2 key K\n3 down W\n30 up W\n31 key K\n32 touch Record and window\n33 touch Record and window/write\n");
  const RunResult result = play(path("input.txt"));
  ASSERT_EQ(result.exitCode, 0) << result.err;
  const auto keys = lucerna::readKeyFrames(path("key_frames.txt")).camera;
  ASSERT_EQ(keys.size(), 2u);
  EXPECT_GT(glm::length(keys[0].position - keys[1].position), 0.1);
}

TEST_F(Window, InputFilesAreChecked) {
  for (const auto& [text, part] : {std::pair{"1 jump\n", "unknown"},
                                   {"x key A\n", "FRAME VERB"},
                                   {"5 key A\n3 key A\n", "comes after"},
                                   {"1 key NoSuchKey\n", "NoSuchKey"},
                                   {"1 cursor 3\n", "two numbers"},
                                   {"1 touch No such control\n", "No such control"}}) {
    write("input.txt", text);
    const RunResult result = play(path("input.txt"), "--technique direct");
    EXPECT_EQ(result.exitCode, 2) << text << result.err;
    EXPECT_NE(result.err.find("input.txt"), std::string::npos) << result.err;
    EXPECT_NE(result.err.find(part), std::string::npos) << result.err;
  }
}

TEST_F(Window, HelpListsTheKeys) {
  const RunResult result = RUN_LUCERNA("walk --help");
  for (const char* part : {"Keys in the window", "F12", "control Z", "magnifier"})
    EXPECT_NE(result.out.find(part), std::string::npos) << part;
}

// The same in a window of its own, where there is Xvfb.
TEST_F(Window, InAVirtualDisplay) {
  if (run("command -v xvfb-run").exitCode != 0) GTEST_SKIP() << "no xvfb-run";
  const RunResult result = play(kept("resizes.txt"), "--host window", "xvfb-run -a env");
  ASSERT_EQ(result.exitCode, 0) << result.err;
  EXPECT_EQ(glComplaints(result.err), "");
  EXPECT_EQ(json().at("host"), "window");
}

/// What a script for a window on a virtual display begins with: waiting for a title.
const char* kTitled = R"(
    export XDG_STATE_HOME=state
    title() { xdotool getwindowname "$window" 2>/dev/null; }
    titled() { for i in $(seq 300); do title | grep -q "$1" && return; sleep 0.1
               window=$(xdotool search --name Lucerna | tail -1); done; echo "never $1"; kill $walk; exit 1; }
    quit() { xdotool key Escape; sleep 0.5; xdotool key Return; wait $walk; echo exit $?; }
    ticks() { awk '{print $14 + $15}' /proc/$walk/stat; }
    spent() { before=$(ticks); sleep 2; echo $1 $(($(ticks) - before)); }  # hundredths of a second in two seconds
)";

/// The number after a word of a script's output; -1 if it is not there.
int numberAfter(const std::string& text, const std::string& word) {
  const auto at = text.find(word + " ");
  return at == std::string::npos ? -1 : std::atoi(text.c_str() + at + word.size() + 1);
}

// Keys that are pressed while programs compile act afterwards, in order, and mean what is printed on them: on a Czech
// and on a German keyboard Y and Z have changed places.
TEST_F(Window, LosesNoKeyWhateverTheLayout) {
  for (const char* tool : {"xvfb-run", "xdotool", "setxkbmap"})
    if (run(std::string("command -v ") + tool).exitCode != 0) GTEST_SKIP() << "no " << tool;
  write("drive.sh", kTitled + std::string(R"(
    setxkbmap $2 && setxkbmap -query | grep -q "layout: *$2" || { echo no layout; exit 0; }
    "$1" walk room.json --size 640x360 --technique direct --host window --json walk.json >out.txt 2>err.txt &
    walk=$!
    titled "frames a second\|at rest"
    xdotool windowfocus "$window" mousemove 100 100
    xdotool key r
    xdotool key 3 key k key k key k
    xdotool key ctrl+z key ctrl+y key ctrl+z
    sleep 1
    quit
)"));
  for (const std::string layout : {"cz", "de"}) {
    const RunResult typed = runInDisplay("drive.sh", layout);
    if (typed.out.find("no layout") != std::string::npos) GTEST_SKIP() << "no layout " << layout << typed.err;
    ASSERT_NE(typed.out.find("exit 0"), std::string::npos) << typed.out << typed.err << read("err.txt");
    const auto messages = json().at("window").at("messages");
    EXPECT_EQ(std::count(messages.begin(), messages.end(), "3 key frames"), 1) << layout << messages;
    EXPECT_EQ(std::count(messages.begin(), messages.end(), "settings as before"), 2) << layout << messages;
    EXPECT_EQ(std::count(messages.begin(), messages.end(), "settings made again"), 1) << layout << messages;
  }
}

// A view that has converged costs nothing, and neither does a minimised window, while a reference is asked for that
// takes all idle time. No window manager is there: what one does, a script does [ICCCM, section 4.1.4].
TEST_F(Window, RestsWhenNothingMovesOrNobodySeesIt) {
  for (const char* tool : {"xvfb-run", "xdotool", "python3"})
    if (run(std::string("command -v ") + tool).exitCode != 0) GTEST_SKIP() << "no " << tool;
  write("set_state.py", R"(
import ctypes, sys
x = ctypes.CDLL("libX11.so.6")
x.XOpenDisplay.restype = ctypes.c_void_p
display, window = ctypes.c_void_p(x.XOpenDisplay(None)), ctypes.c_ulong(int(sys.argv[1]))
x.XInternAtom.restype = ctypes.c_ulong
atom = ctypes.c_ulong(x.XInternAtom(display, b"WM_STATE", 0))
state = (ctypes.c_long * 2)(int(sys.argv[2]), 0)  # 1: normal, 3: iconic
x.XChangeProperty(display, window, atom, atom, 32, 0, state, 2)
(x.XUnmapWindow if int(sys.argv[2]) == 3 else x.XMapWindow)(display, window)
x.XSync(display, 0)
)");
  write("drive.sh", kTitled + std::string(R"(
    export LUCERNA_REFERENCES=references
    "$1" walk room.json --size 640x360 --technique direct --host window >out.txt 2>err.txt &
    walk=$!
    titled "at rest"
    xdotool windowfocus "$window" mousemove 100 100
    spent still
    xdotool key t; sleep 3
    spent works
    python3 set_state.py $window 3; sleep 2
    spent minimised
    python3 set_state.py $window 1; sleep 1
    spent again
    xdotool windowfocus "$window"
    quit
)"));
  const RunResult result = runInDisplay("drive.sh", "");
  ASSERT_NE(result.out.find("exit 0"), std::string::npos) << result.out << result.err << read("err.txt");
  for (const char* idle : {"still", "minimised"}) {
    EXPECT_GE(numberAfter(result.out, idle), 0) << result.out;
    EXPECT_LE(numberAfter(result.out, idle), 4) << result.out;
  }
  // Two hundred on an idle core; other programs may take most of it.
  for (const char* busy : {"works", "again"}) EXPECT_GT(numberAfter(result.out, busy), 12) << result.out;
  EXPECT_EQ(read("state/lucerna/recent-scenes"), fs::weakly_canonical(path("room.json")).string() + "\n");
}

// Frames go on between the steps of a solution: the camera moves and pictures are saved, of direct light until the
// solution is there. Escape ends it within a second, and the choice of another technique does.
TEST_F(Window, GoesOnWhileRadiosityIsSolved) {
  for (const char* tool : {"xvfb-run", "xdotool"})
    if (run(std::string("command -v ") + tool).exitCode != 0) GTEST_SKIP() << "no " << tool;
  write("drive.sh", kTitled + std::string(R"(
    export XDG_CACHE_HOME=cache
    "$1" walk room.json --size 320x180 --panel off --technique radiosity --set radiosity.edge=0.05 --host window \
      >out.txt 2>err.txt &
    walk=$!
    until_there() { for i in $(seq 100); do test -s "$1" && return; sleep 0.05; done; echo "no $1"; }
    titled "radiosity: form factors"
    xdotool windowfocus "$window" mousemove 100 100 key F12
    until_there room_0001.png
    xdotool keydown w; sleep 1; xdotool keyup w; xdotool key F12
    until_there room_0002.png
    title | grep -q "form factors" && echo still solving
    xdotool key Escape
    before=$(date +%s%N)
    titled "frames a second\|at rest"
    echo left $((($(date +%s%N) - before) / 1000000))
    xdotool key 5; titled "radiosity: "; xdotool key 1; titled "frames a second\|at rest"
    quit
)"));
  const RunResult result = runInDisplay("drive.sh", "");
  ASSERT_NE(result.out.find("exit 0"), std::string::npos) << result.out << result.err << read("err.txt");
  EXPECT_NE(result.out.find("still solving"), std::string::npos) << result.out;
  EXPECT_GE(numberAfter(result.out, "left"), 0) << result.out;
  EXPECT_LT(numberAfter(result.out, "left"), 3000) << "milliseconds";
  const lucerna::Bitmap before = lucerna::readBitmap(path("room_0001.png")),
                        moved = lucerna::readBitmap(path("room_0002.png"));
  ASSERT_EQ(before.width, 320);
  EXPECT_FALSE(before.rgba == moved.rgba) << "the camera moved";
}

// At the end of its path a walk that nobody touches ends, but not under a panel: that one is there for somebody.
TEST_F(Window, StaysOpenWithAPanel) {
  if (run("command -v xvfb-run").exitCode != 0) GTEST_SKIP() << "no xvfb-run";
  const auto framesWith = [&](const std::string& panel) {
    const RunResult result =
        run("cd '" + path("") + "' && xvfb-run -a '" LUCERNA_BINARY "' walk room.json --keys " +
            "path.txt --views 0:2 --size 64x36 --technique direct --host window --frames 60 " + "--panel " + panel);
    EXPECT_EQ(result.exitCode, 0) << result.err;
    return std::atoi(result.out.c_str());  // "60 frames in 1.2 s"
  };
  EXPECT_EQ(framesWith("on"), 60);
  EXPECT_LT(framesWith("off"), 60);
}

}  // namespace
