// Textures as pictures on the CPU, top row first. Waits for the GPU.
#pragma once

#include "base/image.hpp"
#include "gl/objects.hpp"

namespace lucerna::gl {

/// The red, green and blue channels of a 2D texture, as stored.
Image readImage(const Texture& texture);

/// The lowest rows and columns of a 2D texture of values from 0 to 1, 8 bits a channel. `size`: at most the texture's.
Bitmap readBitmap(const Texture& texture, glm::ivec2 size);

}  // namespace lucerna::gl
