// lucerna lab: each lab's stub, solution and typical wrong answers; a student's way from start to report; figures of
// the READMEs.
#include "base/files.hpp"
#include "base/image.hpp"
#include "render/deviations.hpp"
#include "support/long_tests.hpp"
#include "support/subprocess.hpp"
#include "support/temp_folder.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <regex>
#include <sstream>

namespace lucerna::test {
namespace {

using nlohmann::json;

json readJson(const std::filesystem::path& file) { return json::parse(readFileText(file)); }

std::vector<json> labs() {
  TempFolder folder;
  const RunResult listed = RUN_LUCERNA(fmt::format("lab list --json {}", (folder / "labs.json").string()));
  EXPECT_EQ(listed.exitCode, 0) << listed.err;
  return readJson(folder / "labs.json").at("labs").get<std::vector<json>>();
}

/// Proves a lab: the stub is polite, the solution passes, every mutant is refused, nine in ten with the right hint. The
/// programs of wrong answers are two thirds of all that the suite links: the long form alone has them checked against
/// the GLSL specification (programs.Glslang). Those of stubs and solutions come from LabReadme and LabReport.
void prove(int lab) {
  TempFolder folder;
  const std::string dump = longTests() || lab == 0 ? "" : "env -u LUCERNA_DUMP_PROGRAMS ";
  const RunResult proved =
      run(fmt::format("{}'{}' lab prove {} --json {}", dump, LUCERNA_BINARY, lab, (folder / "proof.json").string()));
  EXPECT_EQ(proved.exitCode, 0) << proved.out << proved.err;
  const json proof = readJson(folder / "proof.json").at("labs").at(0);
  EXPECT_TRUE(proof.at("stub_polite"));
  EXPECT_TRUE(proof.at("solution_passes"));
  EXPECT_GE(proof.at("mutants").size(), 10u);
  int right = 0;
  for (const json& mutant : proof.at("mutants")) {
    EXPECT_TRUE(mutant.at("rejected")) << mutant.dump();
    right += mutant.at("hint") == mutant.at("wanted") ? 1 : 0;
  }
  EXPECT_GE(10 * right, 9 * static_cast<int>(proof.at("mutants").size())) << proved.out;
  EXPECT_LT(proof.at("seconds"), 60.0) << "a check takes at most a minute on two cores of software GL";
}

// A suite each, so that they run beside each other.
TEST(LabProof1, Furnace) { prove(1); }
TEST(LabProof2, Shadows) { prove(2); }
TEST(LabProof3, Harmonics) { prove(3); }
TEST(LabProof4, Propagation) { prove(4); }
TEST(LabProof5, Cascades) { prove(5); }
TEST(LabProof6, Hemicubes) { prove(6); }
TEST(LabProof7, Paths) { prove(7); }
TEST(LabProof8, Media) { prove(8); }

std::filesystem::path folderOf(const json& lab) {
  return std::filesystem::path(LUCERNA_SOURCE_DIR) / "demo/labs" / lab.at("folder").get<std::string>();
}

TEST(LabList, EightLabsOfThreeToFiveFunctions) {
  const std::vector<json> all = labs();
  ASSERT_EQ(all.size(), 8u);
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(all[i].at("lab"), i + 1) << "LabProof" << i + 1 << " proves it, LabFalseAlarms" << i + 1 << " runs it";
    const std::string tasks = readFileText(folderOf(all[i]) / "tasks.glsl");
    int functions = 0;
    while (tasks.find(fmt::format("NOT_DONE({})", functions + 1)) != std::string::npos) ++functions;
    EXPECT_GE(functions, 3) << all[i].at("folder");
    EXPECT_LE(functions, 5) << all[i].at("folder");
    EXPECT_EQ(all[i].at("tasks").size(), static_cast<std::size_t>(functions) + 1)
        << "the functions, and what they do together";
    const std::string hints = readFileText(folderOf(all[i]) / "hints.txt");
    for (const json& task : all[i].at("tasks"))
      for (int level = 1; level <= 3; ++level)
        EXPECT_NE(("\n" + hints).find(fmt::format("\n{}.{} ", task.at("number").dump(), level)), std::string::npos)
            << all[i].at("folder") << ' ' << task << ' ' << level;
  }
}

/// A correct answer fails less than once in 10,000 runs: at most one of 10,000 may, and about 1 % of the tests have p <
/// 1 %.
void countFalseAlarms(int lab) {
  if (!longTests()) GTEST_SKIP() << "minutes: LUCERNA_LONG_TESTS";
  constexpr int kRuns = 10000;
  TempFolder folder;
  const RunResult proved =
      RUN_LUCERNA(fmt::format("lab prove {} --runs {} --json {}", lab, kRuns, (folder / "proof.json").string()));
  const json proof = readJson(folder / "proof.json").at("labs").at(0);
  EXPECT_EQ(proof.at("runs"), kRuns);
  EXPECT_LE(proof.at("refusals"), 1) << proved.out;
  EXPECT_GE(proof.at("tests"), kRuns) << "every lab has a statistical test";
  const double share = proof.at("below_1_percent").get<double>() / proof.at("tests").get<double>();
  EXPECT_LT(share, 0.02) << proved.out;
}

TEST(LabFalseAlarms1, Furnace) { countFalseAlarms(1); }
TEST(LabFalseAlarms2, Shadows) { countFalseAlarms(2); }
TEST(LabFalseAlarms3, Harmonics) { countFalseAlarms(3); }
TEST(LabFalseAlarms4, Propagation) { countFalseAlarms(4); }
TEST(LabFalseAlarms5, Cascades) { countFalseAlarms(5); }
TEST(LabFalseAlarms6, Hemicubes) { countFalseAlarms(6); }
TEST(LabFalseAlarms7, Paths) { countFalseAlarms(7); }
TEST(LabFalseAlarms8, Media) { countFalseAlarms(8); }

TEST(LabReadme, FiguresOfAnotherSeedAreNotTold) {
  const RunResult refused = RUN_LUCERNA("lab figures 1 --seed ada");  // they are that student's answers
  EXPECT_EQ(refused.exitCode, 2);
  EXPECT_EQ(refused.out, "");
}

TEST(LabReadme, FiguresAreThoseOfTheCheck) {
  for (const json& lab : labs()) {
    const std::string readme = readFileText(std::filesystem::path(LUCERNA_SOURCE_DIR) / "demo/labs" /
                                            lab.at("folder").get<std::string>() / "README.md");
    const RunResult figures = RUN_LUCERNA(fmt::format("lab figures {}", lab.at("lab").dump()));
    ASSERT_EQ(figures.exitCode, 0) << figures.err;
    std::istringstream stream(figures.out);
    int count = 0;
    for (std::string line; std::getline(stream, line); ++count)
      EXPECT_NE(readme.find(line + "\n"), std::string::npos) << lab.at("folder") << ": " << line;
    EXPECT_GE(count, 3) << lab.at("folder");
    for (const json& task : lab.at("tasks"))
      EXPECT_NE(readme.find(fmt::format("\n{}. ", task.at("number").dump())), std::string::npos)
          << lab.at("folder") << ": README.md does not name task " << task.at("number");
  }
}

// What README.md says to expect beside the table: every decimal is one of the check's figures.
TEST(LabReadme, ProseOfWhatToExpectQuotesTheCheck) {
  static const std::regex kDecimal(R"(-?\d+\.\d+)");
  int decimals = 0;
  for (const json& lab : labs()) {
    const std::string readme = readFileText(folderOf(lab) / "README.md"),
                      figures = RUN_LUCERNA(fmt::format("lab figures {}", lab.at("lab").dump())).out;
    const auto first = readme.find("## What to expect"), last = readme.find("## Sources");
    ASSERT_LT(first, last) << lab.at("folder");
    const std::string section = readme.substr(first, last - first);
    for (auto it = std::sregex_iterator(section.begin(), section.end(), kDecimal); it != std::sregex_iterator();
         ++it, ++decimals)
      EXPECT_NE(figures.find("| " + it->str()), std::string::npos) << lab.at("folder") << ": " << it->str();
  }
  EXPECT_GT(decimals, 30);
}

// Numbers of the text before the tasks, but for formulas (indented) and citations: decimals, percentages and whole
// numbers from 10 on are figures of the check, or follow from a definition that stands here.
TEST(LabReadme, NumbersOfTheTheoryAreFiguresOrDefinitions) {
  struct Defined {
    const char *lab, *number;
    double value;
  };
  const Defined definitions[] = {
      {"harmonics", "120", std::acos(-0.5) * 180.0 / std::numbers::pi},  // where 1/4 + cos/2 is zero
      {"propagation", "120", std::acos(-0.5) * 180.0 / std::numbers::pi},
      {"hemicubes", "0.001", 0.001},  // an example
      {"hemicubes", "0.95", 0.95},
      {"hemicubes", "19", 0.95 / (1.0 - 0.95)},
      {"media", "23", 23.0},  // litres of the tank [Narasimhan2006]
      {"media", "0.9", 0.9},  // albedo and g of the table [vanDeHulst1980]
      {"media", "0.75", 0.75},
  };
  // Arguments of functions are formulas too.
  static const std::regex kFormulasAndCitations(R"(\n    [^\n]*|\[\w+\d{4}[^\]]*\]|\b\w+\((?:[^()]|\([^()]*\))*\))"),
      kNumber(R"(\d+\.\d+|\d+(?= %)|\b\d{2,}\b)");
  int figuresQuoted = 0, definitionsUsed = 0;
  for (const json& lab : labs()) {
    const std::string folder = lab.at("folder"), readme = readFileText(folderOf(lab) / "README.md"),
                      figures = RUN_LUCERNA(fmt::format("lab figures {}", lab.at("lab").dump())).out;
    const auto tasks = readme.find("## Tasks");
    ASSERT_NE(tasks, std::string::npos) << folder;
    const std::string theory = std::regex_replace(readme.substr(0, tasks), kFormulasAndCitations, " ");
    for (auto it = std::sregex_iterator(theory.begin(), theory.end(), kNumber); it != std::sregex_iterator(); ++it) {
      const auto defined = std::find_if(std::begin(definitions), std::end(definitions),
                                        [&](const Defined& d) { return folder == d.lab && it->str() == d.number; });
      if (defined != std::end(definitions)) {
        ++definitionsUsed;
        EXPECT_NEAR(std::stod(it->str()), defined->value, 1e-9) << folder;
      } else {
        ++figuresQuoted;
        EXPECT_NE(figures.find("| " + it->str()), std::string::npos) << folder << ": " << it->str();
      }
    }
  }
  EXPECT_GE(figuresQuoted, 8);
  EXPECT_GE(definitionsUsed, static_cast<int>(std::size(definitions)));
}

// Points of tasks and questions, how near a figure must be, and the hours: as the program and the instructors' page
// have them.
TEST(LabReadme, PointsTolerancesAndHours) {
  static const std::regex kPoints(R"((\d+)\s+points)"), kWithin(R"(counts (exactly|within ([0-9.]+) %)$)"),
      kTo(R"(\bto\s+([0-9.]+) %)");
  const std::string course = readFileText(std::filesystem::path(LUCERNA_SOURCE_DIR) / "docs/teaching.md");
  for (const json& lab : labs()) {
    const std::string folder = lab.at("folder"), readme = readFileText(folderOf(lab) / "README.md");
    const auto between = [&](const std::string& from, const std::string& to) {
      const auto first = readme.find(from), last = readme.find(to, first + from.size());
      return first == std::string::npos ? "" : readme.substr(first, last - first);
    };
    std::smatch match;
    int sum = 0;
    for (const json& task : lab.at("tasks")) {
      const int number = task.at("number");
      const std::string text = between(fmt::format("\n{}. ", number), number < static_cast<int>(lab.at("tasks").size())
                                                                          ? fmt::format("\n{}. ", number + 1)
                                                                          : std::string("## Questions"));
      ASSERT_TRUE(std::regex_search(text, match, kPoints)) << folder << ' ' << number;
      EXPECT_EQ(match[1].str(), task.at("points").dump()) << folder << ' ' << number;
      sum += task.at("points").get<int>();
    }
    const std::string questions = between("## Questions", "## What to expect");
    ASSERT_TRUE(std::regex_search(questions, match, kPoints)) << folder;
    EXPECT_EQ(std::stoi(match[1]), 100 - sum) << folder;

    // Whatever is answered, the check says how near it must be.
    TempFolder mine;
    const std::string dir = (mine / "mine").string();
    ASSERT_EQ(RUN_LUCERNA(fmt::format("lab start {} {}", lab.at("lab").dump(), dir)).exitCode, 0);
    std::string answers = readFileText(mine / "mine/answers.txt");
    answers = std::regex_replace(answers, std::regex(R"(=[ \t]*\n)"), "= 1\n");
    writeFileAtomically(mine / "mine/answers.txt", answers);
    RUN_LUCERNA(fmt::format("lab check {} {} --json {}", lab.at("lab").dump(), dir, (mine / "check.json").string()));
    int answered = 0;
    const json checked = readJson(mine / "check.json");
    for (const json& check : checked.at("checks")) {
      if (check.at("task") != 0) continue;
      ++answered;
      const std::string name = check.at("name").get<std::string>().substr(std::string("question ").size()),
                        sigma = check.at("sigma");
      const auto at = questions.find(fmt::format("\n- `{}`:", name));
      ASSERT_NE(at, std::string::npos) << folder << ": README.md does not ask for " << name;
      const std::string text = questions.substr(at, questions.find("\n- ", at + 1) - at);
      std::smatch within, to;
      ASSERT_TRUE(std::regex_search(sigma, within, kWithin)) << folder << ' ' << name << ": " << sigma;
      if (text.find("whole number") != std::string::npos) EXPECT_EQ(within[1], "exactly") << folder << ' ' << name;
      else if (std::regex_search(text, to, kTo)) EXPECT_EQ(within[2], to[1]) << folder << ' ' << name;
      else EXPECT_EQ(within[2], "0.5") << folder << ' ' << name << ", as README.md says of all others";
    }
    EXPECT_GE(answered, 3) << folder;

    const std::string hours = readme.substr(readme.find('\n') + 1, readme.find(" hours") - readme.find('\n') - 1);
    const std::string inWords = hours == "Two"            ? "2"
                                : hours == "Three"        ? "3"
                                : hours == "Two to three" ? "2 to 3"
                                                          : "?";
    const std::regex inCourse(fmt::format(R"(\| {} [^|]*\|[^|]*\| {} \|)", lab.at("lab").dump(), inWords));
    EXPECT_TRUE(std::regex_search(course, inCourse)) << folder << ": " << hours;
  }
}

// The pictures that a README shows are the references of the check.
TEST(LabReadme, PicturesAreThoseOfTheCheck) {
  static const std::regex kPicture(R"(!\[[^\]]+\]\((\w+\.png)\))");
  for (const json& lab : labs()) {
    TempFolder folder;
    const RunResult made =
        RUN_LUCERNA(fmt::format("lab figures {} --pictures {}", lab.at("lab").dump(), folder.path().string()));
    ASSERT_EQ(made.exitCode, 0) << made.err;
    const std::string readme = readFileText(folderOf(lab) / "README.md");
    int shown = 0;
    for (auto it = std::sregex_iterator(readme.begin(), readme.end(), kPicture); it != std::sregex_iterator();
         ++it, ++shown) {
      const std::string name = (*it)[1].str();
      const Bitmap inReadme = readBitmap(folderOf(lab) / name), ofCheck = readBitmap(folder / name);
      ASSERT_EQ(inReadme.rgba.size(), ofCheck.rgba.size()) << name;
      int worst = 0;
      for (std::size_t i = 0; i < ofCheck.rgba.size(); ++i)
        worst = std::max(worst, std::abs(int(inReadme.rgba[i]) - int(ofCheck.rgba[i])));
      EXPECT_LE(worst, 1) << lab.at("folder") << '/' << name;  // another libm rounds elsewhere
    }
    EXPECT_GE(shown, 1) << lab.at("folder");
  }
}

// What students look for follows from their seed, in every lab: the sample solution is right for two of them, though
// their parameters and what is expected of it differ. Most checks are at points that a run's nonce chooses.
TEST(LabSeeds, ParametersAndAnswersFollowFromTheSeed) {
  for (const json& lab : labs()) {
    const TempFolder folder;
    const auto expectedOf = [&](const std::string& seed, const std::string& name) {
      const std::string number = lab.at("lab").dump(), hand = "'" + (folder.path() / name).string() + "'";
      const std::string report = (folder.path() / (name + ".json")).string();
      EXPECT_EQ(RUN_LUCERNA("lab start " + number + " " + hand + " --seed " + seed).exitCode, 0);
      EXPECT_EQ(RUN_LUCERNA("lab solution " + number + " " + hand).exitCode, 0);
      const std::string told =
          RUN_LUCERNA("lab check " + number + " " + hand + " --nonce 1 --json '" + report + "'").out;
      const std::size_t own = told.find("yours: ");
      std::vector<std::string> expected{told.substr(own, told.find('\n', own) - own)};  // the parameters
      const json checks = readJson(report).at("checks");
      for (const json& check : checks)
        if (const std::string text = check.at("expected"); text.find_first_of("0123456789") != std::string::npos) {
          EXPECT_EQ(check.at("verdict"), "passed") << lab.at("folder") << ' ' << check;
          expected.push_back(text);
        }
      return expected;
    };
    const std::vector<std::string> ada = expectedOf("ada", "first"), bob = expectedOf("bob", "second");
    ASSERT_EQ(ada.size(), bob.size()) << lab.at("folder");

    int different = 0;
    for (std::size_t i = 0; i < ada.size(); ++i) different += ada[i] != bob[i] ? 1 : 0;
    EXPECT_GE(different, 2) << lab.at("folder");
    EXPECT_EQ(ada, expectedOf("ada", "again")) << lab.at("folder");
  }
}

// The template of docs/teaching.md is a lab like any other, of a hundred lines.
TEST(LabProof0, Template) { prove(0); }
TEST(LabTemplate, HasAHundredLines) {
  std::ptrdiff_t lines = 0;
  for (const auto& file :
       std::filesystem::directory_iterator(std::filesystem::path(LUCERNA_SOURCE_DIR) / "demo/labs/template")) {
    const std::string text = readFileText(file.path());
    lines += std::count(text.begin(), text.end(), '\n');
  }
  EXPECT_LE(lines, 100);
  EXPECT_GE(lines, 50) << "the files are not there";
}

// Every deviation has its room, and every room names a test that is there. The long form makes the page as
// a user does, with more samples and patches.
TEST(LabMuseum, EveryDeviationHasARoomAndATest) {
  TempFolder folder;
  const RunResult made =
      RUN_LUCERNA(fmt::format("lab museum {} -o {}", longTests() ? "" : "--small", (folder / "museum.html").string()));
  ASSERT_EQ(made.exitCode, 0) << made.err;
  const std::string html = readFileText(folder / "museum.html");
  for (const Deviation& deviation : allDeviations())
    EXPECT_NE(html.find(fmt::format("<section id=\"{}\">", deviation.name)), std::string::npos) << deviation.name;
  static const std::regex kTest(R"(<code>(tests/[a-z_/]+\.cpp): (\w+)</code>)");
  int rooms = 0;
  for (auto it = std::sregex_iterator(html.begin(), html.end(), kTest); it != std::sregex_iterator(); ++it, ++rooms) {
    const std::string text = readFileText(std::filesystem::path(LUCERNA_SOURCE_DIR) / (*it)[1].str());
    EXPECT_NE(text.find(fmt::format(", {}) {{", (*it)[2].str())), std::string::npos) << it->str();
  }
  EXPECT_EQ(rooms, static_cast<int>(allDeviations().size()));
  // Each room has a picture right, one with the mistake, and where the two differ.
  for (const Deviation& deviation : allDeviations()) {
    const auto at = html.find(fmt::format("<section id=\"{}\">", deviation.name)), end = html.find("<h2>", at);
    ASSERT_LT(at, end);
    const std::string room = html.substr(at, end - at);
    int pictures = 0;
    for (std::size_t image = 0; (image = room.find("<img alt=", image)) != std::string::npos; ++image) ++pictures;
    EXPECT_GE(pictures, 2) << deviation.name;
    EXPECT_EQ(pictures == 2, room.find("no difference") != std::string::npos) << deviation.name;
  }
  EXPECT_EQ(html.find("://"), std::string::npos) << "the page stands by itself";  // no text of base64 has that
}

TEST(LabMuseum, ARoomIsShownAlone) {
  TempFolder folder;
  const std::string page = (folder / "room.html").string();
  const RunResult made = RUN_LUCERNA("lab museum --small --room rsm.gather-weight -o " + page);
  ASSERT_EQ(made.exitCode, 0) << made.err;
  const std::string html = readFileText(page);
  EXPECT_NE(html.find("<section id=\"rsm.gather-weight\">"), std::string::npos);
  EXPECT_EQ(html.find("<section"), html.rfind("<section"));
  const RunResult refused = RUN_LUCERNA("lab museum --room rsm.nothing -o " + (folder / "no.html").string());
  EXPECT_EQ(refused.exitCode, 2);
  EXPECT_NE(refused.err.find("rsm.gather-weight"), std::string::npos) << refused.err;
  EXPECT_FALSE(std::filesystem::exists(folder / "no.html"));
}

// The answer follows from the seed; one candidate alone is right; the hidden one leaves a mark on the instruments.
TEST(LabMystery, OneCandidateIsRightAndLeavesAMark) {
  TempFolder folder;
  const RunResult shown = RUN_LUCERNA(
      fmt::format("lab mystery --seed ada -o {} --json {}", (folder / "m").string(), (folder / "m.json").string()));
  ASSERT_EQ(shown.exitCode, 0) << shown.err;
  const json mystery = readJson(folder / "m.json");
  double largest = 0.0;
  for (const json& r : mystery.at("readings"))
    largest = std::max(largest, std::abs(r.at("mystery").get<double>() / r.at("sound").get<double>() - 1.0));
  EXPECT_GT(largest, 0.01) << mystery.dump(1);
  int right = 0;
  for (const json& name : mystery.at("candidates")) {
    right +=
        RUN_LUCERNA(fmt::format("lab mystery --seed ada --answer {}", name.get<std::string>())).exitCode == 0 ? 1 : 0;
  }
  EXPECT_EQ(right, 1);
  EXPECT_EQ(RUN_LUCERNA("lab mystery --seed ada --answer lpv.nothing").exitCode, 2);
}

// A mystery of the path tracer has a white furnace among its instruments: sound, it reads 1.
TEST(LabMystery, PathTracerReadsAFurnace) {
  // Whose seed hides a deviation of the path tracer is told by the candidates, for which nothing is rendered: a wrong
  // name lists them.
  std::string seed;
  for (int k = 0; k < 100 && seed.empty(); ++k)
    if (RUN_LUCERNA(fmt::format("lab mystery --seed s{} --answer none", k)).err.find("path.") != std::string::npos)
      seed = fmt::format("s{}", k);
  ASSERT_FALSE(seed.empty());
  TempFolder folder;
  const RunResult shown = RUN_LUCERNA(fmt::format("lab mystery --seed {} -o {} --json {}", seed,
                                                  (folder / "m").string(), (folder / "m.json").string()));
  ASSERT_EQ(shown.exitCode, 0) << shown.err;
  const json mystery = readJson(folder / "m.json");
  EXPECT_EQ(mystery.at("technique"), "path");
  EXPECT_EQ(mystery.at("readings").at(0).at("instrument"), "white furnace");
  EXPECT_NEAR(mystery.at("readings").at(0).at("sound").get<double>(), 1.0, 1e-5);
  double largest = 0.0;
  for (const json& r : mystery.at("readings"))
    largest = std::max(largest, std::abs(r.at("mystery").get<double>() / r.at("sound").get<double>() - 1.0));
  EXPECT_GT(largest, 0.01) << mystery.dump(1);
}

// The program of the labs alone (demo/lab) lists, starts and checks as the whole one does; what renders is not in it.
TEST(LabsAlone, AreThoseOfTheWholeProgram) {
  const auto alone = [](const std::string& arguments) { return run("'" LUCERNA_LABS_BINARY "' lab " + arguments); };
  EXPECT_EQ(alone("list").out, RUN_LUCERNA("lab list").out);
  TempFolder folder;
  const std::string dir = (folder / "mine").string();
  ASSERT_EQ(alone(fmt::format("start 5 {} --seed ada", dir)).exitCode, 0);
  ASSERT_EQ(alone(fmt::format("solution 5 {}", dir)).exitCode, 0);
  const auto score = [&](const RunResult& checked) {
    EXPECT_EQ(checked.exitCode, 2) << "answers.txt is empty: " << checked.out << checked.err;
    return checked.out.substr(checked.out.find("task 1"));
  };
  const std::string whole = score(RUN_LUCERNA(fmt::format("lab check 5 {} --nonce 3", dir)));
  EXPECT_EQ(score(alone(fmt::format("check 5 {} --nonce 3", dir))), whole);
  EXPECT_NE(whole.find("85.0 of 100"), std::string::npos) << whole;
  EXPECT_EQ(alone("museum").exitCode, 2);
}

class LabWay : public ::testing::Test {
 protected:
  TempFolder folder;
  std::filesystem::path dir = folder / "mine";
  RunResult lab(const std::string& arguments) { return RUN_LUCERNA(fmt::format("lab {}", arguments)); }
  void start() { ASSERT_EQ(lab(fmt::format("start 1 {} --seed ada", dir.string())).exitCode, 0); }
  void edit(const std::string& from, const std::string& to) {
    std::string text = readFileText(dir / "tasks.glsl");
    const auto at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    writeFileAtomically(dir / "tasks.glsl", text.replace(at, from.size(), to));
  }
};

TEST_F(LabWay, StubIsPolite) {
  start();
  const RunResult checked = lab(fmt::format("check 1 {}", dir.string()));
  EXPECT_EQ(checked.exitCode, 2);
  EXPECT_NE(checked.out.find("task 1 not done"), std::string::npos) << checked.out;
  EXPECT_NE(checked.out.find("0.0 of 100"), std::string::npos) << checked.out;
  EXPECT_EQ(lab(fmt::format("start 1 {}", dir.string())).exitCode, 2) << "nothing is overwritten";
}

TEST_F(LabWay, CompileErrorsNameFileAndLine) {
  start();
  edit("  NOT_DONE(1)\n  return vec3(0.0);", "  return vec3(unknown);");
  const RunResult checked = lab(fmt::format("check 1 {}", dir.string()));
  EXPECT_EQ(checked.exitCode, 2);
  const std::string text = readFileText(dir / "tasks.glsl");
  const auto line =
      std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(text.find("unknown")), '\n') + 1;
  EXPECT_NE(checked.out.find(fmt::format("{}:{}: error", (dir / "tasks.glsl").string(), line)), std::string::npos)
      << checked.out;
  EXPECT_NE(checked.out.find("unknown"), std::string::npos) << checked.out;
  EXPECT_EQ(checked.out.find("kernel.comp"), std::string::npos) << "a file that is not the student's: " << checked.out;
}

