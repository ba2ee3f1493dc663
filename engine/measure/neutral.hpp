// Adds data to a scene that require a feature but change nothing (no GL), to measure and test what omitting the feature
// saves.
#pragma once

#include "scene/scene.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace lucerna::measure {

/// The needs of SceneFeatures for which neutral data exist.
const std::vector<std::string>& neutralFeatures();
/// Adds the data that cause the need: a white texture, a mask that cuts nothing out, a light of 1e-30. No effect if the
/// need already exists or nothing is drawn.
void addNeutral(Scene& scene, std::string_view need);

}  // namespace lucerna::measure
