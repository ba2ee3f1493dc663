// A clear sky as an environment picture, from the sun's position (no GL, pure).
//
// Luminance and chromaticity over the sky: [Preetham1999], fitted to computed skies; +y is up. Turbidity: the optical
// thickness of air with haze over that of air alone; 2 is very clear, 3 clear, 6 warm and moist, 10 hazy. Amount of
// light, sun and sky in proportion, with m the air mass [Preetham1999, A.1] and a = 0.1 / (1 + 0.0045 m) the extinction
// of clean air:
//   sun, across its rays:  E_n = 127.5 klx exp(-a m T)                                        [Navvab1984]
//   sky, on the ground:    E_h = 127.5 klx / m 0.79 (0.5 (1 - e^-am) + 0.84 (1 - e^-am(T-1)))
//                                / (1 - m + m^1.02)                                           [Bird1981]
// The second is what air and haze remove from sunlight and scatter downwards, half and 84 % of it, written for light
// (as if nothing were absorbed) and with 1/m for the cosine of the sun's zenith angle, equal except for the Earth's
// curvature. The zenith luminance of [Preetham1999] is not used: with it and the sun in the zenith, T = 3, sun and sky
// would give 135 klx, more than arrives. The sun's disc is not in the picture: the sun stays a DirectionalLight. With
// the sun within a few degrees of the horizon its light vanishes before the sky's, so that for a given sun irradiance
// the sky grows without bound, though finite.
#pragma once

#include "base/image.hpp"
#include "scene/scene.hpp"

#include <glm/glm.hpp>

namespace lucerna {

struct ClearSky {
  static constexpr double kLeastTurbidity = 1.7, kMostTurbidity = 10.0;  ///< of the fit
  double turbidity = 3.0;
  double ground = 0.2;  ///< albedo of the ground below the horizon, lit by sun and sky; 0..1
};

/// Luminance over that of the zenith, and chromaticity, CIE 1931.
struct SkyColour {
  double luminance, x, y;
};

/// `direction`, `toSun`: unit, at or above the horizon.
SkyColour skyColour(double turbidity, const glm::dvec3& toSun, const glm::dvec3& direction);

/// Linear sRGB (white D65) whose 0.2126 r + 0.7152 g + 0.0722 b is the luminance; colours outside sRGB are mixed with
/// white of that luminance until inside.
glm::dvec3 linearSrgb(const SkyColour& colour);

/// Illuminance by the sun across its rays and by the sky on the ground, klx. zenithAngle: the sun's, 0..pi/2.
double sunIlluminance(double turbidity, double zenithAngle);
double skyIlluminance(double turbidity, double zenithAngle);

/// Latitude-longitude picture, 2 height by height (even), of the sky in the units of the sun's irradiance: irradiances
/// have the ratio of the illuminances. Throws Error(badInput) if the sun is below the horizon, or turbidity or albedo
/// out of range.
Image clearSkyPicture(const ClearSky& sky, const DirectionalLight& sun, int height = 256);

/// The unit vector to the sun: +x is east, -z north. Latitude in degrees, north positive; day of the year from 1; hour
/// of solar time, 0 to 24 (12: the sun is highest). Declination and hour angle as in [Preetham1999, A.6].
glm::dvec3 directionToSun(double latitude, double day, double hour);

/// What the air lets through of the sun's rays, across them: scattered by air, absorbed and scattered by haze
/// [Preetham1999, A.1], at three wavelengths. 0 below the horizon. `outside`: above the air.
glm::vec3 sunThroughAir(double turbidity, const glm::dvec3& toSun, const glm::vec3& outside);

/// The sky for such a sun, also below the horizon: twilight is the sky at sunset, darker by a factor of e every 1.3
/// degrees (illuminances of 400 lx at sunset and 3.4 lx at -6 degrees [Seidelmann1992]).
Image skyOfDay(const ClearSky& sky, const glm::dvec3& toSun, const glm::vec3& outside, int height = 128);

}  // namespace lucerna
