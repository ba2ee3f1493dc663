#include "scene/clear_sky.hpp"

#include "base/angles.hpp"
#include "base/error.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace lucerna {

namespace {

const glm::dvec3 kLuminance(0.2126, 0.7152, 0.0722);  // of linear sRGB, IEC 61966-2-1

/// Perez's distribution: darkening towards the horizon (a, b), brightening around the sun (c, d), light scattered back
/// (e). [Preetham1999, eq 3]
struct Perez {
  double a, b, c, d, e;
  double operator()(double cosZenith, double gamma) const {
    const double cosGamma = std::cos(gamma);
    return (1.0 + a * std::exp(b / cosZenith)) * (1.0 + c * std::exp(d * gamma) + e * cosGamma * cosGamma);
  }
};

/// A cubic of the sun's zenith angle whose coefficients are quadratics of turbidity. [Preetham1999, A.2]
double zenithChromaticity(const double (&m)[3][4], double turbidity, double s) {
  const auto cubic = [&](const double(&row)[4]) { return ((row[0] * s + row[1]) * s + row[2]) * s + row[3]; };
  return (cubic(m[0]) * turbidity + cubic(m[1])) * turbidity + cubic(m[2]);
}
constexpr double kZenithX[3][4] = {
    {0.00166, -0.00375, 0.00209, 0.0}, {-0.02903, 0.06377, -0.03202, 0.00394}, {0.11693, -0.21196, 0.06052, 0.25886}};
constexpr double kZenithY[3][4] = {
    {0.00275, -0.00610, 0.00317, 0.0}, {-0.04214, 0.08970, -0.04153, 0.00516}, {0.15346, -0.26756, 0.06670, 0.26688}};

// Illuminance outside the atmosphere, klx: the Illuminating Engineering Society's (RP-21, 1984); newer measurements
// give 133.1.
constexpr double kSolarIlluminance = 127.5;

double airMass(double zenithAngle) {
  return 1.0 / (std::cos(zenithAngle) + 0.15 * std::pow(93.885 - zenithAngle / kDegree, -1.253));
}

/// Optical thickness of clean air along the sun's rays. [Navvab1984]
double cleanAir(double mass) { return 0.1 * mass / (1.0 + 0.0045 * mass); }

double angleBetween(const glm::dvec3& a, const glm::dvec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

}  // namespace

SkyColour skyColour(double turbidity, const glm::dvec3& toSun, const glm::dvec3& direction) {
  const double t = turbidity, sunZenith = std::acos(std::clamp(toSun.y, 0.0, 1.0)),
               gamma = angleBetween(toSun, direction);
  const double cosZenith = std::max(direction.y, 1e-6);  // every b is below 0: the value at the horizon is a limit
  const Perez luminance{0.1787 * t - 1.4630, -0.3554 * t + 0.4275, -0.0227 * t + 5.3251, 0.1206 * t - 2.5771,
                        -0.0670 * t + 0.3703};
  const Perez x{-0.0193 * t - 0.2592, -0.0665 * t + 0.0008, -0.0004 * t + 0.2125, -0.0641 * t - 0.8989,
                -0.0033 * t + 0.0452};
  const Perez y{-0.0167 * t - 0.2608, -0.0950 * t + 0.0092, -0.0079 * t + 0.2102, -0.0441 * t - 1.6537,
                -0.0109 * t + 0.0529};
  const auto overZenith = [&](const Perez& perez) {
    return perez(cosZenith, gamma) / perez(1.0, sunZenith);
  };  // [Preetham1999, eq 4]
  return {overZenith(luminance), zenithChromaticity(kZenithX, t, sunZenith) * overZenith(x),
          zenithChromaticity(kZenithY, t, sunZenith) * overZenith(y)};
}

glm::dvec3 linearSrgb(const SkyColour& colour) {
  const glm::dvec3 xyz(colour.x / colour.y, 1.0, (1.0 - colour.x - colour.y) / colour.y);
  // IEC 61966-2-1, with more digits, so that white stays white.
  const glm::dvec3 rgb(3.2404541621 * xyz.x - 1.5371385128 * xyz.y - 0.4985314096 * xyz.z,
                       -0.9692660305 * xyz.x + 1.8760108454 * xyz.y + 0.0415560175 * xyz.z,
                       0.0556434310 * xyz.x - 0.2040259135 * xyz.y + 1.0572251882 * xyz.z);
  const double least = std::min({rgb.x, rgb.y, rgb.z});
  const double kept = least < 0.0 ? 1.0 / (1.0 - least) : 1.0;
  return colour.luminance * glm::max(glm::dvec3(1.0) + kept * (rgb - 1.0), glm::dvec3(0.0));
}

double sunIlluminance(double turbidity, double zenithAngle) {
  return kSolarIlluminance * std::exp(-cleanAir(airMass(zenithAngle)) * turbidity);
}

double skyIlluminance(double turbidity, double zenithAngle) {
  const double mass = airMass(zenithAngle), air = cleanAir(mass), haze = air * (turbidity - 1.0);
  return kSolarIlluminance / mass * 0.79 * (0.5 * -std::expm1(-air) + 0.84 * -std::expm1(-haze)) /
         (1.0 - mass + std::pow(mass, 1.02));
}

Image clearSkyPicture(const ClearSky& sky, const DirectionalLight& sun, int height) {
  CHECK(height > 0 && height % 2 == 0, "a sky of {} rows", height);
  const glm::dvec3 toSun = -sun.direction;
  if (!(toSun.y >= 0.0)) throwBadInput("a clear sky: the sun is below the horizon");
  if (!(sky.turbidity >= ClearSky::kLeastTurbidity && sky.turbidity <= ClearSky::kMostTurbidity))
    throwBadInput("a clear sky: turbidity {}, expected {} to {}", sky.turbidity, ClearSky::kLeastTurbidity,
                  ClearSky::kMostTurbidity);
  if (!(sky.ground >= 0.0 && sky.ground <= 1.0))
    throwBadInput("a clear sky: an albedo of {} below the horizon, expected 0 to 1", sky.ground);

  const int width = 2 * height;
  std::vector<glm::dvec3> radiance;
  glm::dvec3 ofSky(0.0);  // irradiance of the ground
  for (int row = 0; row < height / 2; ++row) {
    const double zenith = kPi * (row + 0.5) / height;
    const double top = std::cos(kPi * row / height), bottom = std::cos(kPi * (row + 1) / height);
    const double cosineSolidAngle = kPi / width * (top * top - bottom * bottom);  // integral of the cosine over a texel
    for (int column = 0; column < width; ++column) {
      const double azimuth = 2.0 * kPi * ((column + 0.5) / width - 0.5);
      const glm::dvec3 direction(std::sin(zenith) * std::sin(azimuth), std::cos(zenith),
                                 -std::sin(zenith) * std::cos(azimuth));
      radiance.push_back(linearSrgb(skyColour(sky.turbidity, toSun, direction)));
      ofSky += cosineSolidAngle * radiance.back();
    }
  }
  const double sunZenith = std::acos(std::min(toSun.y, 1.0));
  const glm::dvec3 ofSun(sun.irradiance);
  const double scale = glm::dot(ofSun, kLuminance) / glm::dot(ofSky, kLuminance) *
                       skyIlluminance(sky.turbidity, sunZenith) / sunIlluminance(sky.turbidity, sunZenith);
  const glm::vec3 ground(sky.ground / kPi * (toSun.y * ofSun + scale * ofSky));
  Image picture(width, height, ground);
  for (std::size_t i = 0; i < radiance.size(); ++i) picture.pixels[i] = glm::vec3(scale * radiance[i]);
  return picture;
}

glm::dvec3 directionToSun(double latitude, double day, double hour) {
  const double declination = 0.4093 * std::sin(2.0 * kPi * (day - 81.0) / 368.0),
               hourAngle = kPi * (hour - 12.0) / 12.0;
  const double l = latitude * kDegree;
  const double up = std::sin(l) * std::sin(declination) + std::cos(l) * std::cos(declination) * std::cos(hourAngle);
  const double north = std::cos(l) * std::sin(declination) - std::sin(l) * std::cos(declination) * std::cos(hourAngle);
  const double east = -std::cos(declination) * std::sin(hourAngle);
  return glm::normalize(glm::dvec3(east, up, -north));
}

glm::vec3 sunThroughAir(double turbidity, const glm::dvec3& toSun, const glm::vec3& outside) {
  if (!(toSun.y > 0.0)) return glm::vec3(0.0f);
  const glm::dvec3 wavelengths(0.61, 0.55, 0.465);  // micrometres, of sRGB's primaries
  const double mass = airMass(std::acos(std::min(toSun.y, 1.0))), haze = 0.04608 * turbidity - 0.04586;
  glm::dvec3 through;
  for (int c = 0; c < 3; ++c)
    through[c] = std::exp(-mass * (0.008735 * std::pow(wavelengths[c], -4.08) + haze * std::pow(wavelengths[c], -1.3)));
  return outside * glm::vec3(through);
}

Image skyOfDay(const ClearSky& sky, const glm::dvec3& toSun, const glm::vec3& outside, int height) {
  const double depression = std::max(0.0, -std::asin(std::clamp(toSun.y, -1.0, 1.0))) / kDegree;
  glm::dvec3 above(toSun.x, std::max(toSun.y, 0.0), toSun.z);
  above = glm::length(above) > 0.0 ? glm::normalize(above) : glm::dvec3(1.0, 0.0, 0.0);
  const double zenith = std::acos(std::min(above.y, 1.0));
  // The picture is in proportion to the sun's light as [Navvab1984] has it.
  const double light = glm::dot(glm::dvec3(outside), kLuminance) * sunIlluminance(sky.turbidity, zenith) /
                       kSolarIlluminance * std::exp(-depression / 1.3);
  return clearSkyPicture(sky, {-above, glm::vec3(static_cast<float>(light))}, height);
}

}  // namespace lucerna