TEST_F(LabWay, ProbesAreOutOfReach) {
  for (const char* line : {"#define PROBE 2", "uint hack = gl_GlobalInvocationID.x;",
                           "layout(std430) buffer B { float b[]; };", "float x = float(labNoise);"}) {
    std::filesystem::remove_all(dir);
    start();
    edit("// TASK 1", fmt::format("{}\n// TASK 1", line));
    const RunResult checked = lab(fmt::format("check 1 {}", dir.string()));
    EXPECT_EQ(checked.exitCode, 2) << line;
    EXPECT_NE(checked.out.find("has no place here"), std::string::npos) << checked.out;
  }
}

TEST_F(LabWay, MissingFunctionIsTold) {
  start();
  edit("vec3 reflected(", "vec3 reflectedLight(");
  edit("  NOT_DONE(1)\n", "");
  const RunResult checked = lab(fmt::format("check 1 {}", dir.string()));
  EXPECT_EQ(checked.exitCode, 2);
  EXPECT_NE(checked.out.find("signature"), std::string::npos) << checked.out;
}

TEST_F(LabWay, FromHintToReport) {
  start();
  for (int level = 1; level <= 4; ++level) {
    const RunResult hint = lab(fmt::format("hint 1.2 {}", dir.string()));
    EXPECT_EQ(hint.exitCode, 0) << hint.err;
    EXPECT_NE(hint.out.find(fmt::format("hint {} of 3", std::min(level, 3))), std::string::npos) << hint.out;
  }
  ASSERT_EQ(lab(fmt::format("solution 1 {}", dir.string())).exitCode, 0);
  EXPECT_TRUE(std::filesystem::exists(dir / "tasks.mine.glsl")) << "the student's own file is kept";
  const std::string files = fmt::format("--json {} --junit {} --gradescope {}", (folder / "r.json").string(),
                                        (folder / "r.xml").string(), (folder / "g.json").string());
  EXPECT_EQ(lab(fmt::format("check 1 {} {} --nonce 7", dir.string(), files)).exitCode, 2)
      << "answers.txt is empty still";
  const json result = readJson(folder / "r.json");
  EXPECT_EQ(result.at("score"), 85.0) << result.dump(1);
  EXPECT_EQ(result.at("seed"), "ada");
  EXPECT_EQ(result.at("nonce"), 7);
  const json gradescope = readJson(folder / "g.json");
  EXPECT_EQ(gradescope.at("score"), 85.0);
  EXPECT_EQ(gradescope.at("tests").size(), 7u);
  const std::string junit = readFileText(folder / "r.xml");
  EXPECT_NE(junit.find("failures=\"3\""), std::string::npos) << junit.substr(0, 300);

  ASSERT_EQ(lab(fmt::format("report 1 {}", dir.string())).exitCode, 0);
  const std::string html = readFileText(dir / "report.html");
  EXPECT_NE(html.find("The sample solution was put into this hand-in"), std::string::npos);
  EXPECT_NE(html.find("data:image/png;base64,"), std::string::npos);
  EXPECT_NE(html.find("<svg"), std::string::npos);
  EXPECT_EQ(html.find("://"), std::string::npos) << "the page stands by itself";  // no text of base64 has that
  const json state = readJson(dir / "lab.json");
  EXPECT_EQ(state.at("hints").size(), 4u);
  EXPECT_EQ(state.at("checks").size(), 2u);

  ASSERT_EQ(lab(fmt::format("show 1 {}", dir.string())).exitCode, 0);
  EXPECT_TRUE(std::filesystem::exists(dir / "pictures/lamp.mine.png"));
}

