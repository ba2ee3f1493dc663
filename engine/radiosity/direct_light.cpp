#include "radiosity/direct_light.hpp"

#include "base/angles.hpp"
#include "gl/pass.hpp"
#include "scene/triangle_parts.hpp"

#include <algorithm>
#include <cmath>

namespace lucerna {

namespace {

/// Input of blocked.comp.
struct Ray {
  glm::vec4 origin;  ///< in the hierarchy's space; w: the patch
  glm::vec4 direction;  ///< to the light, its length the distance
  glm::vec4 normal;  ///< of the patch; w: the largest of its coordinates
};

/// Unoccluded light at a point: the vector to the light, and the irradiance across it.
struct Arrival {
  glm::dvec3 toLight, irradiance;
};

std::vector<Arrival> arrivals(const Scene& scene, const glm::dvec3& point, double beyond) {
  std::vector<Arrival> result;
  if (scene.sun) result.push_back({-beyond * scene.sun->direction, glm::dvec3(scene.sun->irradiance)});
  for (const SpotLight& light : scene.spots) {
    const glm::dvec3 to = light.position - point;
    const double cosine = glm::dot(-to, light.direction) / glm::length(to), inner = std::cos(light.innerAngle),
                 outer = std::cos(light.outerAngle);
    const double t =
        inner > outer ? std::clamp((cosine - outer) / (inner - outer), 0.0, 1.0) : (cosine >= outer ? 1.0 : 0.0);
    result.push_back({to, glm::dvec3(light.intensity) * (t * t * (3.0 - 2.0 * t) / glm::dot(to, to))});
  }
  for (const PointLight& light : scene.points) {
    const glm::dvec3 to = light.position - point;
    result.push_back({to, glm::dvec3(light.intensity) / glm::dot(to, to)});
  }
  return result;
}

/// Radiance of the texel that contains a direction, as paths see it (shaders/rays/environment.glsl).
glm::dvec3 radianceOf(const Environment& environment, const glm::dvec3& direction) {
  if (!environment.picture) return glm::dvec3(environment.radiance);
  const Image& picture = *environment.picture;
  const double rotations = 0.5 + (std::atan2(direction.x, -direction.z) + environment.rotation) / (2.0 * kPi);
  const double v = std::acos(std::clamp(direction.y, -1.0, 1.0)) / kPi;
  const int x = std::min(static_cast<int>((rotations - std::floor(rotations)) * picture.width), picture.width - 1);
  const int y = std::min(static_cast<int>(v * picture.height), picture.height - 1);
  return glm::dvec3(environment.radiance) * glm::dvec3(picture.at(x, y));
}

/// Traces visibility rays, in submissions of limited size.
class ShadowRays {
 public:
  static constexpr std::size_t kEach = 1 << 16;

  ShadowRays(gl::ProgramLibrary& programs, const RayScene& rays)
      : program_(programs.loadCompute("direct light", "radiosity/blocked.comp",
                                      {{"ALPHA_MASKS", 0}, {"SHARED_STACK", rays.sharedStack()}})),
        rays_(rays) {}

  /// Nonzero if occluded.
  std::vector<GLuint> blocked(const std::vector<Ray>& batch) const {
    if (batch.empty()) return {};
    const gl::Buffer rayBuffer("direct light rays", batch.size() * sizeof(Ray), batch.data(), gl::Usage::streamDraw);
    const gl::Buffer flags("direct light blocked", batch.size() * sizeof(GLuint), nullptr, gl::Usage::dynamicRead);
    {
      const gl::ComputePass pass("direct light");
      program_.use();
      program_.set("rayCount", static_cast<int>(batch.size()));
      rays_.bind();
      rayBuffer.bindStorage(1);
      flags.bindStorage(2);
      pass.dispatch({static_cast<int>(batch.size()), 1, 1}, {64, 1, 1});
    }
    return flags.read<GLuint>();
  }

