#include "radiosity/hidden_parts.hpp"

#include "base/parallel.hpp"
#include "base/stop_watch.hpp"
#include "gl/pass.hpp"
#include "scene/triangle_parts.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <span>

namespace lucerna {

namespace {

constexpr std::size_t kParts = kPatchParts * kPatchParts, kRaysEach = 8, kRaysASubmission = 1 << 16;
constexpr std::size_t kSteps = 16;  // of walks: a walk that has not hit a back by then is in the open
constexpr float kHidden = 0.3f;  // of the most open part. Of 0.1 to 0.5 Sponza's sunlight agrees best at 0.3 and 0.5
constexpr float kOpen = 0.3f;

/// Input of hidden_parts.comp.
struct TestedPatch {
  glm::vec4 a, b, c, normal;
};

void cut(Patch& patch, const RadiosityMesh& mesh, std::uint16_t hidden) {
  const std::vector<glm::dvec2> centroids = partCentroids(kPatchParts);
  const auto corners = mesh.corners(patch);
  glm::dvec2 mean(0.0);
  const double open = static_cast<double>(kParts) - std::popcount(hidden);
  for (std::size_t k = 0; k < kParts; ++k)
    if (!(hidden >> k & 1)) mean += centroids[k] / open;
  // A hemicube stands at the centre of the open parts or, if that is hidden, at the nearest open part.
  glm::dvec2 place = mean;
  if (hidden >> partAt(kPatchParts, mean) & 1) {
    double least = 1e300;
    for (std::size_t k = 0; k < kParts; ++k) {
      const glm::dvec2 away = centroids[k] - mean;
      const double distance = glm::length(away.x * (corners[1] - corners[0]) + away.y * (corners[2] - corners[0]));
      if (!(hidden >> k & 1) && distance < least) least = distance, place = centroids[k];
    }
  }
  patch.hidden = hidden;
  patch.area *= open / static_cast<double>(kParts);
  patch.centroid = corners[0] + place.x * (corners[1] - corners[0]) + place.y * (corners[2] - corners[0]);
}

}  // namespace

std::vector<PartMet> metFromParts(gl::ProgramLibrary& programs, const RayScene& rays, const RadiosityMesh& mesh,
                                  std::span<const std::uint32_t> patches, std::size_t raysEach, PatchSide side) {
  const gl::Program& program = programs.loadCompute("hidden parts", "radiosity/hidden_parts.comp",
                                                    {{"ALPHA_MASKS", 0}, {"SHARED_STACK", rays.sharedStack()}});
  std::vector<PartMet> seen;
  seen.reserve(patches.size() * kParts * raysEach);
  const std::size_t patchesEach = kRaysASubmission / (kParts * raysEach);
  for (std::size_t first = 0; first < patches.size(); first += patchesEach) {
    StopWatch::check("looking for hidden parts of patches", first, patches.size());
    std::vector<TestedPatch> tested;
    for (const std::uint32_t p : patches.subspan(first, std::min(patchesEach, patches.size() - first))) {
      auto corners = mesh.corners(mesh.patches[p]);
      glm::dvec3 largest(0.0);
      for (glm::dvec3& corner : corners) corner -= rays.origin(), largest = glm::max(largest, glm::abs(corner));
      tested.push_back({glm::vec4(glm::vec3(corners[0]), static_cast<float>(p)), glm::vec4(glm::vec3(corners[1]), 0.0f),
                        glm::vec4(glm::vec3(corners[2]), 0.0f),
                        glm::vec4(glm::vec3(mesh.patches[p].faceNormal) * (side == PatchSide::front ? 1.0f : -1.0f),
                                  static_cast<float>(std::max({largest.x, largest.y, largest.z})))});
    }
    const std::size_t rayCount = tested.size() * kParts * raysEach;
    const gl::Buffer in("hidden parts patches", tested.size() * sizeof(TestedPatch), tested.data(),
                        gl::Usage::streamDraw);
    const gl::Buffer out("hidden parts seen", rayCount * sizeof(GLuint), nullptr, gl::Usage::dynamicRead);
    {
      const gl::ComputePass pass("hidden parts");
      program.use();
      program.set("testedCount", static_cast<int>(tested.size()));
      program.set("raysEach", static_cast<int>(raysEach));
      rays.bind();
      in.bindStorage(1);
      out.bindStorage(2);
      pass.dispatch({static_cast<int>(rayCount), 1, 1}, {64, 1, 1});
    }
    for (const GLuint bits : out.read<GLuint>()) seen.emplace_back(bits);
  }
  return seen;
}

std::vector<float> opennessOfParts(gl::ProgramLibrary& programs, const RayScene& rays, const RadiosityMesh& mesh) {
  std::vector<float> open(mesh.patches.size() * kParts, 1.0f), next = open;
  // One ray per part finds the patches that may have hidden parts; most scenes have none.
  std::vector<std::uint32_t> suspects(mesh.patches.size());
  std::iota(suspects.begin(), suspects.end(), 0u);
  {
    const std::vector<PartMet> seen = metFromParts(programs, rays, mesh, suspects, 1, PatchSide::front);
    std::erase_if(suspects, [&](std::uint32_t p) {
      return std::ranges::none_of(std::span(seen).subspan(kParts * p, kParts), &PartMet::isBack);
    });
  }
  if (suspects.empty()) return open;
  const std::vector<PartMet> seen = metFromParts(programs, rays, mesh, suspects, kRaysEach, PatchSide::front);
  for (std::size_t step = 0; step < kSteps; ++step) {
    onAllCores(suspects.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t s = begin; s < end; ++s)
        for (std::size_t part = 0; part < kParts; ++part) {
          const auto met = std::span(seen).subspan((s * kParts + part) * kRaysEach, kRaysEach);
          float sum = 0.0f;
          for (const PartMet one : met)
            sum += one.isNothing() ? static_cast<float>(kRaysEach) : one.isBack() ? 0.0f : open[one.place()];
          next[suspects[s] * kParts + part] = std::min(sum / static_cast<float>(kRaysEach), 1.0f);
        }
    });
    std::swap(open, next);
  }
  return open;
}

std::uint16_t hiddenOf(std::span<const float> openness, float mostOpen) {
  std::uint16_t hidden = 0;
  if (mostOpen < kOpen) return hidden;
  for (std::size_t part = 0; part < openness.size(); ++part)
    if (openness[part] < kHidden * mostOpen) hidden = static_cast<std::uint16_t>(hidden | 1u << part);
  return hidden;
}

double cutHiddenParts(gl::ProgramLibrary& programs, const RayScene& rays, RadiosityMesh& mesh) {
  const std::vector<float> open = opennessOfParts(programs, rays, mesh);
  double area = 0.0;
  for (std::size_t p = 0; p < mesh.patches.size(); ++p) {
    const auto parts = std::span(open).subspan(p * kParts, kParts);
    const std::uint16_t hidden = hiddenOf(parts, std::ranges::max(parts));
    const double before = mesh.patches[p].area;
    if (hidden) cut(mesh.patches[p], mesh, hidden);
    area += before - mesh.patches[p].area;
  }
  return area;
}

}  // namespace lucerna
