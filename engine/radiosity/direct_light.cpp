#include "radiosity/direct_light.hpp"

#include "gl/pass.hpp"
#include "scene/triangle_parts.hpp"

#include <algorithm>
#include <cmath>

namespace lucerna {

namespace {

/// As blocked.comp reads it.
struct Ray {
  glm::vec4 origin;     ///< in the hierarchy's space; w: the patch
  glm::vec4 direction;  ///< to the light, its length the distance
  glm::vec4 normal;     ///< of the patch; w: the largest of its coordinates
};

/// What arrives at a point if nothing is between: the way to the light, and irradiance across it.
struct Arrival {
  glm::dvec3 toLight, irradiance;
};

std::vector<Arrival> arrivals(const Scene& scene, const glm::dvec3& point, double beyond) {
  std::vector<Arrival> result;
  if (scene.sun) result.push_back({-beyond * scene.sun->direction, glm::dvec3(scene.sun->irradiance)});
  for (const SpotLight& light : scene.spots) {
    const glm::dvec3 to = light.position - point;
    const double cosine = glm::dot(-to, light.direction) / glm::length(to), inner = std::cos(light.innerAngle), outer = std::cos(light.outerAngle);
    const double t = inner > outer ? std::clamp((cosine - outer) / (inner - outer), 0.0, 1.0) : (cosine >= outer ? 1.0 : 0.0);
    result.push_back({to, glm::dvec3(light.intensity) * (t * t * (3.0 - 2.0 * t) / glm::dot(to, to))});
  }
  for (const PointLight& light : scene.points) {
    const glm::dvec3 to = light.position - point;
    result.push_back({to, glm::dvec3(light.intensity) / glm::dot(to, to)});
  }
  return result;
}

}  // namespace

std::vector<glm::dvec3> directLight(gl::ProgramLibrary& programs, const RayScene& rays, const Scene& scene, const RadiosityMesh& mesh, std::size_t most) {
  std::vector<glm::dvec3> irradiance(mesh.patches.size(), glm::dvec3(0.0));
  const std::size_t lights = (scene.sun ? 1 : 0) + scene.spots.size() + scene.points.size();
  if (lights == 0) return irradiance;
  const int parts = std::clamp(static_cast<int>(std::sqrt(static_cast<double>(most) / static_cast<double>(lights * mesh.patches.size()))), 1, 4);
  const double beyond = 4.0 * mesh.extent;
  const std::vector<glm::dvec2> centroids = partCentroids(parts);

  const gl::Program& program = programs.loadCompute("direct light", "radiosity/blocked.comp", {{"ALPHA_MASKS", 0}, {"SHARED_STACK", rays.sharedStack()}});

  // Patches in runs whose rays fill one submission.
  constexpr std::size_t kRaysEach = 1 << 16;
  const std::size_t raysOfPatch = static_cast<std::size_t>(parts * parts) * lights;
  const std::size_t patchesEach = std::max<std::size_t>(kRaysEach / raysOfPatch, 1);
  for (std::size_t first = 0; first < mesh.patches.size(); first += patchesEach) {
    std::vector<Ray> batch;
    std::vector<glm::dvec3> points;  // of a patch
    struct Sample {
      std::size_t patch;
      glm::dvec3 irradiance;
    };
    std::vector<Sample> samples;
    for (std::size_t p = first; p < std::min(first + patchesEach, mesh.patches.size()); ++p) {
      const Patch& patch = mesh.patches[p];
      const auto c = mesh.corners(patch);
      double largest = 0.0;
      for (const glm::dvec3& corner : c) largest = std::max({largest, std::abs(corner.x - rays.origin().x), std::abs(corner.y - rays.origin().y), std::abs(corner.z - rays.origin().z)});
      const glm::vec4 normal(glm::vec3(patch.faceNormal), static_cast<float>(largest));
      points.clear();
      for (const glm::dvec2& w : centroids)
        if (!(patch.hidden >> partAt(kPatchParts, w) & 1)) points.push_back(c[0] + w.x * (c[1] - c[0]) + w.y * (c[2] - c[0]));
      if (points.empty()) points.push_back(patch.centroid);
      for (const glm::dvec3& point : points)
        for (const Arrival& arrival : arrivals(scene, point, beyond)) {
          const double cosine = glm::dot(glm::normalize(arrival.toLight), patch.faceNormal);
          if (cosine <= 0.0 || arrival.irradiance == glm::dvec3(0.0)) continue;
          batch.push_back({glm::vec4(glm::vec3(point - rays.origin()), static_cast<float>(p)), glm::vec4(glm::vec3(arrival.toLight), 0.0f), normal});
          samples.push_back({p, arrival.irradiance * (cosine / static_cast<double>(points.size()))});
        }
    }
    if (batch.empty()) continue;
    const gl::Buffer rayBuffer("direct light rays", batch.size() * sizeof(Ray), batch.data(), GL_STREAM_DRAW);
    const gl::Buffer blocked("direct light blocked", batch.size() * sizeof(GLuint), nullptr, GL_DYNAMIC_READ);
    {
      const gl::ComputePass pass("direct light", GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
      program.use();
      program.set("rayCount", static_cast<int>(batch.size()));
      rays.bind();
      rayBuffer.bind(GL_SHADER_STORAGE_BUFFER, 1);
      blocked.bind(GL_SHADER_STORAGE_BUFFER, 2);
      pass.dispatch({static_cast<int>(batch.size()), 1, 1}, {64, 1, 1});
    }
    const std::vector<GLuint> flags = blocked.read<GLuint>();
    for (std::size_t k = 0; k < samples.size(); ++k)
      if (!flags[k]) irradiance[samples[k].patch] += samples[k].irradiance;
  }
  return irradiance;
}

}  // namespace lucerna
