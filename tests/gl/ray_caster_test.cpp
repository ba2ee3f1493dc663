// Rays in GLSL against brute force in double, and against Embree where it is there.
#include "bench/embree_rays.hpp"
#include "support/gl_fixture.hpp"
#include "support/rays_on_gl.hpp"
#include "support/small_scenes.hpp"

#include <cmath>
#include <filesystem>
#include <iostream>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <random>
#include <vector>

namespace lucerna {
namespace {

using namespace test;

struct RayCasterOnGl : SharedProgramsTest {};

/// The first hit by trying every triangle, in double (T. Moller, B. Trumbore, 1997).
struct Reference {
  double t = 1e300;
  std::uint32_t triangle = kNoHit;
};
Reference bruteForce(const Scene& scene, const glm::dvec3& shift, const GlRay& ray) {
  Reference best;
  const glm::dvec3 o(ray.origin), d(ray.direction);
  for (std::size_t k = 0; k < scene.triangleCount(); ++k) {
    const auto corner = [&](std::size_t i) {
      return glm::dvec3(scene.vertices[scene.indices[3 * k + i]].position) - shift;
    };
    const glm::dvec3 a = corner(0), e1 = corner(1) - a, e2 = corner(2) - a, p = glm::cross(d, e2);
    const double det = glm::dot(e1, p);
    if (!(std::abs(det) > 0.0)) continue;
    const double u = glm::dot(o - a, p) / det;
    const glm::dvec3 q = glm::cross(o - a, e1);
    const double v = glm::dot(d, q) / det, t = glm::dot(e2, q) / det;
    if (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > ray.tMin && t < ray.tMax && t < best.t)
      best = {t, static_cast<std::uint32_t>(k)};
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

std::vector<GlRay> randomRays(std::size_t count, const glm::dvec3& centre, const glm::dvec3& extent, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> in(-1.0, 1.0);
  std::vector<GlRay> rays(count);
  for (GlRay& ray : rays) {
    ray.origin = centre + extent * glm::dvec3(in(random), in(random), in(random));
    ray.direction = glm::vec3(in(random), in(random), in(random));
  }
  return rays;
}

/// Where a ray meets the plane of a triangle, in double, and how far inside of the nearest edge it passes (below zero:
/// outside), as seen along it.
struct Meeting {
  double t, inside, cosine;
};
Meeting handleHit(const Scene& scene, const glm::dvec3& shift, const GlRay& ray, std::uint32_t triangle) {
  const glm::dvec3 d(ray.direction), unit = glm::normalize(d);
  const auto corner = [&](std::size_t k) {
    return glm::dvec3(scene.vertices[scene.indices[3 * triangle + k]].position) - shift - glm::dvec3(ray.origin);
  };
  const glm::dvec3 corners[] = {corner(0), corner(1), corner(2)};
  const glm::dvec3 n = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
  const double along = glm::dot(n, unit);
  Meeting m{glm::dot(n, corners[0]) / glm::dot(n, d), 1e300, std::abs(along) / glm::length(n)};
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::dvec3 &p = corners[k], &q = corners[(k + 1) % 3];
    const double length = glm::length(glm::cross(q - p, unit)), side = glm::dot(unit, glm::cross(p, q));
    m.inside = std::min(m.inside, length > 0.0 ? std::copysign(side, side * along) / length : 0.0);
  }
  return m;
}

/// What another tracer says is judged in double. Where the two differ by more than rounding, the nearer one is right if
/// its ray passes clearly through the triangle, and within rounding of an edge either is.
struct Verdict {
  std::size_t met = 0, atEdges = 0, wrong = 0, theirs = 0;
};
template <class Other>
Verdict compare(const Scene& scene, const RayScene& rayScene, const std::vector<GlRay>& rays,
                const std::vector<GlHit>& ours, const std::vector<Other>& others) {
  Verdict verdict;
  double magnitude = 0.0;
  for (const Vertex& v : scene.vertices)
    for (int k = 0; k < 3; ++k)
      magnitude = std::max(magnitude, std::abs(static_cast<double>(v.position[k]) - rayScene.origin()[k]));
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const bool us = ours[i].triangle != kNoHit, them = others[i].triangle != kNoHit;
    verdict.met += us;
    if (!us && !them) continue;
    const double length = glm::length(glm::dvec3(rays[i].direction));
    const double tUs = us ? static_cast<double>(ours[i].t) * length : 1e300,
                 tThem = them ? static_cast<double>(others[i].t) * length : 1e300;
    const auto m = us ? handleHit(scene, rayScene.origin(), rays[i], ours[i].triangle) : Meeting{};
    // Corners and origin are exact; what is computed from them is off by some units in the last place of the largest of
    // them.
    const double rounding = 16.0 * 0x1p-24 * (magnitude + static_cast<double>(glm::length(rays[i].origin)));
    if (us &&
        (std::abs(tUs - m.t * length) > 1e-5 * tUs + rounding / std::max(m.cosine, 1e-9) || m.inside < -rounding)) {
      ++verdict.wrong;  // our distance, or what we hit, is not so
      continue;
    }
    if (us && them && std::abs(tUs - tThem) <= 1e-5 * tThem + rounding / std::max(m.cosine, 1e-9)) continue;
    const auto nearest =
        handleHit(scene, rayScene.origin(), rays[i], tUs < tThem ? ours[i].triangle : others[i].triangle);
    if (nearest.inside <= rounding || std::abs(nearest.t) * length <= rounding) ++verdict.atEdges;
    else ++(tUs < tThem ? verdict.theirs : verdict.wrong);
  }
  return verdict;
}

TEST_F(RayCasterOnGl, MeetsWhatBruteForceMeets) {
  for (const double scale : {1.0, 1e-6, 1e6})
    for (const double far : {0.0, 1e4}) {
      const glm::dvec3 centre = scale * far * glm::dvec3(1.0, -1.0, 0.5);
      Scene scene = triangleSoup(300, 0.4, centre / scale, 1);
      for (Vertex& v : scene.vertices) v.position *= static_cast<float>(scale);
      const RayScene rayScene(scene, capabilities());
      const std::vector<GlRay> rays = randomRays(4096, centre - rayScene.origin(), glm::dvec3(1.5 * scale), 2);
      const std::vector<GlHit> hits = trace(library(), rayScene, rays);
      std::vector<GlHit> expectedHits;
      for (const GlRay& ray : rays) {
        const Reference expected = bruteForce(scene, rayScene.origin(), ray);
        expectedHits.push_back({static_cast<float>(expected.t), expected.triangle, glm::vec2(0.0f)});
      }
      const Verdict v = compare(scene, rayScene, rays, hits, expectedHits);
      EXPECT_GT(v.met, 1000u) << scale << ", " << far;
      EXPECT_EQ(v.wrong + v.theirs, 0u) << scale << ", " << far;
      EXPECT_LE(v.atEdges, 2u) << scale << ", " << far;
    }
}

TEST_F(RayCasterOnGl, KeepsIntervalsSkipsMasksAndAnswersAny) {
  SceneBuilder builder;
  const int solid = builder.material(glm::vec3(0.5f)), masked = builder.material(glm::vec3(0.5f));
  builder.materialAt(masked).alphaMasked = true;
  for (int i = 0; i < 3; ++i) {
    const double z = i + 1.0;
    builder.triangle({-1, -1, z}, {3, -1, z}, {-1, 3, z}, i == 0 ? masked : solid);
  }
  const RayScene rayScene(builder.scene(), capabilities());
  // The first barycentric is 1/2 at x = 1: the mask is cut out left of that.
  const auto ray = [&](float x, float tMin, float tMax) {
    return GlRay{glm::vec3(x, 0, 0) - glm::vec3(rayScene.origin()), tMin, glm::vec3(0, 0, 1), tMax};
  };
  const std::vector<GlRay> rays{ray(0, 0, 10), ray(1.5f, 0, 10), ray(0, 1.5f, 10), ray(0, 2.5f, 2.9f),
                                ray(0, 2, 10), ray(0, 0, 10),    ray(5, 0, 10)};
  const std::vector<std::uint32_t> skip{kNoHit, kNoHit, kNoHit, kNoHit, kNoHit, 0, kNoHit};
  const auto triangles = [&](const TraceOptions& options) {
    std::vector<std::uint32_t> result;
    for (const GlHit& hit : trace(library(), rayScene, rays, options)) result.push_back(hit.triangle);
    return result;
  };
  EXPECT_EQ(triangles({.anyHit = false, .alphaMasks = false, .offsetOrigins = false, .skip = skip}),
            (std::vector<std::uint32_t>{0, 0, 1, kNoHit, 2, 1, kNoHit}));
  EXPECT_EQ(triangles({.anyHit = false, .alphaMasks = true, .offsetOrigins = false, .skip = skip}),
            (std::vector<std::uint32_t>{1, 0, 1, kNoHit, 2, 1, kNoHit}));
  EXPECT_EQ(triangles({.anyHit = true, .alphaMasks = false, .offsetOrigins = false, .skip = skip}),
            (std::vector<std::uint32_t>{0, 0, 0, kNoHit, 0, 0, kNoHit}));
  const GlHit hit = trace(library(), rayScene, std::span(rays).first(1))[0];
  EXPECT_NEAR(hit.t, 1.0f, 1e-6f);
  EXPECT_NEAR(hit.barycentrics.x, 0.25f, 1e-6f);
  EXPECT_NEAR(hit.barycentrics.y, 0.25f, 1e-6f);
}

// Distances are compared as integers, which order no NaN, and negative ones the other way round.
TEST_F(RayCasterOnGl, DirectionsHaveAnyLengthAndIntervalsBeginBehindTheOrigin) {
  const Scene scene = triangleSoup(300, 0.4, glm::dvec3(0.0), 6);
  const RayScene rayScene(scene, capabilities());
  for (const float tMin : {0.0f, -0.7f, -3.0f}) {
    std::vector<GlRay> rays = randomRays(4096, -rayScene.origin(), glm::dvec3(0.5), 7);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      rays[i].tMin = tMin;
      if (i % 2) rays[i].direction[static_cast<glm::length_t>(i / 2 % 3)] = 0.0f;  // in the plane of two axes
    }
    const std::vector<GlHit> hits = trace(library(), rayScene, rays);
    std::vector<GlHit> expected;
    for (const GlRay& ray : rays) {
      const Reference first = bruteForce(scene, rayScene.origin(), ray);
      expected.push_back({static_cast<float>(first.t), first.triangle, glm::vec2(0.0f)});
    }
    std::size_t wrong = 0, met = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      met += hits[i].triangle != kNoHit;
      wrong += hits[i].triangle != expected[i].triangle;
    }
    EXPECT_GT(met, 2000u) << tMin;
    EXPECT_LE(wrong, 2u) << tMin;  // at edges
    for (const int exponent : {-110, -70, -30, 30, 70, 110}) {
      std::vector<GlRay> other = rays;
      for (GlRay& ray : other) {
        ray.direction *= std::ldexp(1.0f, exponent);
        ray.tMin *= std::ldexp(1.0f, -exponent);
      }
      const std::vector<GlHit> same = trace(library(), rayScene, other);
      wrong = 0;
      for (std::size_t i = 0; i < rays.size(); ++i)
        wrong += same[i].triangle != hits[i].triangle ||
                 (hits[i].triangle != kNoHit && same[i].t != std::ldexp(hits[i].t, -exponent));
      EXPECT_EQ(wrong, 0u) << tMin << ", 2^" << exponent;
    }
  }
}

