// What an author proves of a lab: its stub is refused politely, its solution passes, every typical wrong answer is
// refused with the right hint, and a correct answer is not refused by chance.
#pragma once

#include "labs/hand_in.hpp"

namespace lucerna::demo::labs {

struct Proof {
  struct Row {
    std::string name, wantedHint, hint;  ///< the hint of the first wrong check
    bool rejected = false;
  };
  bool stubPolite = false;  ///< it compiles, every task says "not done" or waits for one, no points
  bool solutionPasses = false;
  std::string solutionTrouble;  ///< what the report says where it does not
  std::vector<Row> mutants;
  double solutionSeconds = 0.0;
  int runs = 0, refusals = 0, tests = 0,
      below1Percent =
          0;  ///< of further runs, each with a seed of its own: statistical tests, and how many had p < 0.01
  double leastP = 1.0;
  std::vector<std::string> refused;  ///< which check of which run, so that it can be repeated

  int rightHints() const;
  /// All but `runs`: at least ten mutants, all refused, nine in ten with the right hint.
  bool good() const;
};

Proof proveLab(const Lab& lab, std::uint64_t nonce, int runs);
std::string proofText(const Lab& lab, const Proof& proof);
nlohmann::ordered_json proofJson(const Lab& lab, const Proof& proof);

/// Lines "| name | value |" for README.md.
std::string figuresTable(const Lab& lab, const std::string& seed);
/// Writes NAME.png for README.md into a folder: the references of the lab's pictures, four pixels a pixel.
void expectedPictures(const Lab& lab, const std::string& seed, const std::filesystem::path& folder);

}  // namespace lucerna::demo::labs
