#include "forward/light_views.hpp"

#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace lucerna {

namespace {

struct Face {
  glm::dvec3 axis, up;
};
// OpenGL 4.3, table 8.18: the image of a cube map's face has its t axis downwards.
constexpr std::array<Face, 6> kFaces{{{{1, 0, 0}, {0, -1, 0}},
                                      {{-1, 0, 0}, {0, -1, 0}},
                                      {{0, 1, 0}, {0, 0, 1}},
                                      {{0, -1, 0}, {0, 0, -1}},
                                      {{0, 0, 1}, {0, -1, 0}},
                                      {{0, 0, -1}, {0, -1, 0}}}};

float largest(const glm::vec3& v) { return std::max({v.x, v.y, v.z}); }

void placePlanes(LightViews& views, const Scene& scene) {
  const auto farPlane = [&](const Bounds& box) {
    const double farthest = box.farthestFrom(views.position);
    return farthest > 0.0 ? 1.01 * farthest : 1.0;
  };
  views.far = farPlane(scene.bounds);
  views.near = farPlane(scene.mainAround(views.position)) / 2000.0;
}

glm::dmat4 view(const LightViews& views, const glm::dvec3& axis, const glm::dvec3& up) {
  const double reach = views.near * views.tangent;
  return glm::frustum(-reach, reach, -reach, reach, views.near, views.far) *
         glm::lookAt(views.position, views.position + axis, up);
}

glm::dmat4 viewAlong(const LightViews& views, const glm::dvec3& axis) {
  return view(views, axis, std::abs(axis.y) < 0.99 ? glm::dvec3(0.0, 1.0, 0.0) : glm::dvec3(1.0, 0.0, 0.0));
}

}  // namespace

glm::mat4 LightViews::clipFromPlace(std::size_t view) const {
  return glm::mat4(glm::translate(clipFromWorld[view], glm::dvec3(place())));
}

double LightViews::largestSolidAngle(int size) const {
  // A square pyramid whose half opening angle has the tangent t subtends 4 asin(t^2 / (1 + t^2)) sr. The shader sums
  // w^2 f at texel centres, f = (1 + x^2 + y^2)^(-3/2), whose curvature is at least -3 everywhere: each texel exceeds
  // its integral by at most 3/2 * w^4 / 6, N^2 texels by t^2 w^2. And f is at most 1.
  const double t2 = tangent * tangent, width = texelWidth(size);
  return static_cast<double>(clipFromWorld.size()) *
         std::min(4.0 * std::asin(t2 / (1.0 + t2)) + t2 * width * width, 4.0 * t2);
}

LightViews lightViews(const SpotLight& light, const Scene& scene) {
  LightViews views{light.position,
                   light.intensity,
                   light.radius,
                   light.direction,
                   std::cos(light.innerAngle),
                   std::cos(light.outerAngle),
                   {}};
  placePlanes(views, scene);
  views.tangent = 1.01 * std::tan(light.outerAngle);  // the cone's rim and its filter lie inside the map
  views.clipFromWorld = {viewAlong(views, light.direction)};
  return views;
}

LightViews lightViews(const PointLight& light, const Scene& scene) {
  LightViews views;
  views.position = light.position;
  views.intensity = light.intensity;
  views.radius = light.radius;
  views.isPoint = true;
  placePlanes(views, scene);
  for (const Face& face : kFaces) views.clipFromWorld.push_back(view(views, face.axis, face.up));
  return views;
}

namespace {

bool isFarOutside(const PointLight& light, const Bounds& scene) {
  return glm::length(light.position - scene.centre()) > 0.75 * glm::length(scene.extent());
}

/// Of the scene's bounding sphere.
LightViews viewFromOutside(const PointLight& light, const Bounds& scene) {
  LightViews views;
  views.position = light.position;
  views.intensity = light.intensity;
  views.radius = light.radius;
  views.isPoint = true;
  const glm::dvec3 towards = scene.centre() - light.position;
  const double distance = glm::length(towards), radius = 0.5 * glm::length(scene.extent());
  views.direction = towards / distance;
  views.tangent = 1.02 * radius / std::sqrt((distance - radius) * (distance + radius));
  views.near = 0.98 * (distance - radius);
  views.far = 1.01 * (distance + radius);
  views.clipFromWorld = {viewAlong(views, views.direction)};
  return views;
}

}  // namespace

std::vector<LightViews> spotViews(const Scene& scene) {
  std::vector<LightViews> views;
  for (std::size_t i = 0; i < scene.points.size(); ++i)
    if (largest(scene.points[i].intensity) > 0.0f && isFarOutside(scene.points[i], scene.main())) {
      views.push_back(viewFromOutside(scene.points[i], scene.main()));
      views.back().index = i;
    }
  for (std::size_t i = 0; i < scene.spots.size(); ++i)
    if (largest(scene.spots[i].intensity) > 0.0f) {
      views.push_back(lightViews(scene.spots[i], scene));
      views.back().index = i;
    }
  return views;
}

std::vector<LightViews> pointViews(const Scene& scene) {
  std::vector<LightViews> views;
  for (std::size_t i = 0; i < scene.points.size(); ++i)
    if (largest(scene.points[i].intensity) > 0.0f && !isFarOutside(scene.points[i], scene.main())) {
      views.push_back(lightViews(scene.points[i], scene));
      views.back().index = i;
    }
  return views;
}

float typicalIrradiance(const Scene& scene) {
  const double distance = 0.25 * glm::length(scene.main().extent());
  double result = scene.sun ? static_cast<double>(largest(scene.sun->irradiance)) : 0.0;
  const auto add = [&](const glm::vec3& intensity) {
    if (distance > 0.0) result = std::max(result, static_cast<double>(largest(intensity)) / (distance * distance));
  };
  for (const SpotLight& light : scene.spots) add(light.intensity);
  for (const PointLight& light : scene.points) add(light.intensity);
  return result > 0.0 ? static_cast<float>(std::clamp(result, 1e-30, 1e30)) : 1.0f;
}

}  // namespace lucerna
