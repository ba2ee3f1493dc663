#include "radiosity/direct_rays.hpp"

#include "base/angles.hpp"
#include "gl/chunks.hpp"
#include "radiosity/patches.hpp"
#include "rays/light_table.hpp"
#include "scene/texture_mean.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace lucerna {

namespace {

constexpr GLuint kLightsBinding = 1;

enum Kind : int { kTriangle = 0, kSun = 1, kSpot = 2, kPoint = 3 };

struct Light {
  glm::vec4 a;  ///< a corner at the shortest edge; direction to the sun; position. w: kind
  glm::vec4 b;  ///< an edge; a spot's axis. w: cosine of a spot's inner angle
  glm::vec4 c;  ///< the other edge. w: cosine of a spot's outer angle
  glm::vec4 d;  ///< exitance; irradiance across the rays; radiant intensity. w: size, as PathLight's
};

struct Corner {
  glm::dvec3 position;
  glm::dvec2 texCoord;
};

/// An emissive triangle, or a piece of one.
struct Emitter {
  std::array<Corner, 3> corners;  ///< counterclockwise seen from the front
  glm::dvec3 exitance;
  const Material* material;
};

using Polygon = std::vector<Corner>;  ///< convex

/// Cuts polygons where a coordinate of the texture is `at`.
std::vector<Polygon> cutAt(const std::vector<Polygon>& polygons, int axis, double at) {
  std::vector<Polygon> pieces;
  for (const Polygon& whole : polygons)
    for (const double side : {-1.0, 1.0}) {
      Polygon piece;
      bool hasArea = false;
      for (std::size_t k = 0; k < whole.size(); ++k) {
        const Corner &from = whole[k], &to = whole[(k + 1) % whole.size()];
        const double away = side * (from.texCoord[axis] - at), next = side * (to.texCoord[axis] - at);
        hasArea = hasArea || away > 1e-9;
        if (away >= 0.0) piece.push_back(from);
        if (away * next >= 0.0) continue;
        const double t = away / (away - next);
        piece.push_back({glm::mix(from.position, to.position, t), glm::mix(from.texCoord, to.texCoord, t)});
      }
      if (hasArea) pieces.push_back(piece);
    }
  return pieces;
}

/// Cuts an emitter at every `step`th texel of its picture, and gives each piece the mean of its texels; black ones are
/// left out. Nothing if there are more than `most`.
std::optional<std::vector<Emitter>> cutByTexels(const Scene& scene, const Emitter& whole, double step,
                                                std::size_t most) {
  const Material& material = *whole.material;
  if (material.emissionTexture < 0) return std::vector{whole};
  const Texture& texture = scene.textures[static_cast<std::size_t>(material.emissionTexture)];
  std::vector<Polygon> polygons{{whole.corners.begin(), whole.corners.end()}};
  for (const int axis : {0, 1}) {
    const double size = step / (axis == 0 ? texture.bitmap.width : texture.bitmap.height);
    const bool continues = (axis == 0 ? texture.wraps.u : texture.wraps.v) == TextureWrap::edge;
    const auto coordinate = [&](std::size_t k) {  // beyond an edge that continues there are no texels to cut at
      const double at = whole.corners[k].texCoord[axis];
      return continues ? std::clamp(at, 0.0, 1.0) : at;
    };
    const auto [least, last] = std::minmax({coordinate(0), coordinate(1), coordinate(2)});
    const double first = std::floor(least / size) + 1.0, count = std::ceil(last / size) - first;
    if (count > static_cast<double>(most)) return std::nullopt;
    for (double k = 0.0; k < count; k += 1.0) polygons = cutAt(polygons, axis, (first + k) * size);
    if (polygons.size() > most) return std::nullopt;
  }
  std::vector<Emitter> pieces;
  for (const Polygon& polygon : polygons)
    for (std::size_t k = 2; k < polygon.size(); ++k) {
      const std::array corners{polygon[0], polygon[k - 1], polygon[k]};
      const auto uv = [&](std::size_t i) { return glm::vec2(corners[i].texCoord); };
      const glm::dvec3 exitance =
          kPi * glm::dvec3(material.emissionScale) * meanTexture(texture, {uv(0), uv(1), uv(2)});
      if (exitance != glm::dvec3(0.0)) pieces.push_back({corners, exitance, &material});
    }
  return pieces;
}

/// Emissive triangles, oriented by their fronts, without those of zero area. What shines by a picture is cut by texels
/// or, where that makes more than DirectRays::kMostEmitters, by squares of 2, 4, .. texels.
std::vector<Emitter> emittersOf(const Scene& scene) {
  std::vector<Emitter> whole;
  if (std::none_of(scene.materials.begin(), scene.materials.end(),
                   [](const Material& m) { return m.emission != glm::vec3(0.0f); }))
    return whole;
  const RadiosityMesh mesh = makePatches(scene, {});
  for (const Patch& patch : mesh.patches) {
    if (patch.emission == glm::dvec3(0.0)) continue;
    const auto corner = [&](std::size_t k) {
      return Corner{mesh.points[patch.point[k]], glm::dvec2(patch.texCoord[k])};
    };
    whole.push_back({{corner(0), corner(1), corner(2)},
                     patch.emission,
                     &scene.materials[static_cast<std::size_t>(patch.material)]});
  }
  for (double step = 1.0; step < 1e6; step *= 2.0) {
    std::vector<Emitter> pieces;
    bool fits = true;
    for (const Emitter& one : whole) {
      const auto cut = cutByTexels(scene, one, step, DirectRays::kMostEmitters);
      fits = fits && cut && pieces.size() + cut->size() <= DirectRays::kMostEmitters;
      if (!fits) break;
      pieces.insert(pieces.end(), cut->begin(), cut->end());
    }
    if (fits) return pieces;
  }
  return whole;
}

}  // namespace

