// Pictures whose pixels all estimate the same quantity: mean and standard error from their spread, since they are
// independent.
#pragma once

#include "pathtracer/path_tracer.hpp"
#include "support/gl_fixture.hpp"
#include "support/long_tests.hpp"

#include <cmath>

namespace lucerna::test {

struct PixelEstimate {
  glm::dvec3 mean{0.0}, error{0.0};
  double energy = 0.0, energyError = 0.0;  ///< of the channels' mean
};

class MediaTest : public SharedProgramsTest {
 protected:
  static bool isLong() { return longTests(); }

  /// side x side pixels; not one path that leaks or loses count of the media it is in.
  static Image picture(const Scene& scene, std::uint32_t samples, PathTracer::Settings settings = {}, int side = 16) {
    settings.size = {side, side};
    PathTracer tracer(context(), library(), scene, settings);
    tracer.record(samples);
    EXPECT_EQ(tracer.statistics().leakedPaths, 0.0);
    EXPECT_EQ(tracer.statistics().wrongCrossings, 0.0);
    return tracer.mean();
  }

  static PixelEstimate estimate(const Image& image) {
    const double n = static_cast<double>(image.pixels.size());
    const auto channels = [](const glm::dvec3& p) { return (p.x + p.y + p.z) / 3.0; };
    PixelEstimate e;
    for (const glm::vec3& p : image.pixels) e.mean += glm::dvec3(p) / n;
    e.energy = channels(e.mean);
    for (const glm::vec3& p : image.pixels) {
      const glm::dvec3 off = glm::dvec3(p) - e.mean;
      e.error += off * off / (n * (n - 1.0));
      e.energyError += channels(off) * channels(off) / (n * (n - 1.0));
    }
    e.error = glm::sqrt(e.error);
    e.energyError = std::sqrt(e.energyError);
    return e;
  }
};

}  // namespace lucerna::test
