// The engine's tone mapping on the processor (no GL), for pictures of reports: the curve of shaders/forward/tonemap.frag, then sRGB.
#pragma once

#include "base/image.hpp"

namespace lucerna::measure {

/// exposure multiplies radiance first. What is not finite becomes pure green, so that it is seen.
Bitmap toneMapped(const Image& image, float exposure);

}  // namespace lucerna::measure
