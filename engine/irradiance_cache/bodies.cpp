#include "irradiance_cache/bodies.hpp"

#include "pathtracer/media.hpp"
#include "rays/path_scene.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace lucerna {

double halfSpaceReflectance(double albedo) {
  const double s = std::sqrt(1.0 - std::clamp(albedo, 0.0, 1.0));
  return (1.0 - s) * (1.0 - 0.139 * s) / (1.0 + 1.17 * s);
}

double diffuseFresnel(double ior) {
  constexpr int kSteps = 256;
  double sum = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const double square = (i + 0.5) / kSteps, cosI = std::sqrt(square);  // even over cos^2: weight 2 cos sin
    const double inside = 1.0 - (1.0 - square) / (ior * ior);
    if (inside <= 0.0) {
      sum += 1.0;
      continue;
    }
    const double cosT = std::sqrt(inside), s = (cosI - ior * cosT) / (cosI + ior * cosT),
                 p = (ior * cosI - cosT) / (ior * cosI + cosT);
    sum += 0.5 * (s * s + p * p);
  }
  return sum / kSteps;
}

namespace {

float meanOf(const std::vector<float>& values) {
  return values.empty() ? 0.0f
                        : std::accumulate(values.begin(), values.end(), 0.0f) / static_cast<float>(values.size());
}

}  // namespace

std::vector<shared::BodyRecord> bodiesOf(const Scene& scene) {
  std::vector<shared::BodyRecord> bodies;
  int grids = 0;
  std::vector<int> gridOf;  // of each medium, as packMedia numbers them
  for (const Medium& medium : scene.media) gridOf.push_back(medium.grid ? grids++ : -1);
  for (const Material& material : scene.materials) {
    shared::BodyRecord& body = bodies.emplace_back();
    const bool isDielectric = material.bsdf == Bsdf::dielectric, isCloud = material.bsdf == Bsdf::none;
    body.ior = isDielectric ? material.ior : 1.0f;
    body.priority = material.priority;
    body.grid = -1;
    body.kind = isDielectric ? BODY_CLEAR : BODY_NONE;
    if (!(isDielectric || isCloud) || material.interior < 0) continue;
    const Medium& medium = scene.media[static_cast<std::size_t>(material.interior)];
    body.grid = isCloud ? gridOf[static_cast<std::size_t>(material.interior)] : -1;
    if (isCloud && body.grid < 0) continue;  // rays do not meet its boundary
    body.kind = isCloud || material.ior == 1.0f ? BODY_CLOUD : BODY_MEDIUM;
    const glm::vec3 g = medium.phase == PhaseFunction::rayleigh ? glm::vec3(0.0f) : medium.anisotropy,
                    scattering = medium.scattering * (1.0f - g);
    body.extinction = medium.absorption + scattering;
    if (isDielectric && medium.grid) body.extinction *= meanOf(medium.grid->density);
    // Inside, light goes round between medium and boundary, and spreads on its way out [Saunderson1942].
    const double outside = diffuseFresnel(body.ior), square = double(body.ior) * double(body.ior),
                 inside = 1.0 - (1.0 - outside) / square;
    for (int c = 0; c < 3; ++c) {
      const float stopped = medium.absorption[c] + scattering[c];
      body.albedo[c] = stopped > 0.0f ? scattering[c] / stopped : 0.0f;
      const double reflected = halfSpaceReflectance(double(body.albedo[c]));
      body.reflectance[c] = static_cast<float>(reflected * (1.0 - outside) / ((1.0 - inside * reflected) * square));
    }
  }
  return bodies;
}

Bodies::Bodies(const Scene& scene, const glm::dvec3& origin, const gl::Capabilities& capabilities) {
  const std::vector<shared::BodyRecord> bodies = bodiesOf(scene);
  const PackedMedia media = packMedia(scene.media, origin);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    hasMedia_ |= bodies[i].kind == BODY_MEDIUM;
    hasClouds_ |= bodies[i].kind == BODY_CLOUD;
    if (bodies[i].grid >= 0 && gridCount_ < kMostGrids) gridClouds_[gridCount_++] = static_cast<glm::uint>(i);
  }
  records_ = storageOf("cache bodies", bodies, capabilities);
  if (gridCount_ == 0) return;
  grids_ = storageOf("cache density grids", media.grids, capabilities);
  densities_ = storageOf("cache densities", media.densities, capabilities);
}

gl::ShaderFlags Bodies::flags() const { return {{"BODIES", hasMedia_}, {"CLOUDS", hasClouds_}, {"GRIDS", gridCount_}}; }

void Bodies::bind(const gl::Program& program) const {
  records_.bindStorage(BODY_RECORDS_BUFFER);
  if (gridCount_ == 0) return;
  program.set("gridClouds", gridClouds_);
  grids_.bindStorage(0);  // as in shaders/pathtracer/density.glsl
  densities_.bindStorage(1);
}

}  // namespace lucerna
