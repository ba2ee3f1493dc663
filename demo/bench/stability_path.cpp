// Stiff and extreme cases of the path tracer. Statistical: an answer must lie within 4 standard errors (1 row in 16,000
// fails by chance), and the error itself is bounded.
#include "bench/stability.hpp"
#include "bench/stability_room.hpp"
#include "pathtracer/path_tracer.hpp"

#include <fmt/core.h>

#include <cmath>

namespace lucerna::demo::bench {

namespace {

struct Answer {
  double mean = 0.0, error = 0.0;  ///< over all pixels and channels; its standard error
  double notFinite = 0.0;
};

struct PathView {
  glm::ivec2 size{24, 16};
  std::uint32_t samples = 64;
};

Answer trace(const StabilityContext& c, const Scene& scene, const PathView& view = {}) {
  PathTracer::Settings settings;
  settings.size = view.size;
  settings.seed = 1;
  PathTracer tracer(c.context, c.programs, scene, settings);
  tracer.setCamera(scene.cameras.front());
  tracer.record(view.samples);
  Answer answer;
  const Image picture = tracer.mean();
  for (const glm::vec3& p : picture.pixels)
    answer.notFinite += !(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
  const glm::dvec3 mean = meanOf(picture), error = tracer.statistics().meanError;
  answer.mean = (mean.x + mean.y + mean.z) / 3.0;
  answer.error = (error.x + error.y + error.z) / 3.0;  // channels share their paths
  return answer;
}

/// The mean is `expected` within 4 standard errors, which may be at most `relative` of it; rounding of a long float sum
/// is allowed 1e-5.
Measurement within(const Answer& answer, double expected, double relative = 0.005) {
  const double tolerance = 4.0 * answer.error + 1e-5 * expected;
  const bool precise = tolerance <= relative * expected * 4.0;
  return {expected, precise ? answer.mean : NAN, tolerance};
}

void addPathRow(std::vector<StabilityCase>& cases, std::string name, std::string parameter,
                std::function<Measurement(const StabilityContext&)> run) {
  cases.push_back({"path", std::move(name), std::move(parameter), std::move(run)});
}

/// All surfaces emit 1 and reflect rho: 1 / (1 - rho) everywhere.
void addFurnaces(std::vector<StabilityCase>& cases) {
  for (const float rho : {0.0f, 0.5f, 0.9f, 0.99f, 0.999f})
    addPathRow(cases, "closed furnace, radiance 1 / (1 - albedo)", fmt::format("albedo {:g}", static_cast<double>(rho)),
               [rho](const StabilityContext& c) {
                 Room room;
                 room.closed = true;
                 room.albedo = rho;
                 room.emission = glm::vec3(1.0f);
                 PathView view;
                 // Path length grows as 1 / (1 - rho), and with it the work and the variance of a sample.
                 view.samples = rho > 0.995f ? 16 : rho > 0.95f ? 32 : 128;
                 return within(trace(c, makeRoom(room), view), 1.0 / (1.0 - static_cast<double>(rho)),
                               rho > 0.95f ? 0.05 : 0.005);
               });
}

/// Surfaces without absorption, lit by 1 from all directions: radiance 1 in every pixel.
void addWhiteFurnaces(std::vector<StabilityCase>& cases) {
  struct Kind {
    const char* name;
    Bsdf bsdf;
    float roughness, ior;
  };
  static constexpr Kind kKinds[] = {
      {"diffuse", Bsdf::diffuse, 0.0f, 1.5f},           {"mirror", Bsdf::mirror, 0.0f, 1.5f},
      {"glass, ior 1.5", Bsdf::dielectric, 0.0f, 1.5f}, {"ior 1.0001", Bsdf::dielectric, 0.0f, 1.0001f},
      {"ior 1", Bsdf::dielectric, 0.0f, 1.0f},          {"ior 5", Bsdf::dielectric, 0.0f, 5.0f}};
  for (const Kind& kind : kKinds)
    addPathRow(cases, "white furnace, radiance", kind.name, [kind](const StabilityContext& c) {
      Room room;
      room.irradiance = 0.0f;
      room.albedo = 1.0f;
      // Glass must be closed, and seen from outside.
      room.closed = kind.bsdf == Bsdf::dielectric;
      Scene scene = makeRoom(room);
      if (room.closed) {
        scene.cameras.front().position = {0.0, 1.0, 20.0};
        for (Vertex& v : scene.vertices) v.normal = -v.normal;
        for (std::size_t i = 0; i < scene.indices.size(); i += 3) std::swap(scene.indices[i], scene.indices[i + 1]);
      }
      for (Material& m : scene.materials)
        m.diffuse = m.specular = glm::vec3(1.0f), m.bsdf = kind.bsdf, m.roughness = kind.roughness, m.ior = kind.ior;
      scene.environment = Environment{glm::vec3(1.0f), {}, 0.0};
      return within(trace(c, scene), 1.0);
    });
}

void addPathUnits(std::vector<StabilityCase>& cases) {
  const auto against = [&](const std::string& name, const std::string& parameter, const Room& room, double factor) {
    addPathRow(cases, name, parameter, [room, factor](const StabilityContext& c) {
      const Answer usual = trace(c, makeRoom({})), other = trace(c, makeRoom(room));
      return Measurement{1.0, other.mean / factor / usual.mean,
                         4.0 * std::hypot(usual.error, other.error / factor) / usual.mean};
    });
  };
  for (const float factor : {1e-9f, 1e9f}) {
    Room room;
    room.irradiance *= factor;
    against("mean over the sun's irradiance, against 1x", fmt::format("sun {:g}x", static_cast<double>(factor)), room,
            static_cast<double>(factor));
  }
  for (const double scale : {std::exp2(-20), std::exp2(20), 1e-3, 1e6}) {
    Room room;
    room.scale = scale;
    against("mean of a scaled scene, against 1x", fmt::format("scale {:g}", scale), room, 1.0);
  }
  for (const double distance : {1e3, 1e4}) {
    Room room;
    room.place = glm::dvec3(distance, -0.5 * distance, 0.7 * distance);
    against("mean of a scene far from the origin", fmt::format("{:g} room sides", 0.1 * distance), room, 1.0);
  }
  Room bad;
  bad.badTriangles = true;
  against("zero-area, needle and doubled triangles: mean", "3 more", bad, 1.0);
}

void addExtremes(std::vector<StabilityCase>& cases) {
  const auto finite = [&](const char* name, const char* parameter, const Room& room, const PathView& view) {
    addPathRow(cases, std::string(name) + ": pixels not finite", parameter, [room, view](const StabilityContext& c) {
      return Measurement{0.0, trace(c, makeRoom(room), view).notFinite, 0.0};
    });
  };
  Room room;
  room.place = glm::dvec3(1e6);
  finite("very far from the origin", "1e5 room sides", room, {});
  room = {};
  room.sun = {-1.0, 0.0, -1e-7};
  finite("sun along the floor", "grazing", room, {});
  finite("a picture of one pixel", "1x1", {}, {{1, 1}, 64});
  finite("one sample", "spp 1", {}, {{24, 16}, 1});
  addPathRow(cases, "no light: mean", "sun 0", [](const StabilityContext& c) {
    Room dark;
    dark.irradiance = 0.0f;
    return Measurement{0.0, trace(c, makeRoom(dark)).mean, 0.0};
  });
}

}  // namespace

void addPathCases(std::vector<StabilityCase>& cases) {
  addFurnaces(cases);
  addWhiteFurnaces(cases);
  addPathUnits(cases);
  addExtremes(cases);
}

}  // namespace lucerna::demo::bench
