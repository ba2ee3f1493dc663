// Traces the same rays with Embree 3 or 4: a baseline for benchmarks and tests, never for the engine. Optional: see
// isBuilt().
#pragma once

#include "scene/scene.hpp"

#include <cstdint>
#include <memory>
#include <span>

namespace lucerna {

/// Same layout as in shaders/rays/bvh.glsl.
struct PlainRay {
  glm::vec3 origin{0.0f};
  float tMin = 0.0f;
  glm::vec3 direction{0.0f, 0.0f, 1.0f};
  float tMax = 3e38f;
};
struct PlainHit {
  float t = 0.0f;
  std::uint32_t triangle = kNone;
  glm::vec2 barycentrics{0.0f};
  static constexpr std::uint32_t kNone = 0xffffffffu;
};

class EmbreeRays {
 public:
  /// Whether this was built with Embree (LUCERNA_EMBREE); otherwise the constructor throws Error(missingCapability).
  static bool isBuilt();

  /// The scene moved by -origin. Embree's robust mode, its best build quality.
  EmbreeRays(const Scene& scene, const glm::dvec3& origin);
  ~EmbreeRays();

  /// rtcIntersect1 or rtcOccluded1, one ray after the other on all cores. anyHit: the result is only whether `triangle`
  /// is kNone.
  void trace(std::span<const PlainRay> rays, std::span<PlainHit> hits, bool anyHit) const;

 private:
  struct Handles;
  std::unique_ptr<Handles> handles_;
};

}  // namespace lucerna
