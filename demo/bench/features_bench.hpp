// `lucerna bench features` as functions, for `bench all` and tests.
#pragma once

#include "shared/commands.hpp"

#include <string>
#include <vector>

namespace lucerna::demo::bench {

struct FeaturesResult {
  struct Cost {
    std::size_t gpuBytes = 0, programs = 0;
    double compileMs = 0.0, ms = 0.0;
  };
  std::string scene, technique;
  std::vector<std::string> leftOut;  ///< here, but not with everything forced on
  Cost with, without;
  double maxDifference = 0.0, maxRadiance = 0.0;
};

/// The scene with neutral data for every unneeded feature that has such data with these settings.
Scene withEverything(const Scene& scene, const RenderSettings& settings);
FeaturesResult measureFeatures(const gl::Context& context, const Scene& scene, const Camera& camera,
                               RenderSettings settings, int frames);
nlohmann::ordered_json featuresJson(const FeaturesResult& result);
std::string featuresText(const FeaturesResult& result);

}  // namespace lucerna::demo::bench