TEST_F(RayCasterOnGl, TracesNothingOneAndTheDegenerate) {
  const std::vector<GlRay> rays = randomRays(256, glm::dvec3(0.0), glm::dvec3(1.0), 3);
  SceneBuilder empty;
  for (const GlHit& hit : trace(library(), RayScene(empty.scene(), capabilities()), rays))
    EXPECT_EQ(hit.triangle, kNoHit);
  SceneBuilder builder;
  const int material = builder.material(glm::vec3(0.5f));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  builder.triangle({nan, 0, 0}, {1, 0, 0}, {0, 1, 0}, material);
  builder.triangle({-9, -9, 0}, {9, -9, 0}, {0, 9, 0}, material);
  builder.triangle({-1, 0, 0}, {0, 0, 0}, {1, 0, 0}, material);
  const RayScene one(builder.scene(), capabilities());
  EXPECT_EQ(one.statistics().degenerate, 2u);
  int met = 0;
  const std::vector<GlHit> hits = trace(library(), one, rays);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Reference expected = bruteForce(builder.scene(), one.origin(), rays[i]);
    EXPECT_EQ(hits[i].triangle, expected.triangle);
    met += hits[i].triangle == 1u;
  }
  EXPECT_GT(met, 50);
}

// On GPUs min and max drop NaN, and such a ray would visit every node.
TEST_F(RayCasterOnGl, WhatIsNoRayVisitsNothing) {
  const Scene scene = triangleSoup(2000, 0.1, glm::dvec3(0.0), 5);
  const RayScene rayScene(scene, capabilities());
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();
  const GlRay sound{{0.1f, 0.2f, 3.0f}, 0.0f, {0.0f, 0.0f, -1.0f}, 3e38f};
  std::vector<GlRay> rays;
  for (const float wrong : {kNan, -kNan, kInfinity, -kInfinity})
    for (int axis = 0; axis < 3; ++axis) {
      rays.insert(rays.end(), 2, sound);
      rays[rays.size() - 2].origin[axis] = wrong;
      rays[rays.size() - 1].direction[axis] = wrong;
    }
  rays.insert(rays.end(), 3, sound);
  rays[rays.size() - 3].tMin = kNan;
  rays[rays.size() - 2].tMax = kNan;
  rays[rays.size() - 1].direction = glm::vec3(0.0f);
  TraceOptions counting;
  counting.countsWork = true;
  for (const bool anyHit : {false, true}) {
    counting.anyHit = anyHit;
    for (const GlHit& hit : trace(library(), rayScene, rays, counting)) {
      EXPECT_EQ(hit.triangle, kNoHit);
      EXPECT_EQ(hit.t, 0.0f) << "nodes";
      EXPECT_EQ(hit.barycentrics.x, 0.0f) << "triangles";
    }
    for (const GlHit& hit : trace(library(), rayScene, std::vector<GlRay>{sound}, counting)) EXPECT_GT(hit.t, 3.0f);
  }
}

