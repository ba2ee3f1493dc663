// The thirteen estimators that bench tables --original vpt compares: their names, and that each is another one.
#include "originals/vpt_estimators.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

namespace lucerna {
namespace {

std::vector<std::string> activeIn(const PathDeviations& deviations) {
  RenderSettings settings;
  settings.of<PathSettings>().deviations = deviations;
  return activeDeviations(settings);
}

TEST(VptEstimators, EachDeviationAloneIsOnOrOff) {
  RenderSettings original;
  applyFidelity(original, Fidelity::original);
  const std::vector<std::string> published = activeIn(original.of<PathSettings>().deviations);
  const auto corrected = demo::bench::vptEstimators(Fidelity::corrected),
             asPublished = demo::bench::vptEstimators(Fidelity::original);
  ASSERT_EQ(corrected.size(), 13u);
  ASSERT_EQ(asPublished.size(), 13u);
  EXPECT_EQ(corrected[0].name, "corrected");
  EXPECT_EQ(asPublished[1].name, "corrected");
  EXPECT_EQ(corrected[1].name, "original");
  EXPECT_EQ(asPublished[0].name, "original");
  EXPECT_EQ(asPublished[2].name, "path.distance-without-pdf off");
  EXPECT_EQ(activeIn(corrected[0].deviations), std::vector<std::string>{});
  EXPECT_EQ(activeIn(asPublished[1].deviations), std::vector<std::string>{});
  EXPECT_EQ(activeIn(corrected[1].deviations), published);
  EXPECT_EQ(activeIn(asPublished[0].deviations), published);
  for (std::size_t i = 2; i < corrected.size(); ++i) {
    const std::string& name = corrected[i].name;
    EXPECT_EQ(activeIn(corrected[i].deviations), std::vector<std::string>{name});
    const bool inOriginal = std::find(published.begin(), published.end(), name) != published.end();
    EXPECT_EQ(asPublished[i].name, name + (inOriginal ? " off" : " too"));
    std::vector<std::string> active = activeIn(asPublished[i].deviations);
    EXPECT_EQ(std::find(active.begin(), active.end(), name) == active.end(), inOriginal) << name;
    EXPECT_EQ(active.size() + (inOriginal ? 1 : 0), published.size() + (inOriginal ? 0 : 1)) << name;
  }
}

}  // namespace
}  // namespace lucerna
