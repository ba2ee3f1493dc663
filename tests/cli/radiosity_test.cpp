// lucerna radiosity generate|solve|show as a user runs them, and what happens to the files when a run is stopped,
// killed, or cannot write.
#include "base/clock.hpp"
#include "base/files.hpp"
#include "base/image.hpp"
#include "radiosity/original/rad_file.hpp"
#include "scene/scene.hpp"
#include "support/subprocess.hpp"
#include "support/temp_folder.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <set>

namespace {

namespace fs = std::filesystem;
using lucerna::RadTriangle;
using lucerna::test::run;
using lucerna::test::RunResult;
using lucerna::test::TempFolder;

class Radiosity : public ::testing::Test {
 protected:
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
  nlohmann::json json(const std::string& name) const { return nlohmann::json::parse(std::ifstream(path(name))); }
  std::vector<std::uint8_t> bytes(const std::string& name) const { return lucerna::readFileBytes(path(name)); }
  /// Model 1 with few triangles, bright enough for several sweeps.
  void generate(const std::string& name, const std::string& numbers = "40 0.5 1000000") const {
    const RunResult result = RUN_LUCERNA("radiosity generate '" + path(name) + "' 1 " + numbers);
    ASSERT_EQ(result.exitCode, 0) << result.err;
  }
  static std::string solve(const std::string& in, const std::string& out, const std::string& more = "") {
    return "'" LUCERNA_BINARY "' radiosity solve '" + in + "' '" + out + "' 16 --fidelity original " + more;
  }
  void expectRefused(const std::string& command, const std::vector<std::string>& parts, int exitCode = 2) const {
    const RunResult result = run(command);
    EXPECT_EQ(result.exitCode, exitCode) << command << "\n" << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << command << "\n" << result.err;
    for (const std::string& part : parts)
      EXPECT_NE(result.err.find(part), std::string::npos) << "'" << part << "' is not in: " << result.err;
  }
  const TempFolder& folder() const { return folder_; }

 private:
  TempFolder folder_;
};

TEST_F(Radiosity, AnySceneBecomesAFileOfTriangles) {
  // A floor under a lamp half as large: what the file says of each, in its units; then the published solver and display
  // run on it.
  std::ofstream(path("room.mtl")) << "newmtl floor\nKd 0.6 0.3 0\nnewmtl lamp\nKd 0 0 0\nKe 2 2 2\n";
  std::ofstream(path("room.obj"))
      << "mtllib room.mtl\nv -2 0 -2\nv 2 0 -2\nv 2 0 2\nv -2 0 2\nv -1 2 -1\nv 1 2 -1\nv 1 2 1\nv -1 2 1\n"
         "usemtl floor\nf 1 4 3 2\nusemtl lamp\nf 5 6 7 8\n";
  const RunResult made = RUN_LUCERNA("radiosity generate '" + path("room.rad") + "' '" + path("room.obj") +
                                     "' --edge 1 --power 1000000 --json '" + path("g.json") + "'");
  ASSERT_EQ(made.exitCode, 0) << made.err;
  const nlohmann::json g = json("g.json");
  EXPECT_NEAR(g["exitance_of_step"].get<double>(), 2.0 * M_PI / 1000000.0, 1e-9);
  const std::vector<RadTriangle> triangles = lucerna::readRadFile(path("room.rad"));
  EXPECT_EQ(triangles.size(), g["triangles"].get<std::size_t>());
  EXPECT_GE(triangles.size(), 40u);
  double floor = 0.0, lamp = 0.0;
  for (const RadTriangle& t : triangles) {
    (t.e > 0 ? lamp : floor) += lucerna::areaOf(t);
    EXPECT_EQ(t.e, t.e > 0 ? 1000000u : 0u);
    EXPECT_EQ(t.b, 0u);
    EXPECT_NEAR(t.ro, t.e > 0 ? 0.0f : 0.3f, 1e-6f);
    EXPECT_NEAR(t.c[1], t.e > 0 ? 1.0f : 0.5f, 1e-6f);
    for (const auto& [a, b] : {std::pair(t.p1, t.p2), std::pair(t.p2, t.p3), std::pair(t.p3, t.p1)})
      EXPECT_LE(std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]), 1.0f + 1e-6f);
  }
  EXPECT_NEAR(floor, 16.0, 1e-4);
  EXPECT_NEAR(lamp, 4.0, 1e-4);
  // Shown before it is solved it says why it is black; its mesh is meant to be.
  const std::string unsolved = "radiosity show '" + path("room.rad") + "' -o '" + path("lit.png") + "' --size 32x24";
  EXPECT_NE(RUN_LUCERNA(unsolved).err.find("room.rad: no light is computed yet"), std::string::npos);
  EXPECT_EQ(RUN_LUCERNA(unsolved + " --mesh").err, "");
  ASSERT_EQ(run(solve(path("room.rad"), path("lit.rad"))).exitCode, 0);
  double received = 0.0;
  for (const RadTriangle& t : lucerna::readRadFile(path("lit.rad")))
    received += t.e == 0 ? t.b * lucerna::areaOf(t) : 0.0;
  EXPECT_GT(received, 0.0);
  const RunResult lit =
      RUN_LUCERNA("radiosity show '" + path("lit.rad") + "' -o '" + path("lit.png") + "' --size 32x24");
  EXPECT_EQ(lit.exitCode, 0) << lit.err;
  EXPECT_EQ(lit.err, "");
  // What is no file of triangles is told, and how to make one.
  expectRefused(solve(path("room.obj"), path("x.rad")), {"room.obj", "scene (obj)", "radiosity generate FILE"});
  expectRefused("'" LUCERNA_BINARY "' radiosity show '" + path("room.obj") + "' -o '" + path("x.png") + "'",
                {"room.obj", "radiosity generate FILE"});
  std::ofstream(path("dark.obj")) << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  expectRefused("'" LUCERNA_BINARY "' radiosity generate '" + path("x.rad") + "' '" + path("dark.obj") + "'",
                {"dark.obj", "no surface emits"});
  expectRefused("'" LUCERNA_BINARY "' radiosity generate '" + path("x.rad") + "' '" + path("room.obj") + "' 2 0.5 100",
                {"--edge and --power"});
  expectRefused("'" LUCERNA_BINARY "' radiosity generate '" + path("x.rad") + "' 1 --edge 2",
                {"--edge", "AREA_THRESHOLD"});
  EXPECT_FALSE(fs::exists(path("x.rad")));
}

