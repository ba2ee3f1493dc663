// Deviations: what the published originals do differently, each a named switch (no GL, pure).
//
// `--fidelity thesis` turns on those of the published text, `demo` those of the program published with it if it differs
// (the light propagation volume's); `original` is the thesis. `--deviation NAME=on|off` sets one. Each has a line in
// its technique's README.md with formula, source and effect (a test checks that the line is there).
#pragma once

#include "frame/deviation.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace lucerna {

/// Of all techniques.
std::vector<Deviation> allDeviations();

/// Sets every switch to that fidelity, together with the settings it requires (one layered pass per step and cascade,
/// ...).
void applyFidelity(RenderSettings& settings, Fidelity fidelity);

/// "NAME=on" or "NAME=off"; throws Error(badInput) listing the names.
void applyDeviation(RenderSettings& settings, std::string_view assignment);

/// Names of the deviations that are on.
std::vector<std::string> activeDeviations(const RenderSettings& settings);

}  // namespace lucerna
