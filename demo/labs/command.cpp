// lucerna lab: teaching labs that check and grade themselves.
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/log.hpp"
#include "shared/commands.hpp"
#include "gl/objects.hpp"
#include "labs/command.hpp"
#include "labs/hand_in.hpp"
#include "labs/prove.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <ctime>
#include <random>
#include <thread>

namespace lucerna::demo {

namespace {

using namespace labs;
namespace fs = std::filesystem;

struct LabOptions {
  CommonOptions common;
  std::string lab, folder = ".", seed, junit, gradescope, html, name, pictures;
  std::uint64_t nonce = 0;
  int runs = 0;
  bool watch = false;
};

constexpr int kWrong = 2;  ///< exit code for a hand-in with anything wrong or missing
constexpr unsigned kLongest = 300;  ///< seconds; a check takes at most 60

/// An endless loop in the student's code must not hang the check: GL cannot be interrupted, but the process can.
void watchTime() {
  std::signal(SIGALRM, [](int) {
    constexpr char kMessage[] =
        "lucerna: the check did not end within 300 s: is there a loop in tasks.glsl that never ends?\n";
    [[maybe_unused]] const auto written = write(STDERR_FILENO, kMessage, sizeof kMessage - 1);
    std::_Exit(kWrong);
  });
  alarm(kLongest);
}

std::uint64_t nonceOf(const LabOptions& options) {
  if (options.nonce != 0) return options.nonce;
  std::random_device device;
  return (static_cast<std::uint64_t>(device()) << 16 ^ device()) & 0xffffffffffffu;  // short enough to type
}

int list(const LabOptions& options) {
  options.common.apply();
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const Lab& lab : allLabs()) {
    fmt::print("{}  {}\n", lab.number, lab.title);
    nlohmann::ordered_json tasks = nlohmann::ordered_json::array();
    for (const Task& task : lab.tasks) {
      fmt::print("     {}.{} {} ({} points)\n", lab.number, task.number, task.function, task.points);
      tasks.push_back({{"number", task.number}, {"function", task.function}, {"points", task.points}});
    }
    json.push_back({{"lab", lab.number}, {"title", lab.title}, {"folder", lab.folder}, {"tasks", tasks}});
  }
  fmt::print("\nBegin with: lucerna lab start 1 my-lab-1 --seed YOUR-ID\n");
  options.common.writeJson({{"labs", json}});
  return 0;
}

int start(const LabOptions& options) {
  options.common.apply();
  const Lab& lab = findLab(options.lab);
  const std::string seed = options.seed.empty() ? "example" : options.seed;
  startLab(lab, options.folder, seed);
  fmt::print(
      "Lab {}: {}, seed {}\n  read     {}/README.md\n  edit     {}/tasks.glsl, {}/answers.txt\n  check    lucerna lab "
      "check {} {}\n",
      lab.number, lab.title, seed, options.folder, options.folder, options.folder, lab.number, options.folder);
  return 0;
}

struct Judged {
  Folder folder;
  Report report;
};
Judged judge(const Lab& lab, const LabOptions& options) {
  Judged judged{Folder::open(lab, options.folder, options.seed), {}};
  const HandIn handIn = judged.folder.handIn();
  watchTime();
  const auto host = options.common.makeHost(false);
  const gl::Context context;
  judged.report = runChecks(lab, handIn, nonceOf(options));
  judged.report.renderer = context.capabilities().renderer;
  alarm(0);
  return judged;
}

/// Stores the result in lab.json, if the folder is writable: a grader's may be read-only.
void note(Judged& judged, const Lab& lab) {
  nlohmann::ordered_json passed = nlohmann::ordered_json::array();
  for (const Task& task : lab.tasks)
    if (judged.report.verdictOf(task.number) == Verdict::passed) passed.push_back(task.number);
  judged.folder.state["checks"].push_back(
      {{"time", std::time(nullptr)},
       {"seconds", judged.report.seconds},
       {"score", judged.report.compileError.empty() ? judged.report.score(lab) : 0.0},
       {"passed", passed}});
  if (access(judged.folder.path.c_str(), W_OK) == 0) judged.folder.save();
}

int check(const LabOptions& options) {
  options.common.apply();
  const Lab& lab = findLab(options.lab);
  Judged judged = judge(lab, options);
  note(judged, lab);
  if (!options.common.quiet) fmt::print("{}", reportText(lab, judged.report));
  options.common.writeJson(reportJson(lab, judged.report));
  if (!options.junit.empty()) writeFileAtomically(options.junit, reportJunit(lab, judged.report));
  if (!options.gradescope.empty()) writeFileAtomically(options.gradescope, reportGradescope(lab, judged.report));
  return judged.report.allPassed() ? 0 : kWrong;
}

int hint(const LabOptions& options) {
  options.common.apply();
  const auto dot = options.lab.find('.');
  if (dot == std::string::npos) throwBadInput("hint {}: expected LAB.TASK, such as 1.2", options.lab);
  const std::string task = options.lab.substr(dot + 1);
  if (task.size() != 1 || task[0] < '1' || task[0] > '9')
    throwBadInput("hint {}: expected LAB.TASK, such as 1.2", options.lab);
  fmt::print("{}", takeHint(findLab(options.lab.substr(0, dot)), task[0] - '0', options.folder));
  return 0;
}

int solution(const LabOptions& options) {
  options.common.apply();
  const Lab& lab = findLab(options.lab);
  putSolution(lab, options.folder);
  fmt::print("The solution of lab {} is in {}/tasks.glsl; lab.json says so.\n", lab.number, options.folder);
  return 0;
}

/// Writes the student's picture, the reference and twice the difference as PNGs next to the hand-in.
void writePictures(const fs::path& folder, const Report& report) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throwBadInput("{}: {}", folder.string(), error.message());
  for (const PictureResult& picture : report.pictures) {
    Image off(picture.mine.width, picture.mine.height);
    for (std::size_t i = 0; i < off.pixels.size(); ++i)
      off.pixels[i] = 10.0f * glm::abs(picture.mine.pixels[i] - picture.reference.pixels[i]);
    writePng(folder / (picture.name + ".mine.png"), toneMapped(picture.mine, picture.exposure));
    writePng(folder / (picture.name + ".reference.png"), toneMapped(picture.reference, picture.exposure));
    writePng(folder / (picture.name + ".difference10.png"), toneMapped(off, picture.exposure));
    fmt::print("{}/{}.mine.png, .reference.png, .difference10.png: {}\n", folder.string(), picture.name,
               picture.caption);
  }
}