TEST_F(Radiosity, LightsWithoutASurfaceAreHandedOver) {
  // A PLY has no materials that emit, but the default sun. A floor of albedo rho under an irradiance E sends out rho E,
  // and the published solver and display run on it.
  std::ofstream(path("floor.ply")) << "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
                                      "property float z\nelement face 2\nproperty list uchar int vertex_indices\n"
                                      "end_header\n-1 0 -1\n1 0 -1\n1 0 1\n-1 0 1\n3 0 2 1\n3 0 3 2\n";
  const auto generate = [&](const char* file) {
    return "radiosity generate '" + path("p.rad") + "' '" + path(file) + "' --edge 9 --power 1000 --json '" +
           path("g.json") + "'";
  };
  expectRefused("'" LUCERNA_BINARY "' " + generate("floor.ply"), {"floor.ply", "no surface emits", "--lights"});
  const RunResult made = RUN_LUCERNA(generate("floor.ply") + " --lights");
  ASSERT_EQ(made.exitCode, 0) << made.err;
  std::ofstream(path("sun.json"))
      << R"({"model": "floor.ply", "sun": {"direction": [0, -1, 1], "irradiance": [2, 4, 6]}})";
  ASSERT_EQ(RUN_LUCERNA(generate("sun.json") + " --lights").exitCode, 0);
  // Its textures, too, whatever lights it.
  const std::string show = "radiosity show '" + path("p.rad") + "' -o '" + path("p.png") + "' --size 16x12 --scene '";
  EXPECT_EQ(RUN_LUCERNA(show + path("sun.json") + "' --edge 9").exitCode, 0);
  const double sent = lucerna::loadScene(path("sun.json")).materials[0].diffuse.x * 4.0 * std::sqrt(0.5);
  EXPECT_NEAR(1000.0 * json("g.json").at("exitance_of_step").get<double>(), sent, 1e-5);
  const std::vector<RadTriangle> triangles = lucerna::readRadFile(path("p.rad"));
  ASSERT_EQ(triangles.size(), 2u);
  for (const RadTriangle& t : triangles) EXPECT_EQ(t.e, 1000u);
  EXPECT_EQ(run(solve(path("p.rad"), path("q.rad"))).exitCode, 0);
  EXPECT_EQ(RUN_LUCERNA("radiosity show '" + path("q.rad") + "' -o '" + path("q.png") + "' --size 16x12").exitCode, 0);
}

