// Pictures of small scenes by the path tracer, and what the answers are.
#pragma once

#include "pathtracer/path_tracer.hpp"
#include "support/gl_fixture.hpp"
#include "support/small_scenes.hpp"

namespace lucerna::test {

/// A closed box of 6 plates about the origin that face outwards (inwards: `inwards`), side 2 `half`.
void addBox(SceneBuilder& builder, double half, int material, bool inwards = false,
            const glm::dvec3& centre = glm::dvec3(0.0));

/// A scene without the builder's sun, with a constant environment.
SceneBuilder inEnvironment(float radiance);

class PathTest : public SharedProgramsTest {
 protected:
  PathTracer tracer(const Scene& scene, const Camera& camera, const PathTracer::Settings& settings,
                    std::uint32_t samples);
  /// With the settings' defaults but the size.
  PathTracer tracer(const Scene& scene, const Camera& camera, int size, std::uint32_t samples);
  static PathTracer::Settings sized(int size);
};

/// |mean - expected| in standard errors, the largest over the channels.
double deviations(const PathTracer::Statistics& statistics, const glm::dvec3& expected);
double deviations(const PathTracer::Statistics& a, const PathTracer::Statistics& b);

}  // namespace lucerna::test
