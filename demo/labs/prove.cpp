#include "labs/prove.hpp"

#include "base/error.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace lucerna::demo::labs {

namespace {

/// The correct answers for a seed.
std::map<std::string, std::string> rightAnswers(const Lab& lab, const std::string& seed) {
  HandIn handIn;
  handIn.tasks = stubText(lab);  // no task is judged
  handIn.seed = seed;
  std::map<std::string, std::string> answers;
  for (const auto& [name, value] : runChecks(lab, handIn, 1).expectedAnswers)
    answers[name] = fmt::format("{:.9g}", value);
  return answers;
}

Proof::Row judged(const Lab& lab, const HandIn& handIn, std::uint64_t nonce, const std::string& name,
                  const std::string& wantedHint) {
  const Report report = runChecks(lab, handIn, nonce);
  Proof::Row row{name, wantedHint, "", !report.allPassed() && report.score(lab) < 99.99};
  if (!report.compileError.empty()) {
    row.hint = "does not compile: " + report.compileError;
    row.rejected = false;  // a mutant that does not compile proves nothing
  }
  for (const CheckResult& check : report.checks)
    if (row.hint.empty() && check.verdict == Verdict::wrong) row.hint = check.mistake.id;
  return row;
}

}  // namespace

int Proof::rightHints() const {
  return static_cast<int>(
      std::count_if(mutants.begin(), mutants.end(), [](const Row& r) { return r.rejected && r.hint == r.wantedHint; }));
}

bool Proof::good() const {
  return stubPolite && solutionPasses && mutants.size() >= 10 &&
         std::all_of(mutants.begin(), mutants.end(), [](const Row& r) { return r.rejected; }) &&
         10 * rightHints() >= 9 * static_cast<int>(mutants.size());
}

Proof proveLab(const Lab& lab, std::uint64_t nonce, int runs) {
  Proof proof;
  HandIn handIn;
  handIn.tasks = stubText(lab);
  const Report stub = runChecks(lab, handIn, nonce);
  proof.stubPolite = stub.compileError.empty() && stub.score(lab) == 0.0 &&
                     std::all_of(lab.tasks.begin(), lab.tasks.end(), [&](const Task& t) {
                       return stub.verdictOf(t.number) == Verdict::notDone ||
                              (!t.needs.empty() && stub.verdictOf(t.number) == Verdict::waiting);
                     });

  handIn.answers = rightAnswers(lab, handIn.seed);
  handIn.tasks = solutionText(lab);
  const Report solution = runChecks(lab, handIn, nonce);
  proof.solutionPasses = solution.allPassed() && solution.score(lab) > 99.99 && solution.score(lab) < 100.01;
  if (!proof.solutionPasses) proof.solutionTrouble = reportText(lab, solution);
  proof.solutionSeconds = solution.seconds;

  for (const Mutant& mutant : mutantsOf(lab)) {
    HandIn wrong = handIn;
    wrong.tasks = applied(mutant, handIn.tasks);
    proof.mutants.push_back(judged(lab, wrong, nonce, mutant.name, mutant.hint));
  }
  // Checks shared by every lab: numbers copied from another student, and an answer that is not a number.
  HandIn copied = handIn;
  copied.answers = rightAnswers(lab, "another student");
  if (!copied.answers.empty()) proof.mutants.push_back(judged(lab, copied, nonce, "copied-figures", "other"));
  HandIn words = handIn;
  for (auto& [name, value] : words.answers) value = "nan";
  if (!words.answers.empty()) proof.mutants.push_back(judged(lab, words, nonce, "figures-nan", "nan"));

  // Each run uses another student's seed and other noise.
  Probes probes(lab, handIn);
  for (int run = 0; run < runs; ++run) {
    const std::uint64_t again = Random(nonce + static_cast<std::uint64_t>(run) + 1000).word();
    HandIn student = handIn;
    student.seed = fmt::format("student {:x}", again);
    student.answers = rightAnswers(lab, student.seed);
    const Report report = runChecks(lab, student, again, probes);
    ++proof.runs;
    proof.refusals += report.allPassed() ? 0 : 1;
    for (const CheckResult& check : report.checks) {
      if (check.pValue >= 0.0)
        ++proof.tests, proof.below1Percent += check.pValue < 0.01 ? 1 : 0,
            proof.leastP = std::min(proof.leastP, check.pValue);
      if (check.verdict == Verdict::wrong)
        proof.refused.push_back(fmt::format("--seed '{}' --nonce {}: {}: expected {}, measured {}, {}", student.seed,
                                            again, check.name, check.expected, check.measured, check.sigma));
    }
  }
  return proof;
}