// Words below the line of answers.txt are for the report: no figure is read there.
TEST_F(LabWay, WordsAreForTheReportAlone) {
  start();
  std::ofstream(dir / "answers.txt", std::ios::app) << "Because value over density is constant:\nfurnace = 1\n";
  const RunResult checked = lab(fmt::format("check 1 {}", dir.string()));
  EXPECT_NE(checked.out.find("furnace has no number yet"), std::string::npos) << checked.out;
  lab(fmt::format("report 1 {}", dir.string()));
  EXPECT_NE(readFileText(dir / "report.html").find("Because value over density is constant:"), std::string::npos);
}

// A task's time runs from the task that was right before it, whatever their numbers.
TEST_F(LabWay, ReportTellsTheTimePerTask) {
  start();
  ASSERT_EQ(lab(fmt::format("solution 1 {}", dir.string())).exitCode, 0);
  json state = readJson(dir / "lab.json");
  state["started"] = 1000;
  state["checks"] = {{{"time", 1060}, {"seconds", 1.0}, {"score", 20.0}, {"passed", {2}}},
                     {{"time", 1240}, {"seconds", 1.0}, {"score", 35.0}, {"passed", {1, 2}}}};
  writeFileAtomically(dir / "lab.json", state.dump());
  ASSERT_EQ(lab(fmt::format("report 1 {}", dir.string())).exitCode, 0);
  const std::string html = readFileText(dir / "report.html");
  const auto row = [&](const std::string& task) {
    const auto at = html.find("<tr><td>" + task);
    return at == std::string::npos ? "" : html.substr(at, html.find("</tr>", at) - at);
  };
  EXPECT_NE(row("1. reflected").find("4 min</td><td class=\"n\">3 min"), std::string::npos) << row("1. reflected");
  EXPECT_NE(row("2. sampleCosine").find("60 s</td><td class=\"n\">60 s"), std::string::npos) << row("2. sampleCosine");
  EXPECT_NE(row("questions").find("0 of 15"), std::string::npos) << row("questions");
}