TEST_F(RayCasterOnGl, MeetsTheGiantAndTheTinyTheSliverAndTheDuplicate) {
  SceneBuilder builder;
  const int material = builder.material(glm::vec3(0.5f));
  builder.triangle({-1e6, -1e6, -1e3}, {1e6, -1e6, -1e3}, {0, 1e6, -1e3}, material);
  for (int i = 0; i < 64; ++i) {
    const double x = 1e-3 * (i % 8) - 4e-3, y = 1e-3 * (i / 8) - 4e-3;
    builder.triangle({x, y, 0}, {x + 5e-4, y, 0}, {x, y + 5e-4, 1e-4}, material);
    builder.triangle({x, y, 0}, {x + 5e-4, y, 0}, {x, y + 5e-4, 1e-4}, material);  // the same again
  }
  for (int i = 0; i < 50; ++i) builder.triangle({-1, i * 0.01, 1}, {1, i * 0.01, 1}, {1, i * 0.01 + 1e-6, 1}, material);
  const Scene& scene = builder.scene();
  const RayScene rayScene(scene, capabilities());
  std::vector<GlRay> rays = randomRays(4096, glm::dvec3(0.0, 0.0, 2e-3), glm::dvec3(5e-3, 5e-3, 1e-3), 4);
  for (GlRay& ray : rays) ray.direction = glm::vec3(0.1f * ray.direction.x, 0.1f * ray.direction.y, -1.0f);
  for (int i = 0; i < 1000; ++i)
    rays.push_back({glm::vec3(0.001f * static_cast<float>(i) - 0.5f, 0.25f + 2.5e-7f, 2), 0.0f, glm::vec3(0, 0, -1)});
  const std::vector<GlHit> hits = trace(library(), rayScene, rays);
  std::vector<GlHit> expectedHits;
  for (const GlRay& ray : rays) {
    const Reference expected = bruteForce(scene, rayScene.origin(), ray);
    expectedHits.push_back({static_cast<float>(expected.t), expected.triangle, glm::vec2(0.0f)});
  }
  std::size_t wrong = 0, tiny = 0, slivers = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    tiny += hits[i].triangle >= 1 && hits[i].triangle < 129;
    slivers += hits[i].triangle >= 129 && hits[i].triangle != kNoHit;
    const bool same = hits[i].triangle == expectedHits[i].triangle ||
                      std::abs(hits[i].t - expectedHits[i].t) <= 1e-5f * expectedHits[i].t;
    const std::uint32_t nearer = hits[i].t < expectedHits[i].t ? hits[i].triangle : expectedHits[i].triangle;
    wrong += !same && std::abs(handleHit(scene, rayScene.origin(), rays[i], nearer).inside) > 3e-7;
  }
  EXPECT_EQ(wrong, 0u);
  EXPECT_GT(tiny, 250u);
  EXPECT_GT(slivers, 300u);
}

