#include "labs/hand_in.hpp"

#include "base/error.hpp"
#include "base/files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <sstream>

namespace lucerna::demo::labs {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

std::string stubText(const Lab& lab) { return readFileText(labsFolder() / lab.folder / "tasks.glsl"); }
std::string solutionText(const Lab& lab) { return readFileText(labsFolder() / "solutions" / (lab.folder + ".glsl")); }

std::vector<std::string> hintsOf(const Lab& lab, int task) {
  std::vector<std::string> hints;
  std::istringstream stream(readFileText(labsFolder() / lab.folder / "hints.txt"));
  const std::string begin = fmt::format("{}.", task);
  for (std::string line; std::getline(stream, line);)
    if (line.starts_with(begin)) hints.push_back(line.substr(line.find(' ') + 1));
  if (hints.size() != 3)
    throwBadInput("{}: task {} has {} hints, expected three lines '{}.1 ...' to '{}.3 ...'", lab.folder + "/hints.txt",
                  task, hints.size(), task, task);
  return hints;
}

std::vector<Mutant> mutantsOf(const Lab& lab) {
  std::vector<Mutant> mutants;
  std::istringstream stream(readFileText(labsFolder() / lab.folder / "mutants.txt"));
  for (std::string line; std::getline(stream, line);) {
    if (line.empty() || line[0] == '#') continue;
    if (line.starts_with("- ") && !mutants.empty()) mutants.back().from = line.substr(2);
    else if (line.starts_with("+ ") && !mutants.empty()) mutants.back().to = line.substr(2);
    else {
      Mutant mutant;
      if (!mutants.empty()) mutant.from = mutants.back().from;
      std::istringstream(line) >> mutant.name >> mutant.task >> mutant.hint;
      mutants.push_back(mutant);
    }
  }
  return mutants;
}

std::string applied(const Mutant& mutant, const std::string& solution) {
  const auto at = solution.find(mutant.from);
  if (mutant.from.empty() || at == std::string::npos || solution.find(mutant.from, at + 1) != std::string::npos)
    throwBadInput("mutant {}: '{}' does not occur in the solution exactly once", mutant.name, mutant.from);
  std::string text = solution;
  return text.replace(at, mutant.from.size(), mutant.to);
}

void Folder::save() const { writeFileAtomically(path / "lab.json", state.dump(2) + "\n"); }

Folder Folder::open(const Lab& lab, const fs::path& path, const std::string& seed) {
  Folder folder{path, {}};
  const fs::path file = path / "lab.json";
  if (fs::exists(file)) {
    try {
      folder.state = Json::parse(readFileText(file));
      if (folder.state.at("lab") != lab.number)
        throwBadInput("{} belongs to lab {}, not to lab {}", path.string(), folder.state.at("lab").dump(), lab.number);
      if (!folder.state.at("seed").is_string() || !folder.state.at("hints").is_array() ||
          !folder.state.at("checks").is_array() || !folder.state.at("started").is_number())
        throwBadInput("{}: expected seed, started, hints and checks", file.string());
    } catch (const Json::exception& error) { throwBadInput("{}: {}", file.string(), error.what()); }
  } else if (seed.empty()) {
    throwBadInput(
        "{} is not a lab folder: lab.json is missing (lucerna lab start {} {} makes one; a grader names the seed: "
        "--seed ID)",
        path.string(), lab.number, path.string());
  } else {
    folder.state = {{"lab", lab.number},
                    {"seed", seed},
                    {"started", std::time(nullptr)},
                    {"hints", Json::array()},
                    {"checks", Json::array()}};
  }
  if (!seed.empty()) folder.state["seed"] = seed;
  return folder;
}

HandIn Folder::handIn() const {
  HandIn handIn;
  handIn.tasksFile = path / "tasks.glsl";
  handIn.tasks = readFileText(handIn.tasksFile);
  handIn.tasksName = handIn.tasksFile.string();
  if (fs::exists(path / "answers.txt")) handIn.answers = parseAnswers(readFileText(path / "answers.txt"));
  handIn.seed = state.at("seed").get<std::string>();
  return handIn;
}

void startLab(const Lab& lab, const fs::path& path, const std::string& seed) {
  for (const char* name : {"tasks.glsl", "answers.txt", "lab.json"})
    if (fs::exists(path / name))
      throwBadInput("{} already exists: choose another folder, nothing is overwritten", (path / name).string());
  std::error_code error;
  fs::create_directories(path, error);
  if (error) throwBadInput("{}: {}", path.string(), error.message());
  const fs::path source = labsFolder() / lab.folder;
  writeFileAtomically(path / "README.md", readFileText(source / "README.md"));
  writeFileAtomically(path / "tasks.glsl", stubText(lab));
  writeFileAtomically(path / "answers.txt", readFileText(source / "answers.txt"));
  for (const auto& entry : fs::directory_iterator(source))  // pictures shown in README.md
    if (entry.path().extension() == ".png")
      fs::copy_file(entry.path(), path / entry.path().filename(), fs::copy_options::overwrite_existing);
  Folder{path,
         {{"lab", lab.number},
          {"seed", seed},
          {"started", std::time(nullptr)},
          {"hints", Json::array()},
          {"checks", Json::array()}}}
      .save();
}

void putSolution(const Lab& lab, const fs::path& path) {
  Folder folder = Folder::open(lab, path, "");
  const fs::path tasks = path / "tasks.glsl";
  fs::path kept = path / "tasks.mine.glsl";
  for (int k = 2; fs::exists(kept); ++k) kept = path / fmt::format("tasks.mine{}.glsl", k);
  if (fs::exists(tasks)) fs::rename(tasks, kept);
  writeFileAtomically(tasks, solutionText(lab));
  folder.state["solution_taken"] = std::time(nullptr);
  folder.save();
}

std::string takeHint(const Lab& lab, int task, const fs::path& path) {
  if (std::none_of(lab.tasks.begin(), lab.tasks.end(), [&](const Task& t) { return t.number == task; }))
    throwBadInput("lab {} has no task {}; there are 1 to {}", lab.number, task, lab.tasks.size());
  const std::vector<std::string> hints = hintsOf(lab, task);
  Folder folder = Folder::open(lab, path, "");
  int level = 1;
  for (const Json& hint : folder.state["hints"])
    if (hint.value("task", 0) == task) level = std::min(3, hint.value("level", 0) + 1);
  folder.state["hints"].push_back({{"task", task}, {"level", level}, {"time", std::time(nullptr)}});
  folder.save();
  return fmt::format("Lab {}, task {}, hint {} of 3: {}\n", lab.number, task, level,
                     hints[static_cast<std::size_t>(level) - 1]);
}

}  // namespace lucerna::demo::labs
