// Answers what lit a pixel, as JSON: for `lucerna render --ask` and the window's panel.
#pragma once

#include "frame/pixel_answer.hpp"

#include <nlohmann/json.hpp>

#include <string>

namespace lucerna::demo {

/// Shares per group; the others are combined.
constexpr std::size_t kAskedShares = 32;

nlohmann::ordered_json toJson(const PixelAnswer& answer);
/// "X,Y" within a picture, counted from its top left; throws Error(badInput) naming --ask.
glm::ivec2 parsePixel(const std::string& text, glm::ivec2 size);

}  // namespace lucerna::demo