TEST_F(LabWay, ChecksPrintWhatWasExpectedAndMeasured) {
  start();
  ASSERT_EQ(lab(fmt::format("solution 1 {}", dir.string())).exitCode, 0);
  const std::regex passed(R"(passed    furnace: radiance 1 all around gives the albedo\n +)"
                          R"(expected 0\.\d+, measured 0\.\d+ \+- [0-9.e-]+ \([0-9.]+ sigma\))");
  const RunResult right = lab(fmt::format("check 1 {}", dir.string()));
  EXPECT_TRUE(std::regex_search(right.out, passed)) << right.out;
  edit("albedo / PI", "albedo");
  const RunResult wrong = lab(fmt::format("check 1 {}", dir.string()));
  const std::regex refused(R"(wrong     reflected light at points\n +expected .+\n +measured .+\n +)"
                           R"(\d+ of \d+ points agree.+\n +likeliest: 1 / pi is missing)");
  EXPECT_TRUE(std::regex_search(wrong.out, refused)) << wrong.out;
}

// lab show --watch: what does not compile is told, and the last good pictures stay; the next save that does replaces
// them.
TEST_F(LabWay, WatchKeepsTheLastGoodPictures) {
  start();
  ASSERT_EQ(lab(fmt::format("solution 1 {}", dir.string())).exitCode, 0);
  const std::string script = fmt::format(
      "cd {0} && {{ '{1}' lab show 1 . --watch >log 2>&1 & }}; pid=$!\n"
      "until_there() {{ for i in $(seq 600); do [ \"$(grep -c \"$1\" log)\" -ge $2 ] && return; sleep 0.1; done; echo "
      "\"no $1 within a minute\"; cat log; kill $pid; exit 1; }}\n"
      "until_there 'of 100' 1; until_there difference10 1; cp pictures/lamp.mine.png good.png\n"
      "cp tasks.glsl right.glsl; echo 'float broken( {{' >>tasks.glsl; until_there 'Nothing can be judged' 1\n"
      "cmp pictures/lamp.mine.png good.png || {{ kill $pid; exit 2; }}\n"
      // At once: an empty file would be a save of its own.
      "sed 's/albedo . PI/albedo/' right.glsl >next.glsl; mv next.glsl tasks.glsl; until_there 'likeliest: 1 . pi' 1\n"
      "kill -TERM $pid; wait $pid\n",
      dir.string(), LUCERNA_BINARY);
  const RunResult watched = run(script);
  EXPECT_EQ(watched.exitCode, 0) << watched.out << watched.err;
  EXPECT_NE(readFileText(dir / "log").find("tasks.glsl:"), std::string::npos);
  EXPECT_EQ(readJson(dir / "lab.json").at("checks").size(), 3u) << "for the time per task in the report";
}

