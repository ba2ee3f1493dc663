#include "pathtracer/path_sampler.hpp"

#include "base/error.hpp"
#include "base/hash.hpp"
#include "measure/light_kinds.hpp"
#include "pathtracer/path_tracer.hpp"

#include <fmt/format.h>

#include <limits>

namespace lucerna {

PathSampler::PathSampler(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene,
                         const Camera& camera, glm::ivec2 size, Transport transport, bool allMaterials, int bounces)
    : context_(context),
      programs_(programs),
      scene_(scene),
      camera_(camera),
      size_(size),
      transport_(transport),
      allMaterials_(allMaterials),
      bounces_(bounces) {}

PathSampler::~PathSampler() = default;

std::string PathSampler::version() const {
  std::string text(allMaterials_ ? kVersionOfAllMaterials : kVersion);
  if (bounces_ > 0) text += fmt::format(", {} bounces", bounces_);
  return text;
}

measure::Sampler PathSampler::asSampler() {
  return [this](std::uint64_t first, std::uint32_t samples) { return sample(first, samples); };
}

// Each batch has its own film, so it does not matter which batches were computed before, or where.
Image PathSampler::sample(std::uint64_t first, std::uint32_t samples) {
  if (first + samples > std::numeric_limits<std::int32_t>::max())
    throwMissingCapability("a reference is limited to {} paths per pixel", std::numeric_limits<std::int32_t>::max());
  if (!tracer_) {
    PathTracer::Settings settings;
    settings.size = size_;
    settings.transport = transport_;
    settings.diffuseOnly = !allMaterials_;
    settings.pixelCentres = true;
    if (bounces_ > 0)
      settings.bounces = 1u + static_cast<std::uint32_t>(bounces_);  // the first scattering is direct light
    // A different seed for each transport and each choice of lights: their noise must be independent.
    const measure::LightKinds lights = measure::kindsOf(scene_);
    Hash hash;
    hash.add(std::uint64_t{0});
    for (const int what : {static_cast<int>(transport_), bounces_, int{allMaterials_}, int{lights.sun},
                           int{lights.lamps}, int{lights.surfaces}, int{lights.environment}})
      hash.add(what);
    settings.seed = static_cast<std::uint32_t>(hash.value() ^ hash.value() >> 32);
    tracer_ = std::make_unique<PathTracer>(context_, programs_, scene_, settings);
  }
  tracer_->setCamera(camera_);
  if (first > 0) tracer_->setFirstSample(static_cast<std::uint32_t>(first));
  tracer_->record(samples);
  return tracer_->mean();
}

Image seenLights(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene, const Camera& camera,
                 glm::ivec2 size) {
  PathTracer::Settings settings;
  settings.size = size;
  settings.bounces = 0;
  settings.diffuseOnly = settings.pixelCentres = true;
  settings.nextEvent = false;
  PathTracer tracer(context, programs, scene, settings);
  tracer.setCamera(camera);
  tracer.record(16);  // enough to pass media and thin boundaries by chance
  return tracer.mean();
}

// Surfaces that emit their albedo, without other light.
Image albedoPicture(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene, const Camera& camera,
                    glm::ivec2 size) {
  Scene shining = measure::litBy(scene, {false, false, false, false});
  shining.background = glm::vec3(0.0f);
  for (Material& m : shining.materials) {
    m.emission = m.emissionScale = m.diffuse;
    m.emissionTexture = m.diffuseTexture;
  }
  return seenLights(context, programs, shining, camera, size);
}

}  // namespace lucerna