 private:
  const gl::Program& program_;
  const RayScene& rays_;
};

/// A patch's normal, and the largest coordinate of its corners in the hierarchy's space, which determines the rounding
/// error.
glm::vec4 faceOf(const RadiosityMesh& mesh, const Patch& patch, const glm::dvec3& origin) {
  double largest = 0.0;
  for (const glm::dvec3& corner : mesh.corners(patch))
    largest = std::max(
        {largest, std::abs(corner.x - origin.x), std::abs(corner.y - origin.y), std::abs(corner.z - origin.z)});
  return glm::vec4(glm::vec3(patch.faceNormal), static_cast<float>(largest));
}

/// Centroids of the parts that are not hidden; at least one.
std::vector<glm::dvec3> pointsOf(const RadiosityMesh& mesh, const Patch& patch,
                                 const std::vector<glm::dvec2>& centroids) {
  const auto c = mesh.corners(patch);
  std::vector<glm::dvec3> points;
  for (const glm::dvec2& w : centroids)
    if (!(patch.hidden >> partAt(kPatchParts, w) & 1))
      points.push_back(c[0] + w.x * (c[1] - c[0]) + w.y * (c[2] - c[0]));
  if (points.empty()) points.push_back(patch.centroid);
  return points;
}

}  // namespace

std::vector<glm::dvec3> directLight(gl::ProgramLibrary& programs, const RayScene& rays, const Scene& scene,
                                    const RadiosityMesh& mesh, std::size_t most) {
  std::vector<glm::dvec3> irradiance(mesh.patches.size(), glm::dvec3(0.0));
  const std::size_t lights = (scene.sun ? 1 : 0) + scene.spots.size() + scene.points.size();
  if (lights == 0) return irradiance;
  const int parts = std::clamp(
      static_cast<int>(std::sqrt(static_cast<double>(most) / static_cast<double>(lights * mesh.patches.size()))), 1, 4);
  const double beyond = 4.0 * mesh.extent;
  const std::vector<glm::dvec2> centroids = partCentroids(parts);
  const ShadowRays shadowRays(programs, rays);

  // Patches in runs whose rays fill one submission.
  const std::size_t raysOfPatch = static_cast<std::size_t>(parts * parts) * lights;
  const std::size_t patchesEach = std::max<std::size_t>(ShadowRays::kEach / raysOfPatch, 1);
  for (std::size_t first = 0; first < mesh.patches.size(); first += patchesEach) {
    std::vector<Ray> batch;
    struct Sample {
      std::size_t patch;
      glm::dvec3 irradiance;
    };
    std::vector<Sample> samples;
    for (std::size_t p = first; p < std::min(first + patchesEach, mesh.patches.size()); ++p) {
      const Patch& patch = mesh.patches[p];
      const glm::vec4 normal = faceOf(mesh, patch, rays.origin());
      const std::vector<glm::dvec3> points = pointsOf(mesh, patch, centroids);
      for (const glm::dvec3& point : points)
        for (const Arrival& arrival : arrivals(scene, point, beyond)) {
          const double cosine = glm::dot(glm::normalize(arrival.toLight), patch.faceNormal);
          if (cosine <= 0.0 || arrival.irradiance == glm::dvec3(0.0)) continue;
          batch.push_back({glm::vec4(glm::vec3(point - rays.origin()), static_cast<float>(p)),
                           glm::vec4(glm::vec3(arrival.toLight), 0.0f), normal});
          samples.push_back({p, arrival.irradiance * (cosine / static_cast<double>(points.size()))});
        }
    }
    const std::vector<GLuint> flags = shadowRays.blocked(batch);
    for (std::size_t k = 0; k < samples.size(); ++k)
      if (!flags[k]) irradiance[samples[k].patch] += samples[k].irradiance;
  }
  return irradiance;
}

std::vector<glm::dvec3> skyLight(gl::ProgramLibrary& programs, const RayScene& rays, const Scene& scene,
                                 const RadiosityMesh& mesh, std::size_t most) {
  constexpr double kPlastic = 0.75487766624669276;  // 1 / the plastic number: with its square the steps of a lattice in
                                                    // two more dimensions, angle and point
  std::vector<glm::dvec3> irradiance(mesh.patches.size(), glm::dvec3(0.0));
  const std::size_t raysOfPatch =
      std::clamp<std::size_t>(most / std::max<std::size_t>(mesh.patches.size(), 1), 64, 1024);
  const double beyond = 4.0 * mesh.extent;
  const std::vector<glm::dvec2> centroids = partCentroids(4);
  const ShadowRays shadowRays(programs, rays);
  for (std::size_t first = 0; first < mesh.patches.size(); first += ShadowRays::kEach / raysOfPatch) {
    const std::size_t end = std::min(first + ShadowRays::kEach / raysOfPatch, mesh.patches.size());
    std::vector<Ray> batch;
    std::vector<glm::dvec3> radiance;
    for (std::size_t p = first; p < end; ++p) {
      const Patch& patch = mesh.patches[p];
      const glm::vec4 face = faceOf(mesh, patch, rays.origin());
      const std::vector<glm::dvec3> points = pointsOf(mesh, patch, centroids);
      const glm::dvec3 n = patch.faceNormal,
                       u = glm::normalize(std::abs(n.x) < 0.5 ? glm::cross(n, glm::dvec3(1, 0, 0))
                                                              : glm::cross(n, glm::dvec3(0, 1, 0))),
                       v = glm::cross(n, u);
      for (std::size_t k = 0; k < raysOfPatch; ++k) {
        // Uniform points on the unit disc are cosine-distributed on the hemisphere above it. Each patch turns them.
        const double r2 = (static_cast<double>(k) + 0.5) / static_cast<double>(raysOfPatch),
                     angle = 2.0 * kPi * kPlastic * static_cast<double>(k + p);
        const double which = kPlastic * kPlastic * static_cast<double>(k);
        const glm::dvec3& point =
            points[static_cast<std::size_t>((which - std::floor(which)) * static_cast<double>(points.size()))];
        const glm::dvec3 direction =
            std::sqrt(r2) * (std::cos(angle) * u + std::sin(angle) * v) + std::sqrt(1.0 - r2) * n;
        batch.push_back({glm::vec4(glm::vec3(point - rays.origin()), static_cast<float>(p)),
                         glm::vec4(glm::vec3(beyond * direction), 0.0f), face});
        radiance.push_back(radianceOf(*scene.environment, direction));
      }
    }
    const std::vector<GLuint> flags = shadowRays.blocked(batch);
    for (std::size_t k = 0; k < batch.size(); ++k)
      if (!flags[k]) irradiance[first + k / raysOfPatch] += kPi / static_cast<double>(raysOfPatch) * radiance[k];
  }
  return irradiance;
}

}  // namespace lucerna