TEST_F(Radiosity, AFineSceneBecomesFewerTriangles) {
  // A floor of 20 x 20 squares, which lies flat in any cells, under a lamp that is kept.
  std::ofstream(path("fine.mtl")) << "newmtl floor\nKd 0.6 0.6 0.6\nnewmtl lamp\nKd 0 0 0\nKe 2 2 2\n";
  std::ofstream obj(path("fine.obj"));
  obj << "mtllib fine.mtl\nv -1 2 -1\nv 1 2 -1\nv 1 2 1\nv -1 2 1\n";
  for (int z = 0; z <= 20; ++z)
    for (int x = 0; x <= 20; ++x) obj << "v " << 0.2 * x - 2.0 << " 0 " << 0.2 * z - 2.0 << "\n";
  obj << "usemtl lamp\nf 1 2 3 4\nusemtl floor\n";
  for (int z = 0; z < 20; ++z)
    for (int x = 0; x < 20; ++x) {
      const int a = 5 + 21 * z + x;
      obj << "f " << a << " " << a + 21 << " " << a + 22 << " " << a + 1 << "\n";
    }
  obj.close();
  const std::string options = " --edge 10 --triangles 200", fine = "'" + path("fine.obj") + "'";
  const RunResult made =
      RUN_LUCERNA("radiosity generate '" + path("f.rad") + "' " + fine + options + " --json '" + path("g.json") + "'");
  ASSERT_EQ(made.exitCode, 0) << made.err;
  EXPECT_NE(made.out.find("coarser model"), std::string::npos) << made.out;
  double floor = 0.0, lamp = 0.0;
  const std::vector<RadTriangle> triangles = lucerna::readRadFile(path("f.rad"));
  for (const RadTriangle& t : triangles) (t.e > 0 ? lamp : floor) += lucerna::areaOf(t);
  EXPECT_GT(triangles.size(), 50u);
  EXPECT_LE(triangles.size(), 200u);
  EXPECT_NEAR(lamp, 4.0, 1e-4);
  EXPECT_NEAR((floor + lamp) / 20.0, json("g.json").at("model_area").get<double>(), 1e-4);
  EXPECT_GT(floor, 13.0);
  const std::string show = "radiosity show '" + path("f.rad") + "' -o '" + path("f.png") + "' --size 16x12 --scene ";
  EXPECT_EQ(RUN_LUCERNA(show + fine + options).exitCode, 0);
  expectRefused("'" LUCERNA_BINARY "' " + show + fine + " --edge 10", {"f.rad", "--triangles"});
  expectRefused("'" LUCERNA_BINARY "' radiosity generate '" + path("x.rad") + "' 1 --triangles 20",
                {"--triangles", "AREA_THRESHOLD"});
}

