// Rays in GLSL against brute force in double.
#include "support/gl_fixture.hpp"
#include "support/rays_on_gl.hpp"
#include "support/small_scenes.hpp"

#include <random>

namespace lucerna {
namespace {

using namespace test;

struct RayCasterOnGl : SharedProgramsTest {};

/// The first hit by trying every triangle, in double (T. Moller, B. Trumbore, 1997).
struct Twin {
  double t = 1e300;
  std::uint32_t triangle = kNoHit;
};
Twin bruteForce(const Scene& scene, const glm::dvec3& shift, const GlRay& ray) {
  Twin best;
  const glm::dvec3 o(ray.origin), d(ray.direction);
  for (std::size_t k = 0; k < scene.triangleCount(); ++k) {
    const auto corner = [&](std::size_t i) { return glm::dvec3(scene.vertices[scene.indices[3 * k + i]].position) - shift; };
    const glm::dvec3 a = corner(0), e1 = corner(1) - a, e2 = corner(2) - a, p = glm::cross(d, e2);
    const double det = glm::dot(e1, p);
    if (!(std::abs(det) > 0.0)) continue;
    const double u = glm::dot(o - a, p) / det;
    const glm::dvec3 q = glm::cross(o - a, e1);
    const double v = glm::dot(d, q) / det, t = glm::dot(e2, q) / det;
    if (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > ray.tMin && t < ray.tMax && t < best.t) best = {t, static_cast<std::uint32_t>(k)};
  }
  return best;
}

Scene triangleSoup(int count, double size, const glm::dvec3& centre, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> in(-1.0, 1.0);
  const auto point = [&] { return glm::dvec3(in(random), in(random), in(random)); };
  SceneBuilder builder;
  const int material = builder.material(glm::vec3(0.5f));
  for (int i = 0; i < count; ++i) {
    const glm::dvec3 p = centre + point();
    builder.triangle(p, p + size * point(), p + size * point(), material);
  }
  return builder.scene();
}

TEST_F(RayCasterOnGl, MeetsWhatBruteForceMeets) {
  const Scene scene = triangleSoup(500, 0.4, glm::dvec3(0.0), 1);
  const RayScene rayScene(scene, capabilities());
  std::mt19937 random(2);
  std::uniform_real_distribution<float> in(-1.5f, 1.5f);
  std::vector<GlRay> rays(4096);
  for (GlRay& ray : rays) {
    ray.origin = glm::vec3(in(random), in(random), in(random));
    ray.direction = glm::vec3(in(random), in(random), in(random));
  }
  const std::vector<GlHit> hits = trace(library(), rayScene, rays);
  int met = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Twin twin = bruteForce(scene, rayScene.origin(), rays[i]);
    ASSERT_EQ(hits[i].triangle, twin.triangle) << i;
    if (twin.triangle == kNoHit) continue;
    const double length = glm::length(glm::dvec3(rays[i].direction));
    ++met;
    // A float coordinate of about 1 moves the point by up to 1e-7.
    EXPECT_NEAR(hits[i].t * length, twin.t * length, 1e-5 * twin.t * length + 2e-7) << i;
  }
  EXPECT_GT(met, 1000);
}

}  // namespace
}  // namespace lucerna
