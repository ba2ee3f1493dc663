// Answers what lit a pixel, as JSON: for `lucerna render --inspect` and the window's panel.
#pragma once

#include "frame/pixel_inspection.hpp"

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace lucerna::demo {

/// Shares per group; the others are combined.
constexpr std::size_t kInspectedShares = 32;

nlohmann::ordered_json toJson(const PixelInspection& answer);
/// "X,Y" within a picture, counted from its top left; throws Error(badInput) naming --inspect.
glm::ivec2 parsePixel(const std::string& text, glm::ivec2 size);

}  // namespace lucerna::demo