std::string proofText(const Lab& lab, const Proof& proof) {
  std::string text = fmt::format(
      "Lab {}: stub {}, solution {} in {:.1f} s, {} of {} wrong answers refused, {} with the right hint\n", lab.number,
      proof.stubPolite ? "polite" : "NOT POLITE", proof.solutionPasses ? "passes" : "FAILS", proof.solutionSeconds,
      std::count_if(proof.mutants.begin(), proof.mutants.end(), [](const auto& r) { return r.rejected; }),
      proof.mutants.size(), proof.rightHints());
  if (!proof.solutionPasses) text += proof.solutionTrouble;
  for (const Proof::Row& row : proof.mutants)
    text += fmt::format("  {:<28} {:<9} hint {}{}\n", row.name, row.rejected ? "refused" : "NOT REFUSED", row.hint,
                        row.hint == row.wantedHint ? "" : fmt::format(" (wanted {})", row.wantedHint));
  if (proof.runs > 0)
    text += fmt::format(
        "  {} further runs of the solution: {} refused; {} statistical tests, {:.2f} % with p < 1 %, least p {:.2g}\n",
        proof.runs, proof.refusals, proof.tests, 100.0 * proof.below1Percent / std::max(1, proof.tests), proof.leastP);
  for (const std::string& refused : proof.refused) text += "    refused: " + refused + "\n";
  return text;
}

nlohmann::ordered_json proofJson(const Lab& lab, const Proof& proof) {
  nlohmann::ordered_json json{{"lab", lab.number},
                              {"good", proof.good()},
                              {"stub_polite", proof.stubPolite},
                              {"solution_passes", proof.solutionPasses},
                              {"seconds", proof.solutionSeconds},
                              {"right_hints", proof.rightHints()},
                              {"mutants", nlohmann::ordered_json::array()}};
  for (const Proof::Row& row : proof.mutants)
    json["mutants"].push_back(
        {{"name", row.name}, {"rejected", row.rejected}, {"hint", row.hint}, {"wanted", row.wantedHint}});
  if (proof.runs > 0)
    json["runs"] = proof.runs, json["refusals"] = proof.refusals, json["tests"] = proof.tests,
    json["below_1_percent"] = proof.below1Percent, json["least_p"] = proof.leastP, json["refused"] = proof.refused;
  return json;
}

std::string figuresTable(const Lab& lab, const std::string& seed) {
  HandIn handIn;
  handIn.tasks = solutionText(lab);
  handIn.seed = seed;
  std::string text;
  for (const auto& [name, value] : runChecks(lab, handIn, 1).figures) text += fmt::format("| {} | {} |\n", name, value);
  return text;
}

void expectedPictures(const Lab& lab, const std::string& seed, const std::filesystem::path& folder) {
  constexpr int kScale = 4;
  HandIn handIn;
  handIn.tasks = solutionText(lab);
  handIn.seed = seed;
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throwBadInput("{}: {}", folder.string(), error.message());
  for (const PictureResult& picture : runChecks(lab, handIn, 1).pictures) {
    Image large(kScale * picture.reference.width, kScale * picture.reference.height);
    for (int y = 0; y < large.height; ++y)
      for (int x = 0; x < large.width; ++x) large.at(x, y) = picture.reference.at(x / kScale, y / kScale);
    writePng(folder / (picture.name + ".png"), toneMapped(large, picture.exposure));
  }
}

}  // namespace lucerna::demo::labs
