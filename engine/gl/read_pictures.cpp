#include "gl/read_pictures.hpp"

#include <cmath>
#include <cstdint>

namespace lucerna::gl {

Image readImage(const Texture& texture) {
  const std::vector<glm::vec4> texels = texture.readRgba();
  Image image(texture.size().x, texture.size().y);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      image.at(x, y) =
          glm::vec3(texels[static_cast<std::size_t>(image.height - 1 - y) * static_cast<std::size_t>(image.width) +
                           static_cast<std::size_t>(x)]);
  return image;
}

Bitmap readBitmap(const Texture& texture, glm::ivec2 size) {
  const std::vector<glm::vec4> texels = texture.readRgba();
  Bitmap bitmap;
  bitmap.width = size.x;
  bitmap.height = size.y;
  bitmap.rgba.reserve(4 * static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y));
  for (int y = size.y - 1; y >= 0; --y)
    for (int x = 0; x < size.x; ++x) {
      const glm::vec4& texel = texels[static_cast<std::size_t>(y) * static_cast<std::size_t>(texture.size().x) +
                                      static_cast<std::size_t>(x)];
      for (int channel = 0; channel < 4; ++channel)
        bitmap.rgba.push_back(static_cast<std::uint8_t>(std::lround(255.0f * texel[channel])));
    }
  return bitmap;
}

}  // namespace lucerna::gl
