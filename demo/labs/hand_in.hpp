// A student's folder: tasks.glsl, answers.txt and lab.json, which stores the seed, the hints taken and the result of
// each check.
#pragma once

#include "labs/lab.hpp"

#include <nlohmann/json.hpp>

namespace lucerna::demo::labs {

struct Folder {
  std::filesystem::path path;
  nlohmann::ordered_json state;  ///< lab.json: lab, seed, started, hints, checks

  /// Throws Error(badInput) if it is not a folder of that lab. `seed` not empty: overrides the folder's (for graders).
  static Folder open(const Lab& lab, const std::filesystem::path& path, const std::string& seed);
  void save() const;
  HandIn handIn() const;
};

/// Copies README.md with its pictures, tasks.glsl and an empty answers.txt. Throws Error(badInput) if the folder
/// already holds any of them.
void startLab(const Lab& lab, const std::filesystem::path& path, const std::string& seed);
/// Replaces tasks.glsl by the sample solution and keeps the old file as tasks.mine.glsl; recorded in lab.json.
void putSolution(const Lab& lab, const std::filesystem::path& path);
/// The next hint of a task, 1 to 3, recorded in lab.json; the third again once all were given.
std::string takeHint(const Lab& lab, int task, const std::filesystem::path& path);

/// Texts in a lab's folder.
std::string stubText(const Lab& lab);
std::string solutionText(const Lab& lab);
std::vector<std::string> hintsOf(const Lab& lab, int task);  ///< three

struct Mutant {
  std::string name, hint, from, to;
  int task = 0;
};
/// Parses mutants.txt: blocks of "name task hint", "- text of the solution", "+ replacement". Without a "-" line a
/// mutant replaces the same text as the previous one.
std::vector<Mutant> mutantsOf(const Lab& lab);
/// The solution with the mutant's replacement. Throws Error(badInput) if `from` does not occur exactly once.
std::string applied(const Mutant& mutant, const std::string& solution);

/// Every task and check as text for a terminal.
std::string reportText(const Lab& lab, const Report& report);
nlohmann::ordered_json reportJson(const Lab& lab, const Report& report);
std::string reportJunit(const Lab& lab, const Report& report);
std::string reportGradescope(const Lab& lab, const Report& report);
/// One self-contained HTML page: answers, checks, pictures with sliders, plots, time per task.
std::string reportHtml(const Lab& lab, const Folder& folder, const Report& report);

}  // namespace lucerna::demo::labs
