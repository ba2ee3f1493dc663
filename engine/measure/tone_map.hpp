// The engine's tone mapping on the CPU (no GL), for pictures in reports: the curve of shaders/forward/tonemap.frag, then sRGB.
#pragma once

#include "base/image.hpp"

namespace lucerna::measure {

/// exposure multiplies radiance first. Values that are not finite become pure green.
Bitmap toneMapped(const Image& image, float exposure);

}  // namespace lucerna::measure
