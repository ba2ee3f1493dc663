#include "bench/path_sampler.hpp"

#include "base/error.hpp"
#include "base/hash.hpp"
#include "measure/light_kinds.hpp"
#include "pathtracer/path_tracer.hpp"

#include <fmt/format.h>

namespace lucerna::demo::bench {

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

void PathSampler::begin(std::uint64_t first) {
  PathTracer::Settings settings;
  settings.size = size_;
  settings.transport = transport_;
  settings.diffuseOnly = !allMaterials_;
  settings.pixelCentres = true;
  if (bounces_ > 0)
    settings.bounces = 1u + static_cast<std::uint32_t>(bounces_);  // the first scattering is of direct light
  // Another seed for another part of the same reference, for each transport and each choice of lights: their noise must
  // be independent.
  const measure::LightKinds lights = measure::kindsOf(scene_);
  Hash hash;
  hash.add(first);
  for (const int what : {static_cast<int>(transport_), bounces_, int{allMaterials_}, int{lights.sun}, int{lights.lamps},
                         int{lights.surfaces}, int{lights.environment}})
    hash.add(what);
  settings.seed = static_cast<std::uint32_t>(hash.value() ^ hash.value() >> 32);
  tracer_.reset();
  tracer_ = std::make_unique<PathTracer>(context_, programs_, scene_, settings);
  tracer_->setCamera(camera_);
  begin_ = next_ = first;
  sum_ = Image(size_.x, size_.y);
}

// The film goes on; a batch is what its mean has gained since.
Image PathSampler::sample(std::uint64_t first, std::uint32_t samples) {
  if (!tracer_ || first != next_) begin(first);
  const double before = static_cast<double>(next_ - begin_), after = before + samples;
  tracer_->record(static_cast<std::uint32_t>(after));
  next_ += samples;
  const Image mean = tracer_->mean();
  Image batch(size_.x, size_.y);
  for (std::size_t i = 0; i < batch.pixels.size(); ++i)
    batch.pixels[i] = glm::vec3((after * glm::dvec3(mean.pixels[i]) - before * glm::dvec3(sum_.pixels[i])) /
                                static_cast<double>(samples));
  sum_ = mean;
  return batch;
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
  tracer.record(16);  // through media and thin boundaries by chance
  return tracer.mean();
}

// Surfaces that shine with their albedo, in the dark.
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

}  // namespace lucerna::demo::bench
