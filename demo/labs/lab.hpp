// Teaching labs: the definition of a lab, and the checks that judge a hand-in. docs/teaching.md describes how to write
// a lab.
//
// A lab is a folder (README.md, tasks.glsl, probe.glsl, hints.txt, mutants.txt), a solution (solutions/FOLDER.glsl) and
// one .cpp with a Lab: its tasks and a function that checks them. The student edits tasks.glsl. Each check runs one
// probe: kernel.comp with the student's file and the lab's probe.glsl, whose `vec4 probe()` is called once per
// invocation. Probe points are drawn anew in each run (from the nonce); the student's parameters (albedo, g, ...)
// follow from the student's seed.
//
// Statistics: each test rejects a correct answer with probability at most kFalseAlarm / kMostTests (Bonferroni), and a
// whole check thus with at most kFalseAlarm, below once in 10,000 runs. The thresholds come from Student's t and the
// chi-square distribution.
#pragma once

#include "base/image.hpp"
#include "gl/program.hpp"
#include "labs/random.hpp"

#include <glm/glm.hpp>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lucerna::demo::labs {

constexpr double kFalseAlarm = 2e-5;  ///< probability per run of `lab check`
constexpr int kMostTests = 40;  ///< maximum number of statistical tests in a lab
constexpr double kFirmness = 1e-6;  ///< relative float rounding allowed in a mean in addition to its noise

/// A typical mistake: the value it would give, and the message to the student.
struct Mistake {
  std::string id = {};  ///< such as "lost-cosine"; mutants.txt names it
  std::string text = {};  ///< one sentence to the student
};

/// One probe point as the GPU gets it: `stride` vectors of floats.
using Point = std::span<const glm::vec4>;
using Function = std::function<glm::dvec4(Point)>;

/// Compares a function with its reference implementation in double precision, point by point.
struct Reference {
  int probe = 0;
  int stride = 1;
  std::function<void(Random&, std::span<glm::vec4>)> draw = {};  ///< fills one point
  Function reference = {};
  struct Wrong {
    Mistake mistake;
    Function value;
  };
  std::vector<Wrong> mistakes = {};
  double tolerance = 1e-4;  ///< relative to |reference| plus a hundredth of its root mean square: float rounding, far
                            ///< below any mistake
  int points = 2048;
};

/// Compares the mean of the invocations' independent results in .x with its expected value: Student's t test.
struct Mean {
  int probe = 0;
  std::vector<glm::vec4> inputs = {};
  double expected = 0.0;
  struct Wrong {
    Mistake mistake;
    double value;
  };
  std::vector<Wrong> mistakes = {};
  int invocations = 4096;
};

/// Compares samples with the probabilities of bins: a chi-square test. A sample outside all bins rejects the answer by
/// itself.
struct ChiSquare {
  int probe = 0;
  std::vector<glm::vec4> inputs = {};
  std::function<int(const glm::vec4&)> bin = {};  ///< -1: outside all bins
  std::vector<double> shares = {};  ///< of each bin; their sum is 1
  struct Wrong {
    Mistake mistake;
    std::vector<double> shares;
  };
  std::vector<Wrong> mistakes = {};
  int samples = 1 << 16;
};

/// Compares a picture with a reference; .rgb is the mean of an invocation's samples and .a the variance of the mean of
/// its three channels. Tiles of 8 by 8 pixels are tested by Student's t, each with its share of the false alarms. A
/// picture without noise (.a = 0) must agree within 1e-3.
struct Picture {
  int probe = 0;
  std::vector<glm::vec4> inputs = {};
  glm::ivec2 size{96, 64};
  std::function<glm::dvec3(glm::ivec2)> reference = {};  ///< row 0 at the top
  struct Wrong {
    Mistake mistake;
    std::function<glm::dvec3(glm::ivec2)> value;
  };
  std::vector<Wrong> mistakes = {};
  std::string caption = {};
};

enum class Verdict { passed, wrong, notDone, waiting };
const char* nameOf(Verdict verdict);

struct CheckResult {
  int task = 0;
  std::string name = {}, expected = {}, measured = {}, sigma = {};
  Verdict verdict = Verdict::wrong;
  Mistake mistake = {};  ///< the most likely one, if the answer is wrong
  double pValue = -1.0;  ///< of a statistical test; -1: none
};

struct PictureResult {
  std::string name, caption;
  Image mine, reference;
  float exposure = 1.0f;  ///< for displaying both: the reference's brightest channel is 1
};

struct Curve {
  std::string name, xLabel, yLabel;
  std::vector<glm::dvec2> mine, reference;
};

struct Task {
  int number = 0;
  std::string function;  ///< as named in README.md
  int points = 0;
  std::vector<int> needs;  ///< tasks that must be right before this one can be judged
};

class Checks;

struct Lab {
  int number = 0;
  std::string folder, title;
  std::vector<Task> tasks;
  int answerPoints = 0;  ///< for the questions with numbers; all points of a lab sum to 100
  void (*check)(Checks&) = nullptr;
};

/// In order; the template of docs/teaching.md is number 0 and not listed.
std::span<const Lab> allLabs();
/// Throws Error(badInput) listing the numbers.
const Lab& findLab(const std::string& number);

