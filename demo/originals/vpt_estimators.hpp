// The estimators that the tables of the VPT original compare: corrected, as published, and a deviation apart (no GL).
#pragma once

#include "pathtracer/path_deviations.hpp"
#include "render/deviations.hpp"

#include <string>
#include <vector>

namespace lucerna::demo::bench {

struct VptEstimator {
  std::string name;
  PathDeviations deviations;
};

/// The estimator and the other one of corrected and published. For the corrected one then each deviation alone turned
/// on; for the published one each alone turned off, because the pictures were made with all others on.
std::vector<VptEstimator> vptEstimators(Fidelity fidelity);

}  // namespace lucerna::demo::bench