TEST_F(Radiosity, GenerateSolveShow) {
  const RunResult made =
      RUN_LUCERNA("radiosity generate '" + path("m.rad") + "' 1 40 0.5 1000000 --json '" + path("g.json") + "'");
  ASSERT_EQ(made.exitCode, 0) << made.err;
  const auto triangles = json("g.json")["triangles"].get<std::size_t>();
  EXPECT_EQ(bytes("m.rad").size(), 4 + 72 * triangles);
  EXPECT_EQ(json("g.json")["light_power"], 1000000);

  const RunResult solved = run(solve(path("m.rad"), path("s.rad"), "--json '" + path("s.json") + "'"));
  ASSERT_EQ(solved.exitCode, 0) << solved.err;
  const nlohmann::json s = json("s.json");
  EXPECT_EQ(s["patches"], triangles);
  EXPECT_TRUE(s["settled"].get<bool>());
  EXPECT_GT(s["sweeps"].get<int>(), 5);
  EXPECT_GT(s["seconds"].get<double>(), 0.0);
  EXPECT_NEAR(s["hemicubes_per_s"].get<double>(), s["hemicubes"].get<double>() / s["seconds"].get<double>(),
              1e-6 * s["hemicubes_per_s"].get<double>());
  EXPECT_TRUE(s["error_bound"].is_null());
  EXPECT_LT(std::abs(s["energy_balance"].get<double>()), 0.3);
  EXPECT_EQ(s["deviations"].size(), 5u);
  EXPECT_FALSE(fs::exists(path("s.rad.sweep"))) << "a run that ended leaves no checkpoint";
  const auto before = lucerna::readRadFile(path("m.rad")), after = lucerna::readRadFile(path("s.rad"));
  std::size_t lit = 0;
  for (std::size_t i = 0; i < after.size(); ++i) {
    EXPECT_EQ(after[i].p3, before[i].p3);
    lit += after[i].b > 0;
  }
  EXPECT_GT(lit, after.size() * 9 / 10);

  // Nothing changes any more: one sweep says so and the file stays as it is.
  const RunResult again = run(solve(path("s.rad"), path("s.rad"), "--json '" + path("t.json") + "'"));
  EXPECT_EQ(again.exitCode, 0) << again.err;
  EXPECT_EQ(json("t.json")["sweeps"], 1);
  EXPECT_EQ(lucerna::encodeRadFile(after), bytes("s.rad"));

  for (const char* mode : {"", "s", "c", "--mapping linear", "--mapping filmic", "--false-colours", "--mesh"}) {
    const RunResult shown =
        RUN_LUCERNA("radiosity show '" + path("s.rad") + "' " + mode + " -o '" + path("s.png") + "' --size 80x60");
    EXPECT_EQ(shown.exitCode, 0) << mode << shown.err;
    EXPECT_EQ(lucerna::readBitmap(path("s.png")).width, 80);
    fs::remove(path("s.png"));
  }
}

TEST_F(Radiosity, WrongInputIsOneClearLine) {
  generate("m.rad");
  const std::string good = path("m.rad"), out = path("o.rad");
  const auto broken = [&](const std::string& name, auto change) {
    std::vector<std::uint8_t> b = bytes("m.rad");
    change(b);
    lucerna::writeFileAtomically(path(name), b);
    return path(name);
  };
  const std::string size = std::to_string(bytes("m.rad").size());
  expectRefused(solve(broken("cut.rad", [](auto& b) { b.resize(b.size() - 10); }), out),
                {"cut.rad", size, std::to_string(bytes("m.rad").size() - 10)});
  expectRefused(solve(broken("turned.rad", [](auto& b) { std::reverse(b.begin(), b.begin() + 4); }), out),
                {"turned.rad", "byte order"});
  expectRefused(solve(broken("nan.rad", [](auto& b) { b[6] = 0xc0, b[7] = 0x7f; }), out),
                {"nan.rad", "triangle 0", "finite"});
  expectRefused(solve(broken("ro.rad", [](auto& b) { b[4 + 60 + 3] = 0x40; }), out),
                {"ro.rad", "triangle 0", "reflectance"});
  expectRefused(solve(path("missing.rad"), out), {"missing.rad", "no such file"});
  expectRefused(solve(good, path("no/such/o.rad")), {"no/such", "no such folder"});
  expectRefused(solve(good, "/proc/o.rad"), {"/proc/o.rad", "cannot be written"});
  expectRefused(solve(good, out, "--solver cg"), {"cg", "jacobi", "gauss-seidel"});
  expectRefused(solve(good, out, "--deviation radiosity.x=on"), {"radiosity.x", "radiosity.24-bit"});
  expectRefused("'" LUCERNA_BINARY "' radiosity solve '" + good + "' '" + out + "' 1 --fidelity original",
                {"RESOLUTION 1"});
  expectRefused("'" LUCERNA_BINARY "' radiosity solve '" + good + "' '" + out + "' --fidelity exact",
                {"exact", "original"});
  expectRefused("'" LUCERNA_BINARY "' radiosity show '" + good + "' x -o '" + path("o.png") + "'", {"x", "s ", "c "});
  expectRefused("'" LUCERNA_BINARY "' radiosity show '" + good + "' -o '" + path("o.jpg") + "'", {"png"});
  // --fidelity is obeyed or refused.
  ASSERT_EQ(run(solve(good, path("lit.rad"), "--max-sweeps 1")).exitCode, 0);
  const std::string show =
      "'" LUCERNA_BINARY "' radiosity show '" + path("lit.rad") + "' -o '" + path("o.png") + "' --size 32x24 ";
  expectRefused(show + "--fidelity corrected", {"--interpolate"});
  expectRefused(show + "--fidelity original --mapping filmic", {"filmic", "bits"});
  expectRefused(show + "--mapping bits --interpolate", {"--interpolate", "no mean"});
  expectRefused(show + "--edge 2", {"--scene"});
  expectRefused(show + "--scene '" LUCERNA_SOURCE_DIR "/assets/cornell/cornell.obj'", {"--edge", "cornell"});
  std::set<std::string> pictures;
  for (const char* way : {"", "--interpolate", "--interpolate --fidelity corrected"}) {
    EXPECT_EQ(run(show + way).exitCode, 0) << way;
    pictures.insert(lucerna::readFileText(path("o.png")));
  }
  EXPECT_EQ(pictures.size(), 3u) << "each way of shading is another picture";
  expectRefused("'" LUCERNA_BINARY "' radiosity generate '" + out + "' 7", {"MODEL 7"});
  expectRefused("'" LUCERNA_BINARY "' radiosity generate '" + out + "' 1 2.5", {"all three or none"});
  expectRefused("'" LUCERNA_BINARY "' radiosity generate '" + out + "' 1 2.5 0.15 20000000",
                {"LIGHT_POWER 20000000", "16777215"});
  EXPECT_FALSE(fs::exists(out));
  EXPECT_EQ(folder().listing().find("tmp"), std::string::npos) << folder().listing();
}