// Slivers a 2^-16 of their length wide, at scales whose squares and cubes leave the range of floats: edge functions in
// float are off by 1e-3 or so there.
TEST_F(RayCasterOnGl, MeetsSliversWhereDoubleArithmeticDoes) {
  for (const double scale : {1.0, 1e-13, 1e13}) {
    SceneBuilder builder;
    const int material = builder.material(glm::vec3(0.5f));
    std::mt19937 random(11);
    std::uniform_real_distribution<double> in(-1.0, 1.0);
    const auto point = [&] { return glm::dvec3(in(random), in(random), in(random)); };
    std::vector<glm::dvec3> aims;
    for (int i = 0; i < 500; ++i) {
      const glm::dvec3 a = 4.0 * point(), along = point(), across = 0x1p-16 * point();
      builder.triangle(scale * a, scale * (a + along), scale * (a + 0.3 * along + across), material);
      aims.push_back(a + 0.31 * along + 0.4 * across);
    }
    const Scene& scene = builder.scene();
    const RayScene rayScene(scene, capabilities());
    std::vector<GlRay> rays;
    for (std::size_t i = 0; i < 40 * aims.size(); ++i) {
      const glm::dvec3 origin = scale * 4.0 * point();
      const glm::vec3 o = glm::vec3(origin - rayScene.origin());
      const glm::dvec3 to = scale * (aims[i % aims.size()] + 2e-6 * point()) - rayScene.origin();
      rays.push_back({o, 0.0f, glm::vec3((to - glm::dvec3(o)) * std::pow(10.0, 3.0 * in(random)))});
    }
    const std::vector<GlHit> hits = trace(library(), rayScene, rays);
    double worst = 0.0, worstWeight = 0.0;
    int met = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      if (hits[i].triangle == kNoHit) continue;
      ++met;
      const glm::dvec3 o(rays[i].origin), d(rays[i].direction);
      const auto corner = [&](std::size_t k) {
        return glm::dvec3(scene.vertices[scene.indices[3 * hits[i].triangle + k]].position) - rayScene.origin() - o;
      };
      const glm::dvec3 a = corner(0), e1 = corner(1) - a, e2 = corner(2) - a, n = glm::cross(e1, e2),
                       m = glm::cross(d, a);
      const double facing = glm::dot(n, d);
      if (std::abs(facing) < 0.05 * glm::length(n) * glm::length(d)) continue;  // grazing: both are off
      worst = std::max(worst, std::abs(hits[i].t / (glm::dot(n, a) / facing) - 1.0));
      const glm::dvec2 weights = glm::clamp(glm::dvec2(-glm::dot(e2, m), glm::dot(e1, m)) / facing, 0.0, 1.0);
      worstWeight = std::max(
          {worstWeight, std::abs(hits[i].barycentrics.x - weights.x), std::abs(hits[i].barycentrics.y - weights.y)});
    }
    EXPECT_GT(met, 1000) << scale;
    EXPECT_LT(worst, 0x1p-22) << scale;
    EXPECT_LT(worstWeight, 0x1p-22) << scale;
    std::cout << "scale " << scale << ": " << met << " met, distance off by " << worst << " of it, weights by "
              << worstWeight << '\n';
  }
}

