#include "radiosity/direct_rays.hpp"

#include "gl/chunks.hpp"
#include "radiosity/patches.hpp"

#include <algorithm>
#include <cmath>

namespace lucerna {

namespace {

constexpr GLuint kLightsBinding = 1;

enum Kind : int { kTriangle = 0, kSun = 1, kSpot = 2, kPoint = 3 };

struct Light {
  glm::vec4 a;  ///< a corner; direction to the sun; position. w: kind
  glm::vec4 b;  ///< an edge; a spot's axis. w: cosine of a spot's inner angle
  glm::vec4 c;  ///< the other edge. w: cosine of a spot's outer angle
  glm::vec4 d;  ///< exitance; irradiance across the rays; radiant intensity
};

/// Emissive triangles as patches: oriented by their fronts, without those of zero area.
std::vector<Patch> emittersOf(const Scene& scene, RadiosityMesh& mesh) {
  std::vector<Patch> emitters;
  if (std::none_of(scene.materials.begin(), scene.materials.end(),
                   [](const Material& m) { return m.emission != glm::vec3(0.0f); }))
    return emitters;
  mesh = makePatches(scene, {});
  for (const Patch& patch : mesh.patches)
    if (patch.emission != glm::dvec3(0.0)) emitters.push_back(patch);
  return emitters;
}

}  // namespace

std::size_t DirectRays::emitterCount(const Scene& scene) {
  RadiosityMesh mesh;
  return emittersOf(scene, mesh).size();
}

DirectRays::DirectRays(const Scene& scene, const gl::Capabilities& capabilities, int rays,
                       const glm::dvec3& pixelOrigin)
    : rays_(scene, capabilities) {
  RadiosityMesh mesh;
  const std::vector<Patch> emitters = emittersOf(scene, mesh);
  const glm::dvec3 origin = rays_.origin();
  const auto vec = [](const glm::dvec3& v, double w = 0.0) { return glm::vec4(glm::vec3(v), static_cast<float>(w)); };
  std::vector<Light> lights;
  for (const Patch& patch : emitters) {
    const auto c = mesh.corners(patch);
    lights.push_back({vec(c[0] - origin, kTriangle), vec(c[1] - c[0]), vec(c[2] - c[0]), vec(patch.emission)});
  }
  if (scene.sun) lights.push_back({vec(-scene.sun->direction, kSun), {}, {}, vec(glm::dvec3(scene.sun->irradiance))});
  for (const SpotLight& l : scene.spots)
    lights.push_back({vec(l.position - origin, kSpot), vec(l.direction, std::cos(l.innerAngle)),
                      vec({}, std::cos(l.outerAngle)), vec(glm::dvec3(l.intensity))});
  for (const PointLight& l : scene.points)
    lights.push_back({vec(l.position - origin, kPoint), {}, {}, vec(glm::dvec3(l.intensity))});
  const int each = std::max(1, rays / static_cast<int>(std::max<std::size_t>(emitters.size(), 1)));
  // GL buffers cannot be empty: without lights upload one dummy; the count in the head is 0.
  const double raysOfPixel =
      static_cast<double>(emitters.size()) * each + static_cast<double>(lights.size() - emitters.size());
  iterationsOfPixel_ = gl::kIterationsOfRay * std::max(raysOfPixel, 1.0);
  const int head[4] = {static_cast<int>(lights.size()), each, 0, 0};
  std::vector<std::uint8_t> bytes;
  const auto put = [&](const void* data, std::size_t size) {
    bytes.insert(bytes.end(), static_cast<const std::uint8_t*>(data), static_cast<const std::uint8_t*>(data) + size);
  };
  put(head, sizeof head);
  const glm::vec4 start = vec(origin - pixelOrigin);
  put(&start, sizeof start);
  if (lights.empty()) lights.emplace_back();
  put(lights.data(), lights.size() * sizeof(Light));
  lights_ = gl::Buffer("direct lights", bytes.size(), bytes.data(), gl::Usage::staticDraw);
}

void DirectRays::bind() const {
  rays_.bind();
  lights_.bindStorage(kLightsBinding);
}

}  // namespace lucerna