std::size_t DirectRays::emitterCount(const Scene& scene) { return emittersOf(scene).size(); }

DirectRays::DirectRays(const Scene& scene, const gl::Capabilities& capabilities, int rays,
                       const glm::dvec3& pixelOrigin)
    : rays_(scene, capabilities) {
  const std::vector<Emitter> emitters = emittersOf(scene);
  const glm::dvec3 origin = rays_.origin();
  const auto vec = [](const glm::dvec3& v, double w = 0.0) { return glm::vec4(glm::vec3(v), static_cast<float>(w)); };
  std::vector<Light> lights;
  for (const Emitter& emitter : emitters) {
    // From an end of the shortest edge: as the difference of two long ones it would be lost.
    const auto length = [&](std::size_t k) {
      return glm::distance(emitter.corners[k].position, emitter.corners[(k + 1) % 3].position);
    };
    const std::size_t shortest = length(0) <= std::min(length(1), length(2)) ? 0 : length(1) <= length(2) ? 1 : 2;
    const auto corner = [&](std::size_t k) { return emitter.corners[(k + shortest) % 3].position; };
    lights.push_back({vec(corner(0) - origin, kTriangle), vec(corner(1) - corner(0)), vec(corner(2) - corner(0)),
                      vec(emitter.exitance)});
  }
  if (scene.sun)
    lights.push_back(
        {vec(-scene.sun->direction, kSun), {}, {}, vec(glm::dvec3(scene.sun->irradiance), sunLessCosine(*scene.sun))});
  for (const SpotLight& l : scene.spots)
    lights.push_back({vec(l.position - origin, kSpot), vec(l.direction, std::cos(l.innerAngle)),
                      vec({}, std::cos(l.outerAngle)), vec(glm::dvec3(l.intensity), l.radius)});
  for (const PointLight& l : scene.points)
    lights.push_back({vec(l.position - origin, kPoint), {}, {}, vec(glm::dvec3(l.intensity), l.radius)});
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