/// The student's pictures on the left, the references on the right, one below the other, as a window shows them: bottom
/// row first, each pixel six pixels wide.
struct Shown {
  glm::ivec2 size{0};
  std::vector<std::uint8_t> rgba;
};
Shown sideBySide(const Report& report) {
  constexpr int kScale = 6;
  std::vector<std::pair<Bitmap, Bitmap>> pairs;
  Shown shown;
  for (const PictureResult& p : report.pictures) {
    pairs.emplace_back(toneMapped(p.mine, p.exposure), toneMapped(p.reference, p.exposure));
    shown.size = {std::max(shown.size.x, 2 * kScale * p.mine.width), shown.size.y + kScale * p.mine.height};
  }
  shown.rgba.assign(static_cast<std::size_t>(shown.size.x) * static_cast<std::size_t>(shown.size.y) * 4, 0);
  int top = shown.size.y;
  for (const auto& [mine, reference] : pairs) {
    for (int y = 0; y < kScale * mine.height; ++y)
      for (int x = 0; x < 2 * kScale * mine.width; ++x) {
        const Bitmap& from = x < kScale * mine.width ? mine : reference;
        const auto source = 4 * static_cast<std::size_t>(y / kScale * mine.width + x / kScale % mine.width),
                   target = 4 * static_cast<std::size_t>((top - 1 - y) * shown.size.x + x);
        std::copy_n(&from.rgba[source], 4, &shown.rgba[target]);
      }
    top -= kScale * mine.height;
  }
  return shown;
}