TEST_F(RayCasterOnGl, OutlivesFansAndNestedBoxes) {
  // A hundred thousand triangles about one corner: all boxes overlap there.
  SceneBuilder fan, nested;
  const int material = fan.material(glm::vec3(0.5f));
  constexpr int kFan = 100000;
  const auto rim = [](int i) {
    const double angle = 2.0 * std::numbers::pi * i / kFan;
    return glm::dvec3(std::cos(angle), std::sin(angle), 0.3 * std::sin(20.0 * angle));
  };
  for (int i = 0; i < kFan; ++i) fan.triangle({0, 0, 0}, rim(i), rim((i + 1) % kFan), material);
  nested.material(glm::vec3(0.5f));
  for (int i = 0; i < 1000; ++i) {  // not smaller than what a float ray can aim at
    const double s = std::pow(0.99, i);
    nested.triangle({s, 0, 0}, {0, s, 0}, {0, 0, s}, 0);
    nested.triangle({-s, 0, 0}, {0, -s, 0}, {0, 0, -s}, 0);
  }
  for (const Scene* scene : {&fan.scene(), &nested.scene()}) {
    const RayScene rayScene(*scene, capabilities());
    EXPECT_LE(rayScene.statistics().depth, BVH_MAX_DEPTH);
    std::vector<GlRay> rays = randomRays(200, glm::dvec3(0.0), glm::dvec3(1.0), 5);
    for (GlRay& ray : rays)
      if (&ray - rays.data() < 100) ray.direction = -ray.origin * 2.0f;  // through the middle
    const std::vector<GlHit> hits = trace(library(), rayScene, rays);
    std::vector<GlHit> expectedHits;
    for (const GlRay& ray : rays) {
      const Reference expected = bruteForce(*scene, rayScene.origin(), ray);
      expectedHits.push_back({static_cast<float>(expected.t), expected.triangle, glm::vec2(0.0f)});
    }
    const Verdict v = compare(*scene, rayScene, rays, hits, expectedHits);
    EXPECT_EQ(v.wrong, 0u);
    EXPECT_GT(v.met, 30u);
  }
}

