// Heat maps of errors (no GL): the difference of two linear pictures at each pixel, absolute or signed.
//
// Absolute: the pixel's largest |d| over its channels, black (0) through red and orange to white (scale and beyond).
// Signed: d of the luminance [IEC 61966-2-1], blue (-scale) through white (0) to red (+scale). Both linear in d; values
// that are not finite are green.
#pragma once

#include "base/image.hpp"

namespace lucerna::measure {

enum class HeatMap { absolute, signedLuminance };

/// A scale that shows most of the error: the 99th percentile of |d|, rounded up to 1, 2 or 5 times a power of ten. 0 if
/// the pictures are equal.
double heatMapScale(const Image& image, const Image& reference);
/// scale: the |d| at the end of the colours, radiance, above 0.
Bitmap heatMap(const Image& image, const Image& reference, HeatMap kind, double scale);
/// The colours from the least value (left) to the largest, for a legend.
Bitmap heatMapLegend(HeatMap kind, int width, int height);

}  // namespace lucerna::measure
