// lucerna radiosity solve in its corrected form, and render --technique radiosity, as a user runs them: settings, wrong
// input, runs that are killed, disks that are full.
#include "base/files.hpp"
#include "support/subprocess.hpp"
#include "support/temp_folder.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <fstream>
#include <set>

namespace {

namespace fs = std::filesystem;
using lucerna::test::run;
using lucerna::test::RunResult;
using lucerna::test::TempFolder;

class RadiosityCorrected : public ::testing::Test {
 protected:
  RadiosityCorrected() { room("room", "Kd 0.6 0.5 0.4"); }
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
  nlohmann::json json(const std::string& name) const { return nlohmann::json::parse(std::ifstream(path(name))); }
  std::vector<std::uint8_t> bytes(const std::string& name) const { return lucerna::readFileBytes(path(name)); }
  /// A closed room of side 2 with a lamp in its ceiling, as OBJ; no light of its own is added, since something shines.
  void room(const std::string& name, const std::string& walls, const std::string& corner = "-1 -1 -1",
            bool lamp = true) const {
    std::ofstream(path(name + ".mtl")) << "newmtl wall\n" << walls << "\nnewmtl lamp\nKd 0 0 0\nKe 5 5 5\n";
    std::ofstream(path(name + ".obj"))
        << "mtllib " << name << ".mtl\nv " << corner
        << "\nv 1 -1 -1\nv 1 -1 1\nv -1 -1 1\nv -1 1 -1\nv 1 1 -1\nv 1 1 1\nv -1 1 1\n"
        << "v -0.3 0.999 -0.3\nv 0.3 0.999 -0.3\nv 0.3 0.999 0.3\nv -0.3 0.999 0.3\nusemtl wall\nf 1 4 3 2\nf 5 6 7 "
           "8\nf 1 2 6 5\nf 3 4 8 7\nf 4 1 5 8\nf 2 3 7 6\n"
        << (lamp ? "usemtl lamp\nf 9 10 11 12\n" : "");
  }
  // Pixels learn what they see in one way: automatic chooses by time, and ways differ in their last bits.
  std::string solve(const std::string& in, const std::string& out, const std::string& more = "") const {
    return "'" LUCERNA_BINARY "' radiosity solve '" + path(in) + "' '" + path(out) +
           "' 16 --set radiosity.edge=0.5 --set radiosity.visibility=raster " + more;
  }
  std::string render(const std::string& more, const std::string& out = "p.pfm") const {
    return "'" LUCERNA_BINARY "' render '" + path("room.obj") +
           "' --technique radiosity --set radiosity.visibility=raster --size 24x16 --camera 0,0,0.9,0,0,-1,70 --json "
           "'" +
           path("r.json") + "' -o '" + path(out) + "' " + more;
  }
  void expectRefused(const std::string& command, const std::vector<std::string>& parts, int exitCode = 2) const {
    const RunResult result = run(command);
    EXPECT_EQ(result.exitCode, exitCode) << command << "\n" << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << command << "\n" << result.err;
    for (const std::string& part : parts)
      EXPECT_NE(result.err.find(part), std::string::npos) << "'" << part << "' is not in: " << result.err;
  }
  void expectWorks(const std::string& command) const {
    const RunResult result = run(command);
    ASSERT_EQ(result.exitCode, 0) << command << "\n" << result.err;
  }
  const TempFolder& folder() const { return folder_; }