/// Checks and redraws whenever the task file is saved, in a window if there is a display, until Escape or Ctrl-C. If
/// the file does not compile, the last good pictures stay.
int watch(const LabOptions& options, const Lab& lab) {
  watchForInterrupt();
  const auto host = options.common.makeHost(
      true, {.windowSize = {1152, 384}, .windowTitle = fmt::format("Lab {}: yours, and the reference", lab.number)});
  const gl::Context context;
  gl::Texture texture;
  gl::Framebuffer framebuffer;
  glm::ivec2 size(0);
  fs::file_time_type seen{};
  while (!interrupted()) {
    std::error_code error;
    if (const auto time = fs::last_write_time(fs::path(options.folder) / "tasks.glsl", error); !error && time != seen) {
      seen = time;
      Judged judged{Folder::open(lab, options.folder, options.seed), {}};
      watchTime();
      judged.report = runChecks(lab, judged.folder.handIn(), nonceOf(options));
      alarm(0);
      judged.report.renderer = context.capabilities().renderer;
      note(judged, lab);
      const Report& report = judged.report;
      fmt::print("{}", reportText(lab, report));
      std::fflush(stdout);
      if (report.compileError.empty() && !report.pictures.empty()) {
        writePictures(fs::path(options.folder) / "pictures", report);
        std::fflush(stdout);
        const Shown shown = sideBySide(report);
        size = shown.size;
        texture = gl::Texture("lab pictures", gl::Format::rgba8, size);
        texture.upload(gl::Texels::rgbaByte, shown.rgba.data());
        const gl::Texture* colors[] = {&texture};
        framebuffer = gl::Framebuffer("lab pictures", colors);
      }
    }
    if (size.x > 0) host->present(framebuffer.id(), size);
    host->pump(0.1);
    if (host->input().closes() || host->input().takeEscape()) break;
    while (host->input().waits()) host->input().take();
  }
  return 0;
}

int show(const LabOptions& options) {
  options.common.apply();
  const Lab& lab = findLab(options.lab);
  if (options.watch) return watch(options, lab);
  const Judged judged = judge(lab, options);
  if (!judged.report.compileError.empty()) {
    fmt::print("{}\n", judged.report.compileError);
    return kWrong;
  }
  if (judged.report.pictures.empty())
    fmt::print("No picture yet: a task that it needs is not done or not right (lucerna lab check {} {} says which).\n",
               lab.number, options.folder);
  writePictures(fs::path(options.folder) / "pictures", judged.report);
  return 0;
}

int report(const LabOptions& options) {
  options.common.apply();
  const Lab& lab = findLab(options.lab);
  Judged judged = judge(lab, options);
  note(judged, lab);
  const fs::path file = options.html.empty() ? fs::path(options.folder) / "report.html" : fs::path(options.html);
  writeFileAtomically(file, reportHtml(lab, judged.folder, judged.report));
  fmt::print("{}: {:.1f} of 100\n", file.string(), judged.report.compileError.empty() ? judged.report.score(lab) : 0.0);
  return 0;
}

int prove(const LabOptions& options) {
  options.common.apply();
  const auto host = options.common.makeHost(false);
  const gl::Context context;
  nlohmann::ordered_json json{{"renderer", context.capabilities().renderer}, {"labs", nlohmann::ordered_json::array()}};
  bool good = true;
  std::vector<Lab> wanted(allLabs().begin(), allLabs().end());
  if (!options.lab.empty()) wanted = {findLab(options.lab)};
  for (const Lab& lab : wanted) {
    const Proof proof = proveLab(lab, options.nonce != 0 ? options.nonce : 1, options.runs);
    if (!options.common.quiet) fmt::print("{}", proofText(lab, proof));
    json["labs"].push_back(proofJson(lab, proof));
    good = good && proof.good();
  }
  options.common.writeJson(json);
  return good ? 0 : kWrong;
}