/// A closed ball with bumps, of 4^levels * 8 triangles.
Scene bumpyBall(int levels, const glm::dvec3& centre) {
  Scene scene;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
  std::vector<glm::dvec3> points{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  std::vector<std::uint32_t> indices{0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
  for (int level = 0; level < levels; ++level) {
    std::vector<std::uint32_t> finer;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [it, isNew] = middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(points.size()));
      if (isNew) points.push_back(glm::normalize(points[a] + points[b]));
      return it->second;
    };
    for (std::size_t t = 0; t < indices.size(); t += 3) {
      const std::uint32_t a = indices[t], b = indices[t + 1], c = indices[t + 2], ab = middle(a, b), bc = middle(b, c),
                          ca = middle(c, a);
      finer.insert(finer.end(), {a, ab, ca, b, bc, ab, c, ca, bc, ab, bc, ca});
    }
    indices = finer;
  }
  for (const glm::dvec3& p : points) {
    Vertex v;
    v.position = centre + p * (1.0 + 0.1 * std::sin(9.0 * p.x) * std::sin(8.0 * p.y) * std::sin(7.0 * p.z));
    scene.vertices.push_back(v);
  }
  scene.indices = indices;
  scene.materials.emplace_back();
  Mesh ball;
  ball.indexCount = static_cast<std::uint32_t>(indices.size());
  scene.meshes.push_back(ball);
  return scene;
}

TEST_F(RayCasterOnGl, LetsNothingOutOfAClosedMesh) {
  for (const glm::dvec3& centre : {glm::dvec3(0.0), glm::dvec3(1e4, 1e4, 1e4)}) {
    const Scene scene = bumpyBall(6, centre);
    const RayScene rayScene(scene, capabilities());
    const glm::dvec3 middle = centre - rayScene.origin();
    constexpr std::size_t kRays = 40000;
    std::vector<GlRay> rays = randomRays(3 * kRays, middle, glm::dvec3(0.4), 6);
    std::mt19937 random(7);
    for (std::size_t i = 0; i < 2 * kRays; ++i) {  // at corners, at the middles of edges
      const std::size_t t = random() % scene.triangleCount();
      const auto corner = [&](std::size_t k) {
        return glm::vec3(glm::dvec3(scene.vertices[scene.indices[3 * t + k]].position) - rayScene.origin());
      };
      rays[i].direction = (i % 2 ? corner(0) : 0.5f * corner(0) + 0.5f * corner(1)) - rays[i].origin;
    }
    std::size_t out = 0;
    for (const GlHit& hit : trace(library(), rayScene, rays)) out += hit.triangle == kNoHit;
    EXPECT_EQ(out, 0u) << centre.x;
  }
}

