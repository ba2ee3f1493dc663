// The labs, in order.
#include "labs/lab.hpp"

#include "base/error.hpp"

#include <fmt/format.h>

namespace lucerna::demo::labs {

extern const Lab kFurnaceLab, kShadowsLab, kHarmonicsLab, kPropagationLab, kCascadesLab, kHemicubesLab, kPathsLab,
    kMediaLab, kTemplateLab;

std::span<const Lab> allLabs() {
  static const std::vector<Lab> labs{kFurnaceLab,  kShadowsLab,   kHarmonicsLab, kPropagationLab,
                                     kCascadesLab, kHemicubesLab, kPathsLab,     kMediaLab};
  return labs;
}

const Lab& findLab(const std::string& number) {
  if (number == "0" || number == "template") return kTemplateLab;
  std::string known;
  for (const Lab& lab : allLabs()) {
    if (std::to_string(lab.number) == number || lab.folder == number) return lab;
    known += fmt::format("{}{}", known.empty() ? "" : ", ", lab.number);
  }
  throwBadInput("lab {}: there are {} (lucerna lab list)", number, known);
}

}  // namespace lucerna::demo::labs
