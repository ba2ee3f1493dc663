// Proofs that a lab works: its stub is rejected politely, its solution passes, every typical mistake is rejected with
// the right hint, and a correct answer is not rejected by chance.
#pragma once

#include "labs/hand_in.hpp"

namespace lucerna::demo::labs {

struct Proof {
  struct Row {
    std::string name, wantedHint, hint;  ///< the hint of the first wrong check
    bool rejected = false;
  };
  bool stubPolite = false;  ///< it compiles, every task reports "not done" or waits for one, no points
  bool solutionPasses = false;
  std::string solutionTrouble;  ///< what the report says if the solution does not pass
  std::vector<Row> mutants;
  double solutionSeconds = 0.0;
  int runs = 0, refusals = 0, tests = 0,
      below1Percent =
          0;  ///< in further runs with different seeds: number of statistical tests, and of those with p < 0.01
  double leastP = 1.0;
  std::vector<std::string> refused;  ///< check and run, so that it can be repeated

  int rightHints() const;
  /// Everything but `runs`: at least ten mutants, all rejected, nine in ten with the right hint.
  bool good() const;
};

Proof proveLab(const Lab& lab, std::uint64_t nonce, int runs);
std::string proofText(const Lab& lab, const Proof& proof);
nlohmann::ordered_json proofJson(const Lab& lab, const Proof& proof);

/// Lines "| name | value |" for README.md.
std::string figuresTable(const Lab& lab, const std::string& seed);
/// Writes NAME.png for README.md into a folder: the references of the lab's pictures, enlarged four times.
void expectedPictures(const Lab& lab, const std::string& seed, const std::filesystem::path& folder);

}  // namespace lucerna::demo::labs
