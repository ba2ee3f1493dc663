#include "radiosity/original/rad_scene.hpp"

#include "base/error.hpp"
#include "radiosity/patches.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace lucerna {

namespace {

double meanOfChannels(const glm::dvec3& v) { return (v.x + v.y + v.z) / 3.0; }

glm::dvec3 hueOf(const glm::dvec3& v) {
  const double largest = std::max({v.x, v.y, v.z});
  return largest > 0.0 ? v / largest : glm::dvec3(0.0);
}

/// Its corners, normal and colour.
RadTriangle triangleOf(const RadiosityMesh& mesh, const Patch& patch) {
  const auto corners = mesh.corners(patch);
  RadTriangle t;
  t.p1 = toFloats(corners[0]), t.p2 = toFloats(corners[1]), t.p3 = toFloats(corners[2]);
  t.n = toFloats(patch.faceNormal);
  t.c = toFloats(hueOf(meanOfChannels(patch.emission) > 0.0 ? patch.emission : patch.reflectance));
  return t;
}

/// Emission in steps; at least 1 if the patch emits at all.
std::uint32_t stepsOf(double exitance, double step) {
  return exitance > 0.0 ? std::max(1u, static_cast<std::uint32_t>(std::lround(exitance / step))) : 0u;
}

}  // namespace

RadScene radTrianglesOf(const Scene& scene, const RadSceneSettings& settings, const RadReceived& received) {
  CHECK(settings.lightPower >= 1 && settings.lightPower <= kRadMost, "power {}", settings.lightPower);
  RadScene result;
  const glm::dvec3 extent = scene.bounds.extent();
  PatchSettings patches;
  patches.longestEdge = result.longestEdge =
      settings.longestEdge > 0.0 ? settings.longestEdge : std::max({extent.x, extent.y, extent.z}) / 12.0;
  RadiosityMesh mesh = makePatches(scene, patches);
  if (received) {
    const std::vector<glm::dvec3> irradiance = received(mesh);
    for (std::size_t i = 0; i < mesh.patches.size(); ++i)
      mesh.patches[i].emission += mesh.patches[i].reflectance * irradiance[i];
  }
  double brightest = 0.0;
  for (const Patch& patch : mesh.patches) brightest = std::max(brightest, meanOfChannels(patch.emission));
  if (!(brightest > 0.0))
    throwBadInput(
        "{}: no surface emits; the original's files have no other lights than triangles with e above 0 (--lights hands "
        "over sun, lamps and environment)",
        scene.file.string());
  result.exitanceOfStep = brightest / settings.lightPower;
  result.triangles.reserve(mesh.patches.size());
  for (const Patch& patch : mesh.patches) {
    const double emission = meanOfChannels(patch.emission);
    RadTriangle t = triangleOf(mesh, patch);
    t.ro = static_cast<float>(meanOfChannels(patch.reflectance));
    t.e = stepsOf(emission, result.exitanceOfStep);
    result.sources += t.e > 0;
    result.triangles.push_back(t);
  }
  return result;
}

std::vector<RadTriangle> radTrianglesOf(const RadiosityMesh& mesh, std::span<const glm::dvec3> exitance, int channel,
                                        double exitanceOfStep) {
  CHECK(exitance.size() == mesh.patches.size(), "{} values of {} patches", exitance.size(), mesh.patches.size());
  CHECK(channel >= 0 && channel < 3, "channel {}", channel);
  std::vector<RadTriangle> triangles;
  triangles.reserve(mesh.patches.size());
  for (std::size_t i = 0; i < mesh.patches.size(); ++i) {
    RadTriangle t = triangleOf(mesh, mesh.patches[i]);
    t.ro = static_cast<float>(mesh.patches[i].reflectance[channel]);
    t.e = stepsOf(exitance[i][channel], exitanceOfStep);
    triangles.push_back(t);
  }
  return triangles;
}

Scene sceneOfTriangles(std::span<const RadTriangle> triangles, const std::string& name) {
  Scene scene;
  scene.name = name;
  std::map<std::pair<float, std::uint32_t>, std::vector<std::uint32_t>> ofMaterial;
  for (const RadTriangle& t : triangles) {
    ofMaterial[{t.ro, t.e}].push_back(static_cast<std::uint32_t>(scene.vertices.size()));
    for (const auto& p : {t.p1, t.p2, t.p3}) {
      scene.vertices.push_back({{p[0], p[1], p[2]}, {}, {t.n[0], t.n[1], t.n[2]}});
      scene.bounds.add(glm::dvec3(scene.vertices.back().position));
    }
  }
  for (const auto& [key, firsts] : ofMaterial) {
    Material& material = scene.materials.emplace_back();
    material.name = fmt::format("ro {} e {}", key.first, key.second);
    material.diffuse = glm::vec3(key.first);
    material.emission = glm::vec3(static_cast<float>(key.second / std::numbers::pi));
    Mesh& mesh = scene.meshes.emplace_back();
    mesh.material = static_cast<int>(scene.materials.size()) - 1;
    mesh.firstIndex = static_cast<std::uint32_t>(scene.indices.size());
    mesh.indexCount = static_cast<std::uint32_t>(3 * firsts.size());
    for (const std::uint32_t first : firsts) scene.indices.insert(scene.indices.end(), {first, first + 1, first + 2});
  }
  return scene;
}

std::vector<RadTriangle> withReceived(std::vector<RadTriangle> triangles, const Scene& scene, const RadiosityMesh& mesh,
                                      std::span<const glm::dvec3> irradiance) {
  for (RadTriangle& triangle : triangles) triangle.b = 0;
  for (std::size_t i = 0; i < irradiance.size(); ++i) {
    // A patch has its triangle's number in the scene, whose order is by material.
    const std::size_t index = scene.indices[3 * mesh.patches[i].triangle] / 3;
    triangles[index].b =
        static_cast<std::uint32_t>(std::clamp(std::round(irradiance[i].x), 0.0, static_cast<double>(kRadMost)));
  }
  return triangles;
}

}  // namespace lucerna