int figures(const LabOptions& options) {
  options.common.apply();
  const Lab& lab = findLab(options.lab);
  const auto host = options.common.makeHost(false);
  const gl::Context context;
  // Of the example's seed alone: the figures of any other are a student's answers.
  fmt::print("{}", figuresTable(lab, "example"));
  if (!options.pictures.empty()) expectedPictures(lab, "example", options.pictures);
  return 0;
}

}  // namespace

void addLabs(Subcommands& commands) {
  auto options = std::make_shared<LabOptions>();
  const auto add = [&](const char* name, const char* description, int (*work)(const LabOptions&)) {
    Command command = commands.add(name, description, [options, work] { return work(*options); });
    options->common.declare(command);
    return command;
  };
  const auto addLabAndFolder = [&](Command command) {
    command.addOption("LAB", options->lab, "number of the lab").required();
    command.addOption("DIR", options->folder, "folder of the hand-in").showDefault();
  };
  const auto addSeed = [&](Command command, const char* what) { command.addOption("--seed", options->seed, what); };
  const auto addNonce = [&](Command command) {
    command.addOption("--nonce", options->nonce, "probe points and noise of an earlier run; 0: new ones").showDefault();
  };
  add("list", "The labs and their tasks", list);
  Command startApp = add("start", "Copy a lab's files into your own folder", start);
  startApp.addOption("LAB", options->lab, "number of the lab").required();
  startApp.addOption("DIR", options->folder, "folder to make").required();
  addSeed(startApp, "your ID, which determines your parameters (default: example)");
  Command checkApp = add("check", "Check and grade a hand-in", check);
  addLabAndFolder(checkApp);
  addSeed(checkApp, "for graders: instead of the hand-in's own");
  addNonce(checkApp);
  checkApp.addOption("--junit", options->junit, "FILE.xml: results as JUnit XML");
  checkApp.addOption("--gradescope", options->gradescope, "FILE.json: results for Gradescope's autograder");
  Command hintApp = add("hint", "Show the next of a task's three hints; recorded in the hand-in", hint);
  hintApp.addOption("LAB.TASK", options->lab, "such as 1.2").required();
  hintApp.addOption("DIR", options->folder, "folder of the hand-in").showDefault();
  addLabAndFolder(add("solution", "Put the sample solution into a hand-in; recorded in the hand-in", solution));
  Command showApp = add("show", "Write the lab's pictures: yours, the reference, the difference", show);
  addLabAndFolder(showApp);
  addNonce(showApp);
  showApp.addFlag("--watch", options->watch,
                  "again whenever tasks.glsl is saved, in a window where there is a display, until Escape or Ctrl-C");
  Command reportApp = add("report", "Write the hand-in as one self-contained HTML page", report);
  addLabAndFolder(reportApp);
  addNonce(reportApp);
  addSeed(reportApp, "for graders: instead of the hand-in's own");
  reportApp.addOption("-o,--output", options->html, "FILE.html (default: DIR/report.html)");
  Command proveApp = add("prove", "For authors: check a lab's stub, solution and every wrong answer", prove);
  proveApp.addOption("LAB", options->lab, "number of the lab (default: all)");
  proveApp.addOption("--runs", options->runs, "checks of the solution with other noise, to count false alarms")
      .range(0, 1000000)
      .showDefault();
  addNonce(proveApp);
  Command figuresApp =
      add("figures", "For authors: the numbers that a lab's README quotes, of the seed example", figures);
  figuresApp.addOption("LAB", options->lab, "number of the lab").required();
  figuresApp.addOption("--pictures", options->pictures, "DIR: also write the pictures shown in README.md");
}

}  // namespace lucerna::demo
