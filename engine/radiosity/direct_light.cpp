#include "radiosity/direct_light.hpp"

#include "base/angles.hpp"
#include "base/stop_watch.hpp"
#include "gl/pass.hpp"
#include "scene/triangle_parts.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

namespace lucerna {

namespace {

/// Input of blocked.comp.
struct Ray {
  glm::vec4 origin;  ///< in the hierarchy's space; w: the patch
  glm::vec4 direction;  ///< to the light, its length the distance
  glm::vec4 normal;  ///< of the patch; w: the largest of its coordinates
};

/// Unoccluded light at a point: the vector to the light, and the irradiance across it.
struct Arrival {
  glm::dvec3 toLight, irradiance;
};

std::vector<Arrival> arrivals(const Scene& scene, const glm::dvec3& point, double beyond) {
  std::vector<Arrival> result;
  if (scene.sun) result.push_back({-beyond * scene.sun->direction, glm::dvec3(scene.sun->irradiance)});
  for (const SpotLight& light : scene.spots) {
    const glm::dvec3 to = light.position - point;
    const double cosine = glm::dot(-to, light.direction) / glm::length(to), inner = std::cos(light.innerAngle),
                 outer = std::cos(light.outerAngle);
    const double t =
        inner > outer ? std::clamp((cosine - outer) / (inner - outer), 0.0, 1.0) : (cosine >= outer ? 1.0 : 0.0);
    result.push_back({to, glm::dvec3(light.intensity) * (t * t * (3.0 - 2.0 * t) / glm::dot(to, to))});
  }
  for (const PointLight& light : scene.points) {
    const glm::dvec3 to = light.position - point;
    result.push_back({to, glm::dvec3(light.intensity) / glm::dot(to, to)});
  }
  return result;
}

/// The texel of an environment's picture that contains a direction, as paths see it (shaders/rays/environment.glsl).
glm::dvec3 texelOf(const Environment& environment, const glm::dvec3& direction) {
  const Image& picture = *environment.picture;
  const double rotations = 0.5 + (std::atan2(direction.x, -direction.z) + environment.rotation) / (2.0 * kPi);
  const double v = std::acos(std::clamp(direction.y, -1.0, 1.0)) / kPi;
  const int x = std::min(static_cast<int>((rotations - std::floor(rotations)) * picture.width), picture.width - 1);
  const int y = std::min(static_cast<int>(v * picture.height), picture.height - 1);
  return glm::dvec3(picture.at(x, y));
}

/// The texels of an environment's picture that are much brighter than its mean. Rays that go everywhere leave them out;
/// others go to them alone, in proportion to what each gives.
class BrightTexels {
 public:
  explicit BrightTexels(const Environment& environment) : environment_(environment) {
    const Image& picture = *environment.picture;
    double sum = 0.0;
    eachTexel([&](int x, int y) { sum += brightness(glm::dvec3(picture.at(x, y))) * solidAngle(y); });
    limit_ = kLimit * sum / (4.0 * kPi);
    eachTexel([&](int x, int y) {
      const glm::dvec3 texel(picture.at(x, y));
      if (holds(texel)) all_ += brightness(texel) * solidAngle(y);
      sums_.push_back(all_);
    });
  }
  bool empty() const { return all_ <= 0.0; }
  bool holds(const glm::dvec3& texel) const { return brightness(texel) > limit_; }
  /// Numbers from 0 to 1 choose a texel and a place in it. Returns the direction there and the irradiance across it,
  /// without Environment::radiance, whose mean over such directions is that of all these texels.
  Arrival sample(double which, double across, double down) const {
    const Image& picture = *environment_.picture;
    const auto found = std::upper_bound(sums_.begin(), sums_.end() - 1, which * all_) - sums_.begin();
    const int x = static_cast<int>(found % picture.width), y = static_cast<int>(found / picture.width);
    const double azimuth = 2.0 * kPi * ((x + across) / picture.width - 0.5) - environment_.rotation;
    const double top = std::cos(kPi * y / picture.height), bottom = std::cos(kPi * (y + 1) / picture.height);
    const double height = top + down * (bottom - top), radius = std::sqrt(std::max(1.0 - height * height, 0.0));
    const glm::dvec3 texel(picture.at(x, y));
    return {{radius * std::sin(azimuth), height, -radius * std::cos(azimuth)}, texel * (all_ / brightness(texel))};
  }

