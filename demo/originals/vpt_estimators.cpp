#include "originals/vpt_estimators.hpp"

#include <fmt/core.h>

#include <string_view>
#include <utility>

namespace lucerna::demo::bench {

std::vector<VptEstimator> vptEstimators(Fidelity fidelity) {
  const bool published = fidelity != Fidelity::corrected;
  RenderSettings corrected, original;
  applyFidelity(original, Fidelity::original);
  std::vector<VptEstimator> estimators{{"corrected", corrected.of<PathSettings>().deviations},
                                       {"original", original.of<PathSettings>().deviations}};
  if (published) std::swap(estimators[0], estimators[1]);
  for (const Deviation& deviation : allDeviations()) {
    if (!std::string_view(deviation.name).starts_with("path.")) continue;
    RenderSettings alone = published ? original : corrected;
    const bool turned = !deviation.isOn(alone);
    deviation.turn(alone, turned);
    estimators.push_back({fmt::format("{}{}", deviation.name, published ? (turned ? " too" : " off") : ""),
                          alone.of<PathSettings>().deviations});
  }
  return estimators;
}

}  // namespace lucerna::demo::bench