 private:
  TempFolder folder_;
};

TEST_F(RadiosityCorrected, SettingsAndDeviationsAreTakenAlikeByRenderAndSolve) {
  const std::string all =
      "--set radiosity.edge=1.4 --set radiosity.resolution=24 --set radiosity.solver=anderson --set "
      "radiosity.error=1e-4 --set radiosity.seed=5 --set radiosity.exact-pixels=6 --set radiosity.part-distance=2 "
      "--set radiosity.parts=4 --set radiosity.products=50 --set radiosity.memory=100 --set radiosity.repair=off --set "
      "radiosity.refinements=1 --set radiosity.steep=0.2 --deviation radiosity.fixed-orientation=on ";
  expectWorks(solve("room.obj", "a.lit", all + "--json '" + path("s.json") + "'"));
  const nlohmann::json s = json("s.json");
  EXPECT_EQ(s["solver"], "anderson");
  EXPECT_LE(s["error_bound"].get<double>(), 1e-4);
  EXPECT_EQ(s["deviations"], nlohmann::json::array({"radiosity.fixed-orientation"}));
  EXPECT_FALSE(fs::exists(path("a.lit.rows")));
  EXPECT_FALSE(fs::exists(path("a.lit.rows.1")));
  // The picture of that file and the one that render solves itself are the same to the bit.
  expectWorks(
      render("--deviation radiosity.fixed-orientation=on --set radiosity.file='" + path("a.lit") + "'", "file.pfm"));
  EXPECT_EQ(json("r.json")["radiosity"]["hemicubes"], 0);
  expectWorks(render(all, "own.pfm"));
  EXPECT_EQ(json("r.json")["radiosity"]["patches"], s["patches"]);
  EXPECT_EQ(json("r.json")["deviations"], s["deviations"]);
  EXPECT_EQ(bytes("file.pfm"), bytes("own.pfm"));
  // Each does something: another number of patches, or another picture.
  std::set<std::string> pictures{lucerna::readFileText(path("own.pfm"))};
  for (const char* other :
       {"--set radiosity.edge=2.0", "--set radiosity.resolution=32",
        "--set radiosity.seed=6 --deviation radiosity.fixed-orientation=off", "--set radiosity.exact-pixels=0",
        "--set radiosity.part-distance=0", "--set radiosity.repair=on", "--deviation radiosity.published-map=on",
        "--deviation radiosity.fixed-orientation=off"}) {
    expectWorks(render(all + other));
    EXPECT_TRUE(pictures.insert(lucerna::readFileText(path("p.pfm"))).second) << other;
  }
  expectWorks(render(all + "--deviation radiosity.no-near-field=on"));
  EXPECT_FALSE(pictures.insert(lucerna::readFileText(path("p.pfm"))).second)
      << "no closed forms and no repair: the picture of radiosity.exact-pixels=0";
  expectWorks(render(all + "--set radiosity.solver=jacobi"));
  EXPECT_EQ(json("r.json")["radiosity"]["solver"], "jacobi");
  expectWorks(render("--fidelity original --set radiosity.edge=1.2"));
  EXPECT_EQ(json("r.json")["deviations"].dump().find("radiosity.24-bit"), std::string::npos);
  for (const char* name :
       {"radiosity.published-map", "radiosity.centroid", "radiosity.fixed-orientation", "radiosity.no-near-field"})
    EXPECT_NE(json("r.json")["deviations"].dump().find(name), std::string::npos) << name;
  // Deviations show in direct light too, which shadow rays would hide.
  for (const char* direct : {"auto", "patches", "pixels"})
    expectWorks(render(
        "--fidelity original --component direct --set radiosity.edge=1.2 --set radiosity.direct=" + std::string(direct),
        std::string(direct) + ".pfm"));
  expectWorks(render("--component direct --set radiosity.edge=1.2", "corrected.pfm"));
  EXPECT_EQ(bytes("auto.pfm"), bytes("patches.pfm"));
  EXPECT_EQ(bytes("corrected.pfm"), bytes("pixels.pfm"));
  EXPECT_NE(bytes("auto.pfm"), bytes("pixels.pfm"));
}

TEST_F(RadiosityCorrected, WrongInputIsOneClearLine) {
  expectRefused(render("--set radiosity.patch=1"), {"radiosity.patch=1", "unknown key", "nearest: radiosity."});
  expectRefused(render("--set radiosity.resolution=x"), {"radiosity.resolution", "x"});
  expectRefused(render("--set radiosity.solver=magic"), {"magic", "cg", "jacobi"});
  expectRefused(render("--deviation radiosity.24-bit=on"), {"radiosity.24-bit", "--fidelity original"});
  expectRefused(solve("room.obj", "o.lit", "--deviation radiosity.24-bit=on"),
                {"radiosity.24-bit", "--fidelity original"});
  expectRefused(solve("room.obj", "o.lit", "--set radiosity.mesh=on"),
                {"radiosity.mesh", "unknown key", "nearest: radiosity."});
  expectRefused(solve("room.obj", "o.lit", "--set lpv.cells=8"), {"lpv.cells", "unknown key"});
  expectRefused(solve("room.obj", "o.lit", "--near-plane 0.1"), {"--near-plane", "no near plane"});
  expectRefused(solve("no.obj", "o.lit"), {"no.obj"});
  expectRefused("'" LUCERNA_BINARY "' radiosity solve '" + path("room.obj") + "' '" + path("o.rad") +
                    "' --fidelity original --set radiosity.edge=1",
                {"--set radiosity.edge=1"});
  room("white", "Kd 1 1 1\nKe 1 1 1", "-1 -1 -1", false);
  expectRefused(solve("white.obj", "w.lit"), {"reflectance 1 everywhere in a closed scene"});
  EXPECT_FALSE(fs::exists(path("o.lit")));

  // A corner that is no number takes its triangles with it, and a triangle on a line is none; both are said.
  room("holes", "Kd 0.5 0.5 0.5", "nan -1 -1");
  const RunResult holes = run(solve("holes.obj", "h.lit", "--json '" + path("h.json") + "'"));
  EXPECT_EQ(holes.exitCode, 0) << holes.err;
  EXPECT_NE(holes.err.find("not finite"), std::string::npos) << holes.err;
  expectWorks(solve("room.obj", "o.lit", "--json '" + path("s.json") + "'"));
  EXPECT_LT(json("h.json")["patches"].get<int>(), json("s.json")["patches"].get<int>());

  // A solution that was cut short, that is another scene's, or made with other deviations.
  expectRefused(render("--set radiosity.file='" + path("room.obj") + "'"), {"room.obj", "not a radiosity solution"});
  expectRefused(render("--set radiosity.file='" + path("h.lit") + "'"), {"h.lit", "another scene"});
  expectRefused(render("--deviation radiosity.centroid=on --set radiosity.file='" + path("o.lit") + "'"),
                {"o.lit", "other deviations"});
  fs::resize_file(path("o.lit"), fs::file_size(path("o.lit")) - 100);
  const auto cut = bytes("o.lit");
  expectRefused(render("--set radiosity.file='" + path("o.lit") + "'"), {"o.lit", "truncated"});
  EXPECT_EQ(bytes("o.lit"), cut);
}

// ---------------------------------------------------------------------------------------------------- killed, full,
// changed

/// Many small submissions, two meshes.
const std::string kLong =
    "--set radiosity.edge=0.5 --set radiosity.refinements=1 --set radiosity.steep=0.3 --set radiosity.batch=0.05 "
    "--quiet ";

/// Killed by the system when a file of its own reaches so many bytes: in the middle of a write, on every machine alike.
RunResult killedAt(std::size_t bytes, const std::string& command) {
  return run("ulimit -c 0; ulimit -f " + std::to_string(bytes / 512) + "; exec " + command);
}
constexpr int kKilled = 128 + SIGXFSZ;

TEST_F(RadiosityCorrected, KilledRunsGoOnToTheSameBits) {
  expectWorks(solve("room.obj", "whole.lit", kLong + "--json '" + path("w.json") + "'"));
  const int all = json("w.json")["hemicubes"];
  int refinedRows = 0;
  for (const std::size_t size : {200'000u, 900'000u, 1'400'000u}) {  // rows: 820 kB, refined 1.5 MB
    const std::string out = "k.lit";
    ASSERT_EQ(killedAt(size, solve("room.obj", out, kLong)).exitCode, kKilled) << size;
    EXPECT_FALSE(fs::exists(path(out)));
    refinedRows += fs::exists(path(out + ".rows.1"));
    expectWorks(solve("room.obj", out, kLong + "--json '" + path("k.json") + "'"));
    EXPECT_LT(json("k.json")["hemicubes"].get<int>(), all) << size;
    EXPECT_EQ(bytes(out), bytes("whole.lit")) << "killed at " << size;
    EXPECT_FALSE(fs::exists(path(out + ".rows")));
    EXPECT_FALSE(fs::exists(path(out + ".rows.1")));
    fs::remove(path(out));
  }
  EXPECT_EQ(refinedRows, 2) << "runs that were killed in their second mesh";
}

TEST_F(RadiosityCorrected, ACheckpointThatIsCutShortOrAnothersIsHandled) {
  const std::string edge = "--quiet --set radiosity.batch=0.05 ";
  expectWorks(solve("room.obj", "whole.lit", edge));
  // Stopped when the first rows are down, wherever in a block: by the limit of its files' size, on every machine alike.
  ASSERT_EQ(killedAt(100'000, solve("room.obj", "s.lit", edge + "--set radiosity.seed=2")).exitCode, kKilled);
  ASSERT_TRUE(fs::exists(path("s.lit.rows")));
  const auto rows = bytes("s.lit.rows");
  // Another scene's or other settings': refused and left as it is.
  expectRefused(solve("room.obj", "s.lit", edge), {"s.lit.rows", "another scene or of other settings", "remove it"});
  EXPECT_EQ(bytes("s.lit.rows"), rows);
  // The scene's file was changed in between.
  room("room", "Kd 0.6 0.5 0.4", "-1.2 -1 -1");
  expectRefused(solve("room.obj", "s.lit", edge + "--set radiosity.seed=2"), {"s.lit.rows", "another scene"});
  EXPECT_EQ(bytes("s.lit.rows"), rows);
  room("room", "Kd 0.6 0.5 0.4");
  // Cut in the middle of a block, of its header, of the file's header: what is whole is taken.
  const std::string fine = edge + "--set radiosity.seed=2 ";
  expectWorks(solve("room.obj", "fine.lit", fine));
  for (const std::size_t size : {rows.size() - 7, std::size_t{24 + 10}, std::size_t{11}, std::size_t{0}}) {
    lucerna::writeFileAtomically(path("s.lit.rows"), std::span(rows).first(size));
    expectWorks(solve("room.obj", "s.lit", fine));
    EXPECT_EQ(bytes("s.lit"), bytes("fine.lit")) << size;
    fs::remove(path("s.lit"));
  }
  std::ofstream(path("s.lit.rows")) << "somebody's notes, and not few";
  expectRefused(solve("room.obj", "s.lit", fine), {"s.lit.rows", "not a checkpoint"});
  EXPECT_EQ(lucerna::readFileText(path("s.lit.rows")), "somebody's notes, and not few");
  expectWorks(solve("room.obj", "s.lit", fine + "--restart"));
}

TEST_F(RadiosityCorrected, FilesThatChangeUnderTheRunAreLeftAlone) {
  const auto during = [&](const std::string& change) {
    return run(solve("room.obj", "o.lit", kLong) + " & pid=$!; while kill -0 $pid 2>/dev/null && ! [ -s '" +
               path("o.lit.rows") + "' ]; do :; done; " + change + "; wait $pid");
  };
  const RunResult out = during("printf theirs > '" + path("o.lit") + "'");
  EXPECT_EQ(out.exitCode, 2) << out.err;
  EXPECT_NE(out.err.find("changed by another program"), std::string::npos) << out.err;
  EXPECT_EQ(lucerna::readFileText(path("o.lit")), "theirs");
  // What was computed is not lost.
  ASSERT_TRUE(fs::exists(path("o.lit.rows")));
  expectWorks(solve("room.obj", "o.lit", kLong + "--json '" + path("j.json") + "'"));
  EXPECT_EQ(json("j.json")["hemicubes"], 0);
  const RunResult rows =
      during("printf theirs > '" + path("new") + "' && mv '" + path("new") + "' '" + path("o.lit.rows") + "'");
  EXPECT_EQ(rows.exitCode, 2) << rows.err;
  EXPECT_NE(rows.err.find("changed or replaced by another program"), std::string::npos) << rows.err;
  EXPECT_EQ(lucerna::readFileText(path("o.lit.rows")), "theirs");
}

TEST_F(RadiosityCorrected, ADiskThatIsFullLeavesCheckpointAndSolution) {
  expectWorks(solve("room.obj", "o.lit", "--quiet"));
  expectWorks(solve("room.obj", "whole.lit", kLong));
  const auto old = bytes("o.lit");
  // No file may grow beyond 64 KiB: rows fail half way.
  const RunResult limited = run("trap '' XFSZ; ulimit -f 128; " + solve("room.obj", "o.lit", kLong));
  EXPECT_EQ(limited.exitCode, 2) << limited.err;
  EXPECT_EQ(std::count(limited.err.begin(), limited.err.end(), '\n'), 1) << limited.err;
  EXPECT_NE(limited.err.find("File too large"), std::string::npos) << limited.err;
  EXPECT_NE(limited.err.find(" rows"), std::string::npos) << limited.err;
  EXPECT_EQ(bytes("o.lit"), old);
  const auto kept = bytes("o.lit.rows");
  EXPECT_GT(kept.size(), 24u);

  if (run("unshare -rm sh -c 'mount -t tmpfs -o size=64k none /mnt'").exitCode != 0)
    GTEST_SKIP() << "no permission to mount a tmpfs; the file size limit above was tried";
  // A disk with the checkpoint, the old solution and 8 KiB more.
  fs::create_directory(path("small"));
  const auto kib = (kept.size() + old.size()) / 1024 + 16;
  const std::string command = solve("room.obj", "small/o.lit", kLong), small = path("small");
  const RunResult full =
      run("unshare -rm sh -c \"mount -t tmpfs -o size=" + std::to_string(kib) + "k none '" + small + "' && cp '" +
          path("o.lit") + "' '" + path("o.lit.rows") + "' '" + small + "/'; head -c 1000000 /dev/zero > '" + small +
          "/filler' 2>/dev/null; " + command + "; code=\\$?; cmp '" + path("o.lit") + "' '" + small +
          "/o.lit' && cmp -n " + std::to_string(kept.size()) + " '" + path("o.lit.rows") + "' '" + small +
          "/o.lit.rows' && cp '" + small + "/o.lit.rows' '" + path("after.rows") + "' && exit \\$code; exit 99\"");
  EXPECT_EQ(full.exitCode, 2) << full.out << full.err;
  EXPECT_EQ(std::count(full.err.begin(), full.err.end(), '\n'), 1) << full.err;
  EXPECT_NE(full.err.find("No space left on device"), std::string::npos) << full.err;
  // Where there is room again, it goes on.
  fs::rename(path("after.rows"), path("o.lit.rows"));
  expectWorks(solve("room.obj", "o.lit", kLong));
  EXPECT_EQ(bytes("o.lit"), bytes("whole.lit"));
}

TEST_F(RadiosityCorrected, WithLittleMemoryTheAnswerIsTheSame) {
  expectWorks(solve("room.obj", "kept.lit", "--error 1e-5 --quiet --json '" + path("k.json") + "'"));
  const RunResult anew = run(solve(
      "room.obj", "anew.lit", "--error 1e-5 --memory 0.05 --set radiosity.repair=off --json '" + path("a.json") + "'"));
  ASSERT_EQ(anew.exitCode, 0) << anew.err;
  EXPECT_NE(anew.err.find("read from " + path("anew.lit.rows")), std::string::npos) << anew.err;
  EXPECT_EQ(json("k.json")["hemicubes"], json("k.json")["patches"]);
  EXPECT_EQ(json("a.json")["hemicubes"], json("a.json")["patches"]);  // products read their rows: none is drawn twice
  EXPECT_EQ(json("a.json")["solver"], "anderson");
  EXPECT_LE(json("a.json")["error_bound"].get<double>(), 1e-5);
  // Without repair, of which rows that are read or computed anew get a half, both solve the same system.
  expectWorks(solve("room.obj", "plain.lit", "--error 1e-5 --set radiosity.repair=off"));
  const auto mean = [&](const std::string& file) {
    expectWorks(render("--set radiosity.file='" + path(file) + "' --set radiosity.edge=0.5"));
    return json("r.json")["mean"][1].get<double>();
  };
  const double kept = mean("kept.lit"), again = mean("anew.lit"), plain = mean("plain.lit");
  EXPECT_NEAR(again / plain, 1.0, 3e-5);  // both guaranteed to 1e-5
  EXPECT_NEAR(again / kept, 1.0, 2e-2);
  expectWorks(solve("room.obj", "scaled.lit", "--error 1e-5 --memory 0.05"));  // with repair: rows get their sums
  EXPECT_NEAR(mean("scaled.lit") / kept, 1.0, 1e-2);

  // Killed while rows are made, it goes on with those that there are, to the same bits.
  const std::string little = kLong + "--memory 0.05 ";
  expectWorks(solve("room.obj", "whole.lit", little + "--json '" + path("w.json") + "'"));
  for (const std::size_t size : {200'000u, 800'000u}) {
    ASSERT_EQ(killedAt(size, solve("room.obj", "k.lit", little)).exitCode, kKilled) << size;
    expectWorks(solve("room.obj", "k.lit", little + "--json '" + path("k.json") + "'"));
    EXPECT_LT(json("k.json")["hemicubes"].get<int>(), json("w.json")["hemicubes"].get<int>());
    EXPECT_EQ(bytes("k.lit"), bytes("whole.lit")) << "killed at " << size;
    fs::remove(path("k.lit"));
  }
}

TEST_F(RadiosityCorrected, AgreesWithThePathTracer) {
  const auto draw = [&](const std::string& scene, const std::string& technique, const std::string& more) {
    expectWorks("'" LUCERNA_BINARY "' render '" + scene + "' --component indirect --size 64x64 --quiet --technique " +
                technique + " -o '" + path(technique + ".pfm") + "' " + more);
  };
  const auto bias = [&](const std::string& scene, const std::string& radiosity) {  // to the last picture by paths
    draw(scene, "radiosity", radiosity);
    expectWorks("'" LUCERNA_BINARY "' compare '" + path("radiosity.pfm") + "' '" + path("path.pfm") + "' --json '" +
                path("c.json") + "'");
    return json("c.json")["relative_bias"].get<double>();
  };
  const std::string cornell = LUCERNA_SOURCE_DIR "/assets/cornell/cornell.json";
  draw(cornell, "path", "--spp 128");
  EXPECT_LT(std::abs(bias(cornell, "--set radiosity.edge=0.1 --set radiosity.resolution=32")), 0.012);

  // A court under the sun: pillars go on under its floor, beams lie in them and end in its walls. What runs on inside
  // of something must not darken what is seen of it.
  std::ofstream(path("court.mtl")) << "newmtl stone\nKd 0.7 0.65 0.6\n";
  std::ofstream obj(path("court.obj"));
  obj << "mtllib court.mtl\nusemtl stone\n";
  int vertices = 0;
  const auto box = [&](const std::array<double, 3>& low, const std::array<double, 3>& high, bool inside, bool lid) {
    for (int corner = 0; corner < 8; ++corner)
      obj << "v " << (corner & 1 ? high : low)[0] << " " << (corner & 2 ? high : low)[1] << " "
          << (corner & 4 ? high : low)[2] << "\n";
    constexpr int kFaces[6][4] = {{0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2},
                                  {1, 3, 7, 5}, {0, 2, 3, 1}, {4, 5, 7, 6}};  // outwards; the second is the lid
    for (int face = 0; face < 6; ++face) {
      if (face == 1 && !lid) continue;
      obj << "f";
      for (int k = 0; k < 4; ++k) obj << " " << vertices + 1 + kFaces[face][inside ? 3 - k : k];
      obj << "\n";
    }
    vertices += 8;
  };
  box({-2, 0, -2}, {2, 2, 2}, true, false);
  box({-2.4, -0.5, -2.4}, {2.4, 2, 2.4}, false, false);
  constexpr double kPillars[5][2] = {{-1.1, -1.2}, {0.9, -1.05}, {-1.0, 0.8}, {1.15, 1.1}, {0.1, -0.1}};
  for (const auto& [x, z] : kPillars) box({x - 0.31, -0.3, z - 0.27}, {x + 0.29, 1.2, z + 0.33}, false, true);
  box({-2.2, 1.2, -1.3}, {2.2, 1.45, -1.05}, false, true);
  box({0.75, 1.2, -2.2}, {1.0, 1.5, 2.2}, false, true);
  obj.close();
  const std::string camera = "--camera -1.8,1.9,1.8,1,0,-1,70 ",
                    coarse = camera + "--set radiosity.edge=0.6 --set radiosity.resolution=32 ";
  draw(path("court.obj"), "path", camera + "--spp 128");
  EXPECT_LT(std::abs(bias(path("court.obj"), coarse)), 0.02);
  EXPECT_LT(bias(path("court.obj"), coarse + "--deviation radiosity.centroid=on"),
            -0.045);  // -0.054: what the right one must not be
}

}  // namespace