/// Ends a run by a signal `seconds` after its start, again and again, until it ends by itself. Where that is before the
/// first signal (the machine was busier when the time was taken), from the start with half the time. Each attempt is
/// longer than the last: where the machine is busier now, none is for ever too short to get anywhere.
void runInterrupted(const std::string& command, const std::string& out, const std::string& signal, double seconds) {
  int stops = 0;
  for (int runs = 0; runs < 200; ++runs) {
    const RunResult result = run("timeout -s " + signal + " " + std::to_string(seconds) + " " + command);
    if (result.exitCode == 0 && stops > 0) return;
    if (result.exitCode == 0) {
      seconds *= 0.5;
      fs::remove(out);
      continue;
    }
    ++stops;
    seconds *= 1.1;
    EXPECT_TRUE(result.exitCode == 124 || result.exitCode == 130 || result.exitCode == 137)
        << result.exitCode << result.err;
  }
  ADD_FAILURE() << (stops > 0 ? "never ended" : "never stopped");
}

TEST_F(Radiosity, KilledAndInterruptedRunsGoOnWithoutLoss) {
  generate("m.rad", "20 0.5 1000000");
  const auto start = lucerna::Clock::now();
  ASSERT_EQ(run(solve(path("m.rad"), path("whole.rad"))).exitCode, 0);
  const double attempt = 0.4 * lucerna::secondsSince(start);
  runInterrupted(solve(path("m.rad"), path("killed.rad"), "--save-every 0.02"), path("killed.rad"), "KILL", attempt);
  EXPECT_EQ(bytes("killed.rad"), bytes("whole.rad"));
  runInterrupted(solve(path("m.rad"), path("stopped.rad"), "--save-every 1000"), path("stopped.rad"), "INT", attempt);
  EXPECT_EQ(bytes("stopped.rad"), bytes("whole.rad"));
  EXPECT_FALSE(fs::exists(path("killed.rad.sweep")));
}

