#include "walk/hemicube_view.hpp"

#include "base/angles.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace lucerna::demo {

namespace {

constexpr int kGap = 4;  // texels between the two pictures

/// As in shaders/walk/compose.frag.
glm::vec3 heatOf(float t) { return glm::clamp(glm::vec3(3.0f * t, 3.0f * t - 1.0f, 3.0f * t - 2.0f), 0.0f, 1.0f); }

/// The place of a face's pixel where the five faces are unfolded about the full one, in texels from the lower left; the
/// layout of shaders/radiosity/hemicube.glsl. Half faces end with their horizon at the picture's edge.
glm::ivec2 unfolded(int face, int column, int row, int n) {
  const int half = n / 2;
  switch (face) {
    case 0: return {half + column, half + row};
    case 1: return {2 * n - 1 - row, half + column};
    case 2: return {half + n - 1 - column, 2 * n - 1 - row};
    case 3: return {row, half + n - 1 - column};
    default: return {half + column, row};
  }
}

/// A patch's exitance on the screen, a little brighter or darker than that of its neighbours.
glm::vec3 colourOf(const glm::dvec3& exitance, std::uint32_t patch, float exposure) {
  const double shade = 0.85 + 0.3 * static_cast<double>(patch * 2654435761u >> 24) / 255.0;
  const glm::dvec3 light = shade * static_cast<double>(exposure) / kPi * exitance;
  return {glm::pow(1.0 - glm::exp(-light), glm::dvec3(1.0 / 2.2))};
}

}  // namespace

HemicubeView::HemicubeView(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene,
                           const RadiositySolution& solution, const RadiositySolutionSettings& settings,
                           std::uint32_t patch, float exposure)
    : patch_(patch) {
  const HemicubePixels hemicube = hemicubeOf(context, programs, scene, solution, settings, patch);
  const int n = hemicube.resolution, width = 4 * n + kGap;
  const glm::vec3 outside(0.08f), nothing(0.05f, 0.06f, 0.16f), back(0.35f, 0.0f, 0.3f);
  std::vector<glm::vec4> texels(static_cast<std::size_t>(width * 2 * n), glm::vec4(outside, 1.0f));
  const auto put = [&](const glm::ivec2& place, int shift, const glm::vec3& colour) {
    texels[static_cast<std::size_t>(place.y * width + place.x + shift)] = glm::vec4(colour, 1.0f);
  };
  const Patch& own = solution.mesh.patches[patch];
  const double most = *std::ranges::max_element(hemicube.weights);
  double open = 0.0, backs = 0.0;
  std::size_t pixel = 0;
  for (int face = 0; face < 5; ++face)
    for (int row = 0; row < (face == 0 ? n : n / 2); ++row)
      for (int column = 0; column < n; ++column, ++pixel) {
        const std::size_t inMap =
            face == 0 ? pixel : static_cast<std::size_t>(n * n) + static_cast<std::size_t>(row * n + column);
        const double weight = hemicube.weights[inMap];
        const std::uint32_t seen = hemicube.seen[pixel];
        glm::vec3 colour = nothing;
        if (seen > 0) {
          const Patch& other = solution.mesh.patches[seen - 1];
          const bool isFront = glm::dot(own.centroid - other.centroid, other.faceNormal) > 0.0;
          colour = isFront ? colourOf(solution.exitance[seen - 1], seen - 1, exposure) : back;
          (isFront ? seen_ : backs) += weight;
        } else {
          open += weight;
        }
        const glm::ivec2 place = unfolded(face, column, row, n);
        put(place, 0, colour);
        put(place, 2 * n + kGap, seen > 0 ? heatOf(static_cast<float>(weight / most)) : nothing);
      }
  picture_ = gl::Texture("hemicube", gl::Format::rgba32f, {width, 2 * n});
  picture_.upload(gl::Texels::rgbaFloat, texels.data());
  lines_ = {
      fmt::format("hemicube of patch {}, {} pixels a side, by {}", patch, n, nameOf(hemicube.visibility)),
      "left: patches by their exitance, backs purple", fmt::format("right: weights of pixels, white {:.2e}", most),
      fmt::format("fronts {:.2f} %, backs {:.2f} %, nothing {:.2f} %", 100.0 * seen_, 100.0 * backs, 100.0 * open)};
}

std::optional<std::uint32_t> patchAt(const RadiosityMesh& mesh, const Camera& camera, glm::ivec2 pixel,
                                     glm::ivec2 size) {
  const glm::dvec3 right = glm::normalize(glm::cross(camera.direction, camera.up)),
                   up = glm::cross(right, camera.direction);
  const double side = 2.0 * camera.halfHeight() / size.y;
  const glm::dvec3 across = side * ((pixel.x + 0.5 - 0.5 * size.x) * right - (pixel.y + 0.5 - 0.5 * size.y) * up);
  const bool isParallel = camera.isOrthographic();
  const glm::dvec3 origin = camera.position + (isParallel ? across : glm::dvec3(0.0)),
                   direction = camera.direction + (isParallel ? glm::dvec3(0.0) : across);
  std::optional<std::uint32_t> nearest;
  double least = 1e300;
  for (std::uint32_t p = 0; p < mesh.patches.size(); ++p) {
    const Patch& patch = mesh.patches[p];
    const double towards = glm::dot(direction, patch.faceNormal);
    if (towards >= 0.0) continue;
    const auto c = mesh.corners(patch);
    const double t = glm::dot(c[0] - origin, patch.faceNormal) / towards;
    if (t <= 0.0 || t >= least) continue;
    const glm::dvec3 at = origin + t * direction;
    bool isInside = true;
    for (std::size_t k = 0; k < 3; ++k)
      isInside = isInside && glm::dot(glm::cross(c[(k + 1) % 3] - c[k], at - c[k]), patch.faceNormal) >= 0.0;
    if (!isInside) continue;
    least = t;
    nearest = p;
  }
  return nearest;
}

}  // namespace lucerna::demo
