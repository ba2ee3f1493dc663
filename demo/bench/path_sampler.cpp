#include "bench/path_sampler.hpp"

#include "base/error.hpp"
#include "pathtracer/path_tracer.hpp"

namespace lucerna::demo::bench {

namespace {

Transport pathTransport(measure::Transport transport) {
  switch (transport) {
    case measure::Transport::direct: return Transport::direct;
    case measure::Transport::oneBounce: return Transport::oneBounce;
    case measure::Transport::oneBounceUnoccluded: return Transport::oneBounceUnoccluded;
    case measure::Transport::all: return Transport::all;
  }
  return Transport::all;
}

}  // namespace

PathSampler::PathSampler(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene, const Camera& camera, glm::ivec2 size,
                         measure::Transport transport, bool allMaterials)
    : context_(context), programs_(programs), scene_(scene), camera_(camera), size_(size), transport_(transport), allMaterials_(allMaterials) {}

PathSampler::~PathSampler() = default;

measure::Sampler PathSampler::asSampler() {
  return [this](std::uint64_t first, std::uint32_t samples) { return sample(first, samples); };
}

void PathSampler::begin(std::uint64_t first) {
  PathTracer::Settings settings;
  settings.size = size_;
  settings.transport = pathTransport(transport_);
  settings.diffuseOnly = !allMaterials_;
  settings.pixelCentres = true;
  // Another seed for another part of the same reference and for each transport: their noise must be independent.
  settings.seed = static_cast<std::uint32_t>(first * 2654435761u) ^ (static_cast<std::uint32_t>(transport_) + 1) * 0x9e3779b9u ^ (allMaterials_ ? 0x5bd1e995u : 0u);
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
    batch.pixels[i] = glm::vec3((after * glm::dvec3(mean.pixels[i]) - before * glm::dvec3(sum_.pixels[i])) / static_cast<double>(samples));
  sum_ = mean;
  return batch;
}

}  // namespace lucerna::demo::bench
