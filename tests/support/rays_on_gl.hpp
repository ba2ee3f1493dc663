// Batches of rays traced by shaders/rays/bvh.glsl.
#pragma once

#include "gl/program.hpp"
#include "rays/ray_scene.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace lucerna::test {

/// As in bvh.glsl; in the space of the RayScene.
struct GlRay {
  glm::vec3 origin;
  float tMin = 0.0f;
  glm::vec3 direction;
  float tMax = 3e38f;
};
struct GlHit {
  float t;
  std::uint32_t triangle;
  glm::vec2 barycentrics;
};
inline constexpr std::uint32_t kNoHit = 0xffffffffu;

struct TraceOptions {
  bool anyHit = false;  ///< only GlHit::triangle is meant then: kNoHit or not
  bool alphaMasks = false;  ///< masked triangles have a hole where the first barycentric is below 1/2
  bool countsWork = false;  ///< nodes that were visited and triangles that were tested instead of t and barycentrics
  bool offsetOrigins = false;  ///< origins are moved by offsetRay along the directions
  std::span<const std::uint32_t> skip;  ///< a triangle a ray; empty: none
};
std::vector<GlHit> trace(gl::ProgramLibrary& programs, const RayScene& scene, std::span<const GlRay> rays,
                         const TraceOptions& options = {});

}  // namespace lucerna::test