TEST_F(Radiosity, CheckpointOfAnotherRunIsNotTakenUp) {
  generate("m.rad");
  ASSERT_EQ(run(solve(path("m.rad"), path("whole.rad"), "--max-sweeps 2")).exitCode, 0);
  ASSERT_TRUE(fs::exists(path("whole.rad.sweep")));
  const std::vector<std::uint8_t> two = bytes("whole.rad");
  // As many sweeps as asked for are there: nothing is done.
  EXPECT_EQ(run(solve(path("m.rad"), path("whole.rad"), "--max-sweeps 2")).exitCode, 0);
  EXPECT_EQ(bytes("whole.rad"), two);
  const RunResult other = run(
      solve(path("m.rad"), path("whole.rad"), "--max-sweeps 1 --solver gauss-seidel --json '" + path("j.json") + "'"));
  EXPECT_EQ(other.exitCode, 0) << other.err;
  EXPECT_NE(other.err.find("not resumed (made with different settings"), std::string::npos) << other.err;
  EXPECT_EQ(json("j.json")["sweeps_here"], 1);
  // Another file in OUT's place.
  ASSERT_EQ(run(solve(path("m.rad"), path("whole.rad"), "--max-sweeps 1")).exitCode, 0);
  fs::copy_file(path("m.rad"), path("whole.rad"), fs::copy_options::overwrite_existing);
  lucerna::writeFileAtomically(path("whole.rad"), two);
  const RunResult foreign = run(solve(path("m.rad"), path("whole.rad"), "--max-sweeps 1"));
  EXPECT_NE(foreign.err.find("is not what it belongs to"), std::string::npos) << foreign.err;
  ASSERT_TRUE(fs::exists(path("whole.rad.sweep")));
  std::ofstream(path("whole.rad.sweep"), std::ios::binary | std::ios::trunc) << "LUCRADSW";
  const RunResult damaged = run(solve(path("m.rad"), path("whole.rad"), "--max-sweeps 1"));
  EXPECT_EQ(damaged.exitCode, 0);
  EXPECT_NE(damaged.err.find("too few"), std::string::npos) << damaged.err;
}

TEST_F(Radiosity, FileThatChangesUnderTheRunIsLeftAlone) {
  generate("m.rad", "10 0.5 1000000");
  // Another program replaces OUT while the first sweep runs, and again, should a save that was under way replace its.
  const std::string out = "'" + path("o.rad") + "'";
  const std::string command = solve(path("m.rad"), path("o.rad"), "--save-every 0") + " & pid=$!; until [ -s " + out +
                              " ]; do sleep 0.01; done; while kill -0 $pid; do " + "printf theirs > " + out +
                              "; sleep 0.01; done 2>/dev/null; wait $pid";
  const RunResult result = run(command);
  EXPECT_EQ(result.exitCode, 2) << result.out << result.err;
  EXPECT_NE(result.err.find("changed by another program"), std::string::npos) << result.err;
  EXPECT_EQ(lucerna::readFileText(path("o.rad")), "theirs");
}

TEST_F(Radiosity, DiskThatIsFullLeavesTheOldCheckpoint) {
  generate("m.rad");
  ASSERT_EQ(run(solve(path("m.rad"), path("o.rad"), "--max-sweeps 1")).exitCode, 0);
  const std::vector<std::uint8_t> old = bytes("o.rad"), oldCheckpoint = bytes("o.rad.sweep");
  // No file may grow beyond 1 KiB: every write fails half way.
  const RunResult limited =
      run("unset LUCERNA_DUMP_PROGRAMS; trap '' XFSZ; ulimit -f 1; " + solve(path("m.rad"), path("o.rad")));
  EXPECT_EQ(limited.exitCode, 2) << limited.err;
  EXPECT_NE(limited.err.find("cannot be written: File too large"), std::string::npos) << limited.err;
  EXPECT_EQ(bytes("o.rad"), old);
  EXPECT_EQ(bytes("o.rad.sweep"), oldCheckpoint);
  EXPECT_EQ(folder().listing().find("tmp"), std::string::npos) << folder().listing();

  if (run("unshare -rm sh -c 'mount -t tmpfs -o size=64k none /mnt'").exitCode != 0)
    GTEST_SKIP() << "no permission to mount a tmpfs; the file size limit above was tried";
  fs::create_directory(path("small"));
  const std::string full = "unshare -rm sh -c \"mount -t tmpfs -o size=40k none '" + path("small") + "' && cp '" +
                           path("o.rad") + "' '" + path("o.rad.sweep") + "' '" + path("small") +
                           "/' && head -c 100000 /dev/zero > '" + path("small") + "/filler'; " +
                           solve(path("m.rad"), path("small") + "/o.rad") + "; code=\\$?; cmp '" + path("o.rad") +
                           "' '" + path("small") + "/o.rad' && cmp '" + path("o.rad.sweep") + "' '" + path("small") +
                           "/o.rad.sweep' && exit \\$code; exit 99\"";
  const RunResult result = run(full);
  EXPECT_EQ(result.exitCode, 2) << result.out << result.err;
  EXPECT_NE(result.err.find("No space left on device"), std::string::npos) << result.err;
}

}  // namespace
