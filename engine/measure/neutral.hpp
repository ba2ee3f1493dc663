// A scene with data that ask for a feature and change nothing (no GL): what leaving the feature out is measured and tested against.
#pragma once

#include "scene/scene.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace lucerna::measure {

/// Needs of SceneNeeds, by its names, that neutral data exist for.
const std::vector<std::string>& neutralNeeds();
/// Makes the scene need it: a white texture, a mask that cuts nothing out, a light of 1e-30. No effect where it is needed already or nothing is drawn.
void addNeutral(Scene& scene, std::string_view need);

}  // namespace lucerna::measure
