#include "pathtracer/inspect_paths.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace lucerna {

namespace {

std::string nameOfTriangle(const Scene& scene, std::uint32_t triangle) {
  for (const Mesh& mesh : scene.meshes)
    if (3 * triangle >= mesh.firstIndex && 3 * triangle < mesh.firstIndex + mesh.indexCount)
      return fmt::format("triangle {} ({})", triangle, scene.materials[static_cast<std::size_t>(mesh.material)].name);
  return fmt::format("triangle {}", triangle);
}

/// Names of the lamps in the table that light samples are drawn from: the order of rays/light_table.cpp, without dark
/// lamps.
std::vector<std::string> namesOfLamps(const Scene& scene) {
  std::vector<std::string> names;
  const auto shines = [](const glm::vec3& c) { return c.x > 0.0f || c.y > 0.0f || c.z > 0.0f; };
  if (scene.sun && shines(scene.sun->irradiance)) names.emplace_back("sun");
  for (std::size_t i = 0; i < scene.spots.size(); ++i)
    if (shines(scene.spots[i].intensity)) names.push_back(fmt::format("spot {}", i + 1));
  for (std::size_t i = 0; i < scene.points.size(); ++i)
    if (shines(scene.points[i].intensity)) names.push_back(fmt::format("point {}", i + 1));
  return names;
}

PixelShare shareOf(const Scene& scene, const std::vector<std::string>& lamps, const PathTracer::InspectedLight& light) {
  PixelShare share;
  switch (light.kind) {
    case PATH_LIGHT_TRIANGLE: share.name = nameOfTriangle(scene, light.number); break;
    case PATH_LIGHT_ENVIRONMENT: share.name = "sky"; break;
    case PATH_INSPECTED_MEDIUM: share.name = "a medium that shines"; break;
    case PATH_INSPECTED_BACKGROUND: share.name = "background"; break;
    default: share.name = light.number < lamps.size() ? lamps[light.number] : "a lamp";
  }
  constexpr std::uint32_t kMostApart = 8;  // light in media is scattered hundreds of times
  share.group = light.scatterings == 0            ? "seen directly"
                : light.scatterings == 1          ? "direct"
                : light.scatterings <= kMostApart ? fmt::format("scattered {} times", light.scatterings)
                                                  : fmt::format("scattered over {} times", kMostApart);
  share.places = light.places;
  const double reach = glm::length(scene.bounds.extent());
  share.places.push_back(light.infinite ? light.places.back() + reach * light.end : light.end);
  return share;
}

}  // namespace

PixelInspection inspectPaths(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene,
                             const Camera& camera, PathTracer::Settings settings, std::uint32_t samples,
                             glm::ivec2 pixel) {
  settings.inspectedPixel = glm::ivec2(pixel.x, settings.size.y - 1 - pixel.y);
  settings.halves = false;
  PathTracer tracer(context, programs, scene, settings);
  tracer.setCamera(camera);
  PixelInspection answer;
  answer.pixel = pixel;
  answer.technique = "path";
  answer.samples = samples;
  const std::vector<std::string> lamps = namesOfLamps(scene);
  const double each = 1.0 / samples;
  std::map<std::uint32_t, glm::dvec3> ofSample;
  // Beyond this number the faintest are only counted: a pixel has thousands of paths.
  constexpr std::size_t kMost = 4096;
  constexpr std::uint32_t kStep = 1024;
  for (std::uint32_t done = 0; done < samples; done = tracer.samples()) {
    tracer.record(std::min(samples, done + kStep));
    for (const PathTracer::InspectedLight& light : tracer.takeInspected()) {
      ofSample.try_emplace(light.sample, 0.0).first->second += glm::dvec3(light.radiance);
      answer.shares.push_back(shareOf(scene, lamps, light));
      answer.shares.back().radiance = each * glm::dvec3(light.radiance);
    }
    if (answer.shares.size() > kMost) answer.condense(64);
  }
  glm::dvec3 squares(0.0);
  for (const auto& [sample, radiance] : ofSample) answer.radiance += each * radiance;
  for (const auto& [sample, radiance] : ofSample)
    squares += (radiance - answer.radiance) * (radiance - answer.radiance);
  squares += static_cast<double>(samples - ofSample.size()) * answer.radiance * answer.radiance;  // without light
  if (samples > 1) answer.standardError = glm::sqrt(squares / (static_cast<double>(samples) * (samples - 1.0)));
  return answer;
}

}  // namespace lucerna
