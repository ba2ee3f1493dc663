#include "support/path_scenes.hpp"

#include <algorithm>
#include <cmath>

namespace lucerna::test {

void addBox(SceneBuilder& builder, double half, int material, bool inwards, const glm::dvec3& centre) {
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {-1.0, 1.0}) {
      glm::dvec3 n(0.0), u(0.0), v(0.0);
      n[axis] = sign;
      u[(axis + 1) % 3] = 2.0 * half;
      v[(axis + 2) % 3] = 2.0 * half;
      if ((sign < 0.0) != inwards) std::swap(u, v);
      builder.plate(centre + half * n, u, v, material);
    }
}

SceneBuilder inEnvironment(float radiance) {
  SceneBuilder builder;
  builder.scene().sun.reset();
  builder.scene().environment = Environment{};
  builder.scene().environment->radiance = glm::vec3(radiance);
  return builder;
}

PathTracer PathTest::tracer(const Scene& scene, const Camera& camera, const PathTracer::Settings& settings,
                            std::uint32_t samples) {
  PathTracer result(context(), library(), scene, settings);
  result.setCamera(camera);
  result.record(samples);
  return result;
}

PathTracer PathTest::tracer(const Scene& scene, const Camera& camera, int size, std::uint32_t samples) {
  return tracer(scene, camera, sized(size), samples);
}

PathTracer::Settings PathTest::sized(int size) {
  PathTracer::Settings settings;
  settings.size = glm::ivec2(size);
  return settings;
}

double deviations(const PathTracer::Statistics& statistics, const glm::dvec3& expected) {
  double worst = 0.0;
  for (int c = 0; c < 3; ++c) {
    const double difference = std::abs(statistics.mean[c] - expected[c]);
    worst = std::max(worst, difference / std::max(statistics.meanError[c], 1e-6 * std::abs(expected[c]) + 1e-30));
  }
  return worst;
}

double deviations(const PathTracer::Statistics& a, const PathTracer::Statistics& b) {
  PathTracer::Statistics both = a;
  both.meanError = glm::sqrt(a.meanError * a.meanError + b.meanError * b.meanError);
  return deviations(both, b.mean);
}

}  // namespace lucerna::test
