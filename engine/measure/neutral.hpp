// A scene with data that require a feature and change nothing (no GL), to measure and test what leaving it out saves.
#pragma once

#include "scene/scene.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace lucerna::measure {

/// Names of those needs of SceneNeeds that neutral data exist for.
const std::vector<std::string>& neutralNeeds();
/// Makes the scene need it: a white texture, a mask that cuts nothing out, a light of 1e-30. No effect if it is needed
/// already or nothing is drawn.
void addNeutral(Scene& scene, std::string_view need);

}  // namespace lucerna::measure
