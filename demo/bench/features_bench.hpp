// `lucerna bench features` as functions, for `bench all` and tests.
#pragma once

#include "base/named_values.hpp"
#include "shared/commands.hpp"

#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

namespace lucerna::demo::bench {

/// Whether leaving out saves: the ratio left out / forced on of several pictures in turn, and what two runs of the same
/// configuration differ by.
struct Saving {
  double ratio = 1.0;
  double low = NAN, high = NAN;  ///< of the ratio's median, 95 %; NaN with too few pictures
  double sameRuns = NAN;  ///< largest factor by which runs of one configuration differ, less 1, with 95 %
  enum class Verdict { tooFew, none, saves, costs } verdict = Verdict::tooFew;
};
constexpr std::array<std::string_view, 4> namesOf(Saving::Verdict) {
  return {"too few pictures to tell", "no difference", "saves", "costs"};
}
/// Costs of the same pictures, in turn, by two runs of each configuration. A difference is one where the ratio's
/// interval leaves 1 out and its median exceeds that of the runs of one configuration.
Saving savingOf(const std::array<std::vector<double>, 2>& without, const std::array<std::vector<double>, 2>& with);

struct FeaturesResult {
  struct Cost {
    std::size_t gpuBytes = 0, programs = 0;
    double compileMs = 0.0, ms = 0.0;
    double variance = 0.0;  ///< path: of a pixel, by one picture's samples; else 0
  };
  std::string scene, technique;
  std::vector<std::string> leftOut;  ///< here, but not with everything forced on
  Cost with, without;
  Saving compile, picture;  ///< picture: of path, time to the same error
  int samples = 0;  ///< path: of the pictures timed; else 0
  double maxDifference = 0.0, maxRadiance = 0.0;
};

/// The scene with neutral data for every unneeded feature that has such data with these settings.
Scene withEverything(const Scene& scene, const RenderSettings& settings);
FeaturesResult measureFeatures(const gl::Context& context, const Scene& scene, const Camera& camera,
                               RenderSettings settings, int frames);
nlohmann::ordered_json featuresJson(const FeaturesResult& result);
std::string featuresText(const FeaturesResult& result);

}  // namespace lucerna::demo::bench
