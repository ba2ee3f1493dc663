#include "pathtracer/path_sampler.hpp"

#include "base/hash.hpp"
#include "base/named_values.hpp"
#include "measure/light_kinds.hpp"
#include "pathtracer/path_tracer.hpp"

#include <fmt/format.h>

namespace lucerna {

PathSampler::PathSampler(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene,
                         const Camera& camera, glm::ivec2 size, PixelFilter filter, Transport transport,
                         bool allMaterials, int bounces)
    : context_(context),
      programs_(programs),
      scene_(scene),
      camera_(camera),
      size_(size),
      filter_(filter),
      transport_(transport),
      allMaterials_(allMaterials),
      bounces_(bounces) {}

PathSampler::~PathSampler() = default;

std::string PathSampler::versionOf(PixelFilter filter, bool allMaterials, int bounces) {
  std::string text =
      fmt::format("path tracer 8, filter {}, {}", nameOf(filter), allMaterials ? "all materials" : "lambert");
  if (bounces > 0) text += fmt::format(", {} bounces", bounces);
  return text;
}

measure::Sampler PathSampler::asSampler() {
  return [this](std::uint64_t first, std::uint32_t samples) { return sample(first, samples); };
}

// Each batch has its own film, so it does not matter which batches were computed before, or where. It has a seed of its
// own too: of one sequence, batches would lie between each other's points, and their differences would be of more than
// the noise of their mean. So do transports and choices of lights.
Image PathSampler::sample(std::uint64_t first, std::uint32_t samples) {
  if (!tracer_) {
    PathTracer::Settings settings;
    settings.size = size_;
    settings.transport = transport_;
    settings.diffuseOnly = !allMaterials_;
    settings.filter = filter_;
    if (bounces_ > 0)
      settings.bounces = 1u + static_cast<std::uint32_t>(bounces_);  // the first scattering is direct light
    tracer_ = std::make_unique<PathTracer>(context_, programs_, scene_, settings);
  }
  const measure::LightKinds lights = measure::kindsOf(scene_);
  Hash hash;
  hash.add(first);
  for (const int what : {static_cast<int>(transport_), bounces_, int{allMaterials_}, int{lights.sun}, int{lights.lamps},
                         int{lights.surfaces}, int{lights.environment}})
    hash.add(what);
  tracer_->setCamera(camera_);
  tracer_->setSeed(static_cast<std::uint32_t>(hash.value() ^ hash.value() >> 32));
  tracer_->record(samples);
  return tracer_->mean();
}

namespace {

/// Camera rays alone, enough to pass media and thin boundaries by chance, and for smooth edges.
PathTracer seeingTracer(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene,
                        const Camera& camera, glm::ivec2 size, PixelFilter filter) {
  PathTracer::Settings settings;
  settings.size = size;
  settings.bounces = 0;
  settings.diffuseOnly = true;
  settings.filter = filter;
  settings.nextEvent = false;
  PathTracer tracer(context, programs, scene, settings);
  tracer.setCamera(camera);
  tracer.record(filter == PixelFilter::centre ? 16 : 1024);
  return tracer;
}

}  // namespace

Image seenLights(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene, const Camera& camera,
                 glm::ivec2 size, PixelFilter filter) {
  return seeingTracer(context, programs, scene, camera, size, filter).mean();
}

std::vector<bool> emitterEdges(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene,
                               const Camera& camera, glm::ivec2 size, PixelFilter filter) {
  Scene shining = measure::litBy(scene, {false, false, true, false});
  shining.background = glm::vec3(0.0f);
  shining.media.clear();
  shining.cameraMedium = -1;
  for (Material& material : shining.materials) material.interior = -1;
  const Image error = seeingTracer(context, programs, shining, camera, size, filter).standardError();
  std::vector<bool> edges;
  for (const glm::vec3& e : error.pixels) edges.push_back(e != glm::vec3(0.0f));
  return edges;
}

// Surfaces that emit their albedo, without other light.
Image albedoPicture(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene, const Camera& camera,
                    glm::ivec2 size, PixelFilter filter) {
  Scene shining = measure::litBy(scene, {false, false, false, false});
  shining.background = glm::vec3(0.0f);
  for (Material& m : shining.materials) {
    m.emission = m.emissionScale = m.diffuse;
    m.emissionTexture = m.diffuseTexture;
  }
  return seenLights(context, programs, shining, camera, size, filter);
}

}  // namespace lucerna