 private:
  static constexpr double kLimit = 4.0;  ///< of the mean

  static double brightness(const glm::dvec3& c) { return std::max({c.x, c.y, c.z}); }
  double solidAngle(int y) const {
    const Image& picture = *environment_.picture;
    return 2.0 * kPi / picture.width * (std::cos(kPi * y / picture.height) - std::cos(kPi * (y + 1) / picture.height));
  }
  void eachTexel(const std::function<void(int x, int y)>& visit) const {
    for (int y = 0; y < environment_.picture->height; ++y)
      for (int x = 0; x < environment_.picture->width; ++x) visit(x, y);
  }

  const Environment& environment_;
  double limit_ = 0.0, all_ = 0.0;
  std::vector<double> sums_;  ///< of what the bright texels up to each give, row by row
};

/// A word for each ray of a batch, not empty, from a program that reads them.
template <class T>
std::vector<GLuint> answersOf(const std::string& name, const gl::Program& program, const RayScene& rays,
                              const std::vector<T>& batch) {
  const gl::Buffer in(name + " rays", batch.size() * sizeof(T), batch.data(), gl::Usage::streamDraw);
  const gl::Buffer answers(name, batch.size() * sizeof(GLuint), nullptr, gl::Usage::dynamicRead);
  {
    const gl::ComputePass pass(name);
    program.use();
    program.set("rayCount", static_cast<int>(batch.size()));
    rays.bind();
    in.bindStorage(1);
    answers.bindStorage(2);
    pass.dispatch({static_cast<int>(batch.size()), 1, 1}, {64, 1, 1});
  }
  return answers.read<GLuint>();
}

/// Traces visibility rays, in submissions of limited size.
class OcclusionRays {
 public:
  static constexpr std::size_t kEach = 1 << 16;

  OcclusionRays(gl::ProgramLibrary& programs, const RayScene& rays)
      : program_(programs.loadCompute("direct light", "radiosity/blocked.comp",
                                      {{"ALPHA_MASKS", 0}, {"SHARED_STACK", rays.sharedStack()}})),
        rays_(rays) {}

  /// Nonzero if occluded.
  std::vector<GLuint> blocked(const std::vector<Ray>& batch) const {
    if (batch.empty()) return {};
    return answersOf("direct light", program_, rays_, batch);
  }

