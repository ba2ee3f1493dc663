// The double-precision CPU reference implementation of the gather from a reflective shadow map (no GL): the irradiance
// that a texel's surfel sends to a point, the sum over all texels, and the sampled estimate of it.
//
// Derived from the formulas, never from the shaders. Sources: [Dachsbacher2005] for the gather; Lambert's polygon
// formula for the form factor of a surfel. Units: W, scene units; irradiance in W per square scene unit.
#pragma once

#include <glm/glm.hpp>

#include <cstddef>
#include <span>
#include <vector>

namespace lucerna::reference {

/// A map of parallel light.
struct RsmMap {
  struct Texel {
    glm::dvec3 position{0.0};
    glm::dvec3 normal{0.0, 1.0, 0.0};  ///< unit
    glm::dvec3 flux{0.0};
    double cosine = 1.0;  ///< of the light at the surface
    bool surface = false;
  };
  glm::ivec2 size{0};
  glm::dvec3 corner{0.0};  ///< where texture coordinate (0,0) lies, in any plane across the rays
  glm::dvec3 right{1.0, 0.0, 0.0}, up{0.0, 1.0, 0.0};  ///< unit, across the rays
  glm::dvec3 direction{0.0, 0.0, -1.0};  ///< unit, along which light travels
  double width = 1.0, height = 1.0;
  std::vector<Texel> texels;  ///< row by row

  double texelArea() const { return width * height / (static_cast<double>(size.x) * size.y); }
  Texel& at(int x, int y) {
    return texels[static_cast<std::size_t>(y) * static_cast<std::size_t>(size.x) + static_cast<std::size_t>(x)];
  }
  const Texel& at(int x, int y) const { return const_cast<RsmMap*>(this)->at(x, y); }
  glm::dvec2 project(const glm::dvec3& point) const;  ///< 0..1 inside
  /// Where the ray through a texel's centre starts, in the plane of `corner`.
  glm::dvec3 rayOrigin(int x, int y) const;
  /// Clip space as the GL's orthographic projection has it; depths from -range to range along the light are inside.
  glm::dmat4 clipFromWorld(double range) const;
};

enum class NearField { none, clamp, disc, quad };
struct GatherOptions {
  double radius = 0.3;  ///< fraction of the map's sides
  NearField nearField = NearField::quad;
  double minimumDistance = 0.0;  ///< NearField::clamp
  bool wholeMap = false;  ///< a point beside the map samples from the map's border
};

/// Form factor from a point at the origin with a unit normal to a polygon, cut at the point's horizon.
double polygonFormFactor(std::span<const glm::dvec3> corners, const glm::dvec3& normal);

glm::dvec3 surfelIrradiance(const RsmMap& map, const RsmMap::Texel& texel, const glm::dvec3& position,
                            const glm::dvec3& normal, const GatherOptions& options);
/// The sum over all texels.
glm::dvec3 bruteForceIrradiance(const RsmMap& map, const glm::dvec3& position, const glm::dvec3& normal,
                                const GatherOptions& options);

struct Gathered {
  glm::dvec3 irradiance{0.0};
  double boundaryDistance =
      1.0;  ///< least distance of a sample from a texel's edge, in texels: rounding may move it across
};
/// pattern: (xi1 sin, xi1 cos, weight, unused).
Gathered gather(const RsmMap& map, std::span<const glm::vec4> pattern, const glm::dvec3& position,
                const glm::dvec3& normal, double rotation, const GatherOptions& options);

}  // namespace lucerna::reference
