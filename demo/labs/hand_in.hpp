// A student's folder: tasks.glsl, answers.txt and lab.json, which keeps the seed, the hints taken and what each check
// found.
#pragma once

#include "labs/lab.hpp"

#include <nlohmann/json.hpp>

namespace lucerna::demo::labs {

struct Folder {
  std::filesystem::path path;
  nlohmann::ordered_json state;  ///< lab.json: lab, seed, started, hints, checks

  /// Throws Error(badInput) where it is no folder of that lab. `seed` not empty: instead of the folder's (a grader's).
  static Folder open(const Lab& lab, const std::filesystem::path& path, const std::string& seed);
  void save() const;
  HandIn handIn() const;
};

/// Copies README.md with its pictures, tasks.glsl and an empty answers.txt. Throws Error(badInput) where the folder
/// holds any of them already.
void startLab(const Lab& lab, const std::filesystem::path& path, const std::string& seed);
/// Puts the sample solution in the place of tasks.glsl, which stays as tasks.mine.glsl; lab.json notes it.
void putSolution(const Lab& lab, const std::filesystem::path& path);
/// The next hint of a task, 1 to 3, noted in lab.json; the third again when all were given.
std::string takeHint(const Lab& lab, int task, const std::filesystem::path& path);

/// Texts of a lab's folder.
std::string stubText(const Lab& lab);
std::string solutionText(const Lab& lab);
std::vector<std::string> hintsOf(const Lab& lab, int task);  ///< three

struct Mutant {
  std::string name, hint, from, to;
  int task = 0;
};
/// mutants.txt: blocks of "name task hint", "- text of the solution", "+ what stands there instead". Without its "-"
/// line a mutant replaces the text that the one before it does.
std::vector<Mutant> mutantsOf(const Lab& lab);
/// The solution with the mutant's text in place. Throws Error(badInput) where `from` does not stand there exactly once.
std::string applied(const Mutant& mutant, const std::string& solution);

/// Every task and check as text for a terminal.
std::string reportText(const Lab& lab, const Report& report);
nlohmann::ordered_json reportJson(const Lab& lab, const Report& report);
std::string reportJunit(const Lab& lab, const Report& report);
std::string reportGradescope(const Lab& lab, const Report& report);
/// One self-contained HTML page: answers, checks, pictures with sliders, plots, time per task.
std::string reportHtml(const Lab& lab, const Folder& folder, const Report& report);

}  // namespace lucerna::demo::labs