 private:
  const gl::Program& program_;
  const RayScene& rays_;
};

/// A patch's normal, and the largest coordinate of its corners in the hierarchy's space, which determines the rounding
/// error.
glm::vec4 faceOf(const RadiosityMesh& mesh, const Patch& patch, const glm::dvec3& origin) {
  double largest = 0.0;
  for (const glm::dvec3& corner : mesh.corners(patch))
    largest = std::max(
        {largest, std::abs(corner.x - origin.x), std::abs(corner.y - origin.y), std::abs(corner.z - origin.z)});
  return glm::vec4(glm::vec3(patch.faceNormal), static_cast<float>(largest));
}

/// Centroids of the parts that are not hidden; at least one.
std::vector<glm::dvec3> pointsOf(const RadiosityMesh& mesh, const Patch& patch,
                                 const std::vector<glm::dvec2>& centroids) {
  const auto c = mesh.corners(patch);
  std::vector<glm::dvec3> points;
  for (const glm::dvec2& w : centroids)
    if (!(patch.hidden >> partAt(kPatchParts, w) & 1))
      points.push_back(c[0] + w.x * (c[1] - c[0]) + w.y * (c[2] - c[0]));
  if (points.empty()) points.push_back(patch.centroid);
  return points;
}

}  // namespace

std::vector<glm::dvec3> directLight(gl::ProgramLibrary& programs, const RayScene& rays, const Scene& scene,
                                    const RadiosityMesh& mesh, std::size_t most) {
  std::vector<glm::dvec3> irradiance(mesh.patches.size(), glm::dvec3(0.0));
  const std::size_t lights = (scene.sun ? 1 : 0) + scene.spots.size() + scene.points.size();
  if (lights == 0) return irradiance;
  const int parts = std::clamp(
      static_cast<int>(std::sqrt(static_cast<double>(most) / static_cast<double>(lights * mesh.patches.size()))), 1, 4);
  const double beyond = 4.0 * mesh.extent;
  const std::vector<glm::dvec2> centroids = partCentroids(parts);
  const OcclusionRays shadowRays(programs, rays);

  // Patches in runs whose rays fill one submission.
  const std::size_t raysOfPatch = static_cast<std::size_t>(parts * parts) * lights;
  const std::size_t patchesEach = std::max<std::size_t>(OcclusionRays::kEach / raysOfPatch, 1);
  for (std::size_t first = 0; first < mesh.patches.size(); first += patchesEach) {
    StopWatch::check("finding direct light", first, mesh.patches.size());
    std::vector<Ray> batch;
    struct Sample {
      std::size_t patch;
      glm::dvec3 irradiance;
    };
    std::vector<Sample> samples;
    for (std::size_t p = first; p < std::min(first + patchesEach, mesh.patches.size()); ++p) {
      const Patch& patch = mesh.patches[p];
      const glm::vec4 normal = faceOf(mesh, patch, rays.origin());
      const std::vector<glm::dvec3> points = pointsOf(mesh, patch, centroids);
      for (const glm::dvec3& point : points)
        for (const Arrival& arrival : arrivals(scene, point, beyond)) {
          const double cosine = glm::dot(glm::normalize(arrival.toLight), patch.faceNormal);
          if (cosine <= 0.0 || arrival.irradiance == glm::dvec3(0.0)) continue;
          batch.push_back({glm::vec4(glm::vec3(point - rays.origin()), static_cast<float>(p)),
                           glm::vec4(glm::vec3(arrival.toLight), 0.0f), normal});
          samples.push_back({p, arrival.irradiance * (cosine / static_cast<double>(points.size()))});
        }
    }
    const std::vector<GLuint> flags = shadowRays.blocked(batch);
    for (std::size_t k = 0; k < samples.size(); ++k)
      if (!flags[k]) irradiance[samples[k].patch] += samples[k].irradiance;
  }
  return irradiance;
}

std::vector<std::uint32_t> backsMet(gl::ProgramLibrary& programs, const RayScene& rays,
                                    std::span<const Segment> segments) {
  const gl::Program& program = programs.loadCompute("backs met", "radiosity/backs_met.comp",
                                                    {{"ALPHA_MASKS", 0}, {"SHARED_STACK", rays.sharedStack()}});
  std::vector<std::uint32_t> met;
  for (std::size_t first = 0; first < segments.size(); first += OcclusionRays::kEach) {
    StopWatch::check("looking for lit backs", first, segments.size());
    std::vector<std::array<glm::vec4, 2>> batch;  // origins and directions
    for (const Segment& s : segments.subspan(first, std::min(OcclusionRays::kEach, segments.size() - first)))
      batch.push_back({glm::vec4(glm::vec3(s.from - rays.origin()), 0.0f), glm::vec4(glm::vec3(s.to - s.from), 0.0f)});
    const std::vector<GLuint> read = answersOf("backs met", program, rays, batch);
    met.insert(met.end(), read.begin(), read.end());
  }
  return met;
}

std::vector<std::uint32_t> litFromBehind(gl::ProgramLibrary& programs, const RayScene& rays, const Scene& scene,
                                         const RadiosityMesh& mesh) {
  std::vector<Segment> segments;
  for (const Patch& patch : mesh.patches)
    for (const Arrival& arrival : arrivals(scene, patch.centroid, 4.0 * mesh.extent))
      if (arrival.irradiance != glm::dvec3(0.0) && glm::dot(arrival.toLight, patch.faceNormal) < 0.0)
        segments.push_back({patch.centroid + arrival.toLight, patch.centroid});
  std::vector<std::uint32_t> lit = backsMet(programs, rays, segments);
  std::erase(lit, kNoPatch);
  return lit;
}

std::vector<glm::dvec3> skyLight(gl::ProgramLibrary& programs, const RayScene& rays, const Scene& scene,
                                 const RadiosityMesh& mesh, std::size_t most) {
  constexpr double kPlastic = 0.75487766624669276;  // 1 / the plastic number: with its square the steps of a lattice in
                                                    // two more dimensions, angle and point
  constexpr double kGolden = 0.61803398874989485;
  const auto fraction = [](double x) { return x - std::floor(x); };
  std::vector<glm::dvec3> irradiance(mesh.patches.size(), glm::dvec3(0.0));
  const std::size_t raysOfPatch =
      std::clamp<std::size_t>(most / std::max<std::size_t>(mesh.patches.size(), 1), 64, 1024);
  const double beyond = 4.0 * mesh.extent;
  const std::vector<glm::dvec2> centroids = partCentroids(4);
  const OcclusionRays shadowRays(programs, rays);
  const Environment& environment = *scene.environment;
  const glm::dvec3 factor(environment.radiance);
  std::optional<BrightTexels> bright;
  if (environment.picture) bright.emplace(environment);
  const std::size_t toTexels = bright && !bright->empty() ? raysOfPatch / 2 : 0, toAll = raysOfPatch - toTexels;
  for (std::size_t first = 0; first < mesh.patches.size(); first += OcclusionRays::kEach / raysOfPatch) {
    StopWatch::check("finding the sky's light", first, mesh.patches.size());
    const std::size_t end = std::min(first + OcclusionRays::kEach / raysOfPatch, mesh.patches.size());
    std::vector<Ray> batch;
    std::vector<glm::dvec3> carried;  // irradiance
    for (std::size_t p = first; p < end; ++p) {
      const Patch& patch = mesh.patches[p];
      const glm::vec4 face = faceOf(mesh, patch, rays.origin());
      const std::vector<glm::dvec3> points = pointsOf(mesh, patch, centroids);
      const auto add = [&](std::size_t k, const glm::dvec3& direction, const glm::dvec3& irradianceOfRay) {
        if (irradianceOfRay == glm::dvec3(0.0)) return;
        const double which = fraction(kPlastic * kPlastic * static_cast<double>(k));
        const glm::dvec3& point = points[static_cast<std::size_t>(which * static_cast<double>(points.size()))];
        batch.push_back({glm::vec4(glm::vec3(point - rays.origin()), static_cast<float>(p)),
                         glm::vec4(glm::vec3(beyond * direction), 0.0f), face});
        carried.push_back(irradianceOfRay);
      };
      const glm::dvec3 n = patch.faceNormal,
                       u = glm::normalize(std::abs(n.x) < 0.5 ? glm::cross(n, glm::dvec3(1, 0, 0))
                                                              : glm::cross(n, glm::dvec3(0, 1, 0))),
                       v = glm::cross(n, u);
      for (std::size_t k = 0; k < toAll; ++k) {
        // Uniform points on the unit disc are cosine-distributed on the hemisphere above it. Each patch turns them.
        const double r2 = (static_cast<double>(k) + 0.5) / static_cast<double>(toAll),
                     angle = 2.0 * kPi * kPlastic * static_cast<double>(k + p);
        const glm::dvec3 direction =
            std::sqrt(r2) * (std::cos(angle) * u + std::sin(angle) * v) + std::sqrt(1.0 - r2) * n;
        glm::dvec3 radiance(1.0);
        if (bright) {
          const glm::dvec3 texel = texelOf(environment, direction);
          radiance = bright->holds(texel) ? glm::dvec3(0.0) : texel;
        }
        add(k, direction, factor * radiance * (kPi / static_cast<double>(toAll)));
      }
      for (std::size_t k = 0; k < toTexels; ++k) {
        const double turn = kGolden * static_cast<double>(p), step = static_cast<double>(k);
        const Arrival arrival = bright->sample((step + fraction(turn)) / static_cast<double>(toTexels),
                                               fraction(kPlastic * step + turn), fraction(kGolden * step + turn));
        add(k, arrival.toLight,
            factor * arrival.irradiance *
                (std::max(glm::dot(arrival.toLight, n), 0.0) / static_cast<double>(toTexels)));
      }
    }
    const std::vector<GLuint> flags = shadowRays.blocked(batch);
    for (std::size_t k = 0; k < batch.size(); ++k)
      if (!flags[k]) irradiance[static_cast<std::size_t>(batch[k].origin.w)] += carried[k];
  }
  return irradiance;
}

}  // namespace lucerna