TEST_F(RayCasterOnGl, OffsetsAreOfTheScenesOwnScale) {
  for (const double scale : {1e-6, 1.0, 1e6}) {
    // Points of a ball, rounded to float; rays outwards meet its surface only where rounding left the point inside.
    Scene scene = bumpyBall(4, glm::dvec3(0.0));
    for (Vertex& v : scene.vertices) v.position = glm::vec3(scale * glm::normalize(glm::dvec3(v.position)));
    const RayScene rayScene(scene, capabilities());
    std::mt19937 random(11);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    std::vector<GlRay> rays(20000);
    for (GlRay& ray : rays) {
      const std::size_t t = random() % scene.triangleCount();
      const auto corner = [&](std::size_t k) { return glm::dvec3(scene.vertices[scene.indices[3 * t + k]].position); };
      const double u = std::sqrt(unit(random)), v = unit(random);
      ray.origin = (1.0 - u) * corner(0) + u * (1.0 - v) * corner(1) + u * v * corner(2);
      const glm::dvec3 normal = glm::normalize(glm::cross(corner(1) - corner(0), corner(2) - corner(0)));
      ray.direction = glm::dot(normal, corner(0)) > 0.0 ? normal : -normal;
    }
    const auto met = [&](bool offset) {
      std::size_t n = 0;
      for (const GlHit& hit :
           trace(library(), rayScene, rays, {.anyHit = true, .alphaMasks = false, .offsetOrigins = offset, .skip = {}}))
        n += hit.triangle != kNoHit;
      return n;
    };
    EXPECT_GT(met(false), 2000u) << scale;
    EXPECT_EQ(met(true), 0u) << scale;
    // And not so far that a wall a ten thousandth of the ball away is passed.
    for (GlRay& ray : rays) ray.origin -= 1e-4f * static_cast<float>(scale) * ray.direction;
    EXPECT_EQ(met(true), rays.size()) << scale;
  }
}

TEST_F(RayCasterOnGl, FollowsWhatMoves) {
  Scene scene = triangleSoup(1000, 0.2, glm::dvec3(0.0), 8);
  RayScene::Settings settings;
  settings.moves = true;
  RayScene moved(scene, capabilities(), settings);
  const auto check = [&] {
    std::vector<std::size_t> meshes(scene.meshes.size());
    std::iota(meshes.begin(), meshes.end(), std::size_t{0});
    moved.update(scene, meshes);
    const RayScene built(scene, capabilities());
    EXPECT_EQ(moved.origin(), built.origin());
    const std::vector<GlRay> rays = randomRays(8192, -built.origin(), glm::dvec3(1.5), 9);
    const std::vector<GlHit> a = trace(library(), moved, rays), b = trace(library(), built, rays);
    std::size_t differ = 0, met = 0;
    for (std::size_t i = 0; i < rays.size(); ++i)
      differ += a[i].triangle != b[i].triangle || a[i].t != b[i].t, met += b[i].triangle != kNoHit;
    EXPECT_EQ(differ, 0u);
    EXPECT_GT(met, 2000u);
  };
  for (Vertex& v : scene.vertices) v.position = glm::vec3(v.position.y, v.position.x * 1.3f, -0.7f * v.position.z);
  check();
  scene.vertices[scene.indices[0]].position.x = std::numeric_limits<float>::quiet_NaN();  // is built anew
  check();
}

const std::filesystem::path kShared = std::filesystem::path(LUCERNA_SOURCE_DIR).parent_path() / "shared/assets";