// Every lab's hand-in has a picture with a slider and a plot.
TEST(LabReport, EveryLabHasPicturesAndPlots) {
  for (const json& lab : labs()) {
    TempFolder folder;
    const std::string number = lab.at("lab").dump(), dir = (folder / "mine").string();
    ASSERT_EQ(RUN_LUCERNA(fmt::format("lab start {} {}", number, dir)).exitCode, 0);
    ASSERT_EQ(RUN_LUCERNA(fmt::format("lab solution {} {}", number, dir)).exitCode, 0);
    ASSERT_EQ(RUN_LUCERNA(fmt::format("lab report {} {}", number, dir)).exitCode, 0);
    const std::string html = readFileText(folder / "mine/report.html");
    for (const char* part : {"<h2>Answers</h2>", "<h2>Checks</h2>", "data:image/png;base64,", "type=\"range\"", "<svg"})
      EXPECT_NE(html.find(part), std::string::npos) << lab.at("folder") << ": " << part;
    static const std::regex kLine(R"(<polyline[^>]*points="[0-9., ]{20,}"/>)");
    EXPECT_TRUE(std::regex_search(html, kLine)) << lab.at("folder") << ": a plot without numbers";
  }
}

// The same nonce gives the same result, another seed other parameters.
TEST_F(LabWay, NonceAndSeed) {
  start();
  ASSERT_EQ(lab(fmt::format("solution 1 {}", dir.string())).exitCode, 0);
  const auto checked = [&](const std::string& options) {
    lab(fmt::format("check 1 {} {} --json {}", dir.string(), options, (folder / "r.json").string()));
    json result = readJson(folder / "r.json");
    result.erase("seconds");
    return result;
  };
  const json once = checked("--nonce 11"), again = checked("--nonce 11"), otherNonce = checked("--nonce 12"),
             otherSeed = checked("--nonce 11 --seed bob");
  EXPECT_EQ(once, again);
  EXPECT_NE(once.at("checks"), otherNonce.at("checks"));
  EXPECT_NE(once.at("checks"), otherSeed.at("checks"));
}

}  // namespace
}  // namespace lucerna::test
