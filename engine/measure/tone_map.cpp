#include "measure/tone_map.hpp"

#include <algorithm>
#include <cmath>

namespace lucerna::measure {

Bitmap toneMapped(const Image& image, float exposure) {
  Bitmap bitmap;
  bitmap.width = image.width;
  bitmap.height = image.height;
  bitmap.rgba.reserve(4 * image.pixels.size());
  for (const glm::vec3& radiance : image.pixels) {
    const bool finite = std::isfinite(radiance.x) && std::isfinite(radiance.y) && std::isfinite(radiance.z);
    for (int c = 0; c < 3; ++c) {
      const float x = 0.6f * std::max(exposure * radiance[c], 0.0f);
      const float mapped = std::isfinite(x * x) ? std::clamp(x * (2.51f * x + 0.03f) / (x * (2.43f * x + 0.59f) + 0.14f), 0.0f, 1.0f) : 1.0f;
      bitmap.rgba.push_back(finite ? static_cast<std::uint8_t>(std::lround(255.0f * srgbFromLinear(mapped))) : static_cast<std::uint8_t>(c == 1 ? 255 : 0));
    }
    bitmap.rgba.push_back(255);
  }
  return bitmap;
}

}  // namespace lucerna::measure