/// Random, along axes, grazing, at edges, at corners: a fifth each.
std::vector<GlRay> mixedRays(const Scene& scene, const glm::dvec3& shift, std::size_t count, unsigned seed) {
  std::vector<GlRay> rays = randomRays(count, scene.bounds.centre() - shift, 0.6 * scene.bounds.extent(), seed);
  std::mt19937 random(seed + 1);
  std::uniform_real_distribution<float> unit(0.0f, 1.0f);
  for (std::size_t i = 0; i < count; ++i) {
    GlRay& ray = rays[i];
    const std::size_t t = random() % scene.triangleCount();
    const auto corner = [&](std::size_t k) {
      return glm::vec3(glm::dvec3(scene.vertices[scene.indices[3 * t + k]].position) - shift);
    };
    const glm::vec3 a = corner(0), b = corner(1), c = corner(2);
    if (i % 5 == 1) {
      const int axis = static_cast<int>(random() % 3);
      ray.direction = glm::vec3(0.0f);
      ray.direction[axis] = random() % 2 ? 1.0f : -1.0f;
    } else if (i % 5 == 2) {  // along a triangle's plane, tilted against it by a thousandth
      const glm::vec3 n = glm::cross(b - a, c - a),
                      along = (b - a) * (unit(random) - 0.5f) + (c - a) * (unit(random) - 0.5f);
      if (glm::length(n) > 0.0f && glm::length(along) > 0.0f) {
        ray.direction = glm::normalize(along) - 1e-3f * glm::normalize(n);
        ray.origin = (a + b + c) / 3.0f -
                     ray.direction * (unit(random) * static_cast<float>(glm::length(scene.bounds.extent())) * 0.1f);
      }
    } else if (i % 5 == 3) {
      ray.direction = glm::mix(a, b, unit(random)) - ray.origin;
    } else if (i % 5 == 4) {
      ray.direction = a - ray.origin;
    }
  }
  return rays;
}

void agreeWithEmbree(gl::ProgramLibrary& programs, const gl::Capabilities& capabilities, const Scene& scene,
                     std::size_t count) {
  const RayScene rayScene(scene, capabilities);
  const EmbreeRays embree(scene, rayScene.origin());
  const std::vector<GlRay> rays = mixedRays(scene, rayScene.origin(), count, 10);
  std::vector<PlainRay> plain;
  for (const GlRay& r : rays) plain.push_back({r.origin, r.tMin, r.direction, r.tMax});
  std::vector<PlainHit> theirs(rays.size());
  embree.trace(plain, theirs, false);
  const std::vector<GlHit> ours = trace(programs, rayScene, rays);
  const Verdict v = compare(scene, rayScene, rays, ours, theirs);
  std::cout << scene.name << ": " << rays.size() << " rays, " << v.met << " hit; within rounding of an edge "
            << v.atEdges << ", Embree missed " << v.theirs << ", we " << v.wrong << "\n";
  EXPECT_EQ(v.wrong, 0u);
  EXPECT_GT(v.met, count / 5);
  EXPECT_LT(v.atEdges, count / 50);
}

Scene sharedScene(const char* file) {
  const std::filesystem::path path = kShared / file;
  return std::filesystem::exists(path) ? loadScene(path) : Scene{};
}

TEST_F(RayCasterOnGl, AgreesWithEmbreeInSponza) {
  if (!EmbreeRays::isBuilt()) GTEST_SKIP() << "built without Embree";
  const Scene scene = sharedScene("crytek-sponza/sponza.obj");
  if (scene.indices.empty()) GTEST_SKIP() << "no ../shared/assets/crytek-sponza";
  agreeWithEmbree(library(), capabilities(), scene, 400000);
}

TEST_F(RayCasterOnGl, AgreesWithEmbreeOnADragonNearAndFar) {
  if (!EmbreeRays::isBuilt()) GTEST_SKIP() << "built without Embree";
  Scene scene = sharedScene("stanford/dragon_100k.obj");
  if (scene.indices.empty()) GTEST_SKIP() << "no ../shared/assets/stanford";
  agreeWithEmbree(library(), capabilities(), scene, 400000);
  const glm::dvec3 far = 1e4 * glm::length(scene.bounds.extent()) * glm::dvec3(1.0, -1.0, 0.5);
  Bounds bounds;
  for (Vertex& v : scene.vertices) {
    v.position = glm::dvec3(v.position) + far;
    bounds.add(glm::dvec3(v.position));
  }
  scene.bounds = bounds;
  scene.name += ", far from the origin";
  agreeWithEmbree(library(), capabilities(), scene, 200000);
}

}  // namespace
}  // namespace lucerna