/// The parts of a hand-in that are judged: files, seed and numbers.
struct HandIn {
  std::string tasks;  ///< text of tasks.glsl
  std::string tasksName = "tasks.glsl";  ///< as messages name it
  std::filesystem::path tasksFile;  ///< to watch for changes (in a window); empty: only the text
  std::map<std::string, std::string> answers;  ///< answers.txt: name, text after the =
  std::string seed = "example";
};

struct Report {
  std::string renderer, seed;
  std::uint64_t nonce = 0;
  std::string compileError;  ///< file:line of the student's file; empty: it compiles
  std::vector<CheckResult> checks;
  std::vector<PictureResult> pictures;
  std::vector<Curve> curves;
  std::vector<std::pair<std::string, std::string>> yours;  ///< the student's parameters
  std::vector<std::pair<std::string, std::string>> figures;  ///< numbers quoted in README.md, for this seed
  std::vector<std::pair<std::string, double>> expectedAnswers;  ///< for tests; never shown
  double seconds = 0.0;

  Verdict verdictOf(int task) const;  ///< task 0: the questions
  double score(const Lab& lab) const;
  bool allPassed() const;
};

/// The programs of a hand-in's probes, loaded from a temporary folder with the installed shaders and, as lab/, the
/// files of this check. Needs a GL context. Programs are built on first use and kept: many checks of one hand-in
/// compile once.
class Probes {
 public:
  Probes(const Lab& lab, const HandIn& handIn);
  ~Probes();
  /// Throws Error(badInput) with the student's file and line if it does not compile.
  const gl::Program& load(const Lab& lab, int probe);

 private:
  std::filesystem::path root_;
  std::unique_ptr<gl::ProgramLibrary> programs_;
};

/// Runs a lab's checks on a hand-in; needs a GL context. The same nonce gives the same probe points and noise.
Report runChecks(const Lab& lab, const HandIn& handIn, std::uint64_t nonce);
/// The same, reusing the programs of an earlier check of the same hand-in.
Report runChecks(const Lab& lab, const HandIn& handIn, std::uint64_t nonce, Probes& probes);

/// answers.txt: one "name = value" per line, # begins a comment; text below a line of --- is prose and ignored.
std::map<std::string, std::string> parseAnswers(const std::string& text);
/// The NOT_DONE(n) that occur in the text outside comments.
std::vector<int> tasksNotDone(const std::string& text);
/// The first line with content forbidden in a task file (other preprocessor lines, layout, gl_, buffer, ...), as
/// "tasks.glsl:12: ..."; empty: none.
std::string forbiddenLine(const std::string& text, const std::string& name);

/// The interface for a lab's check function.
class Checks {
 public:
  Checks(const Lab& lab, const HandIn& handIn, std::uint64_t nonce, Report& report, Probes& probes);

  /// A parameter of the student's, uniform between the two, rounded to `digits` decimals so that it can be typed. It
  /// follows from seed and name.
  double parameter(const std::string& name, double least, double most, int digits = 3) const;
  /// A number that differs in each run, so that memorised results do not help.
  double fresh(double least, double most) { return random_.uniform(least, most); }
  /// Whether a task can be judged: it is done, and the tasks that it needs are right. Otherwise the report says so.
  bool task(int number);

  // Each returns whether it passed, so that later, harder checks can follow after &&.
  bool againstReference(const std::string& name, const Reference& expected);
  bool mean(const std::string& name, const Mean& mean);
  bool chiSquare(const std::string& name, const ChiSquare& test);
  bool picture(const std::string& name, const Picture& picture);
  /// The same for pixels that a lab assembled itself.
  bool picture(const std::string& name, const Picture& picture, const std::vector<glm::vec4>& pixels);
  /// A question's number in answers.txt. `tolerance` is relative.
  void answer(const std::string& name, double expected, double tolerance = 0.005,
              const std::vector<Mean::Wrong>& mistakes = {});
  /// Results of a probe, for curves and a lab's own checks.
  std::vector<glm::vec4> run(int probe, std::span<const glm::vec4> inputs, int stride, int count, int width = 1);
  void curve(Curve curve) { report_.curves.push_back(std::move(curve)); }
  /// A parameter of the questions: shown to the student, and also a number of the README.
  double yours(const std::string& name, double least, double most, int digits = 3);
  /// A number that README.md quotes for the seed "example"; a test compares them.
  void figure(const std::string& name, double value, int digits = 6);

 private:
  bool add(CheckResult result);
  const Lab& lab_;
  const HandIn& handIn_;
  Report& report_;
  Random random_;
  std::vector<int> notDone_;
  int task_ = 0, tests_ = 0;
  std::uint32_t noise_;
  Probes& probes_;
};

/// Irradiance at x with normal n from a polygon of radiance 1 wholly in front of x's surface, by Lambert's formula:
/// half the sum over edges of the angle they subtend times the cosine between the edge's plane and the surface
/// [Arvo1995].
double polygonIrradiance(std::span<const glm::dvec3> corners, const glm::dvec3& x, const glm::dvec3& n);
/// The same for a horizontal square above the floor y = 0.
double squareLampIrradiance(double side, double height, const glm::dvec3& x);

// Distributions, by incomplete gamma and beta functions: continued fractions and series [Press2007, 6.2, 6.4].
double chiSquareTail(double chiSquare, double degrees);  ///< P(X >= chiSquare)
double studentTail(double t, double degrees);  ///< P(|T| >= t)

}  // namespace lucerna::demo::labs
