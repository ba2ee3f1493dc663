#include "walk/live_reference.hpp"

#include "base/clock.hpp"
#include "base/error.hpp"
#include "base/hash.hpp"
#include "base/log.hpp"
#include "pathtracer/path_sampler.hpp"
#include "measure/flip.hpp"

#include <algorithm>
#include <chrono>

namespace lucerna::demo {

namespace {

void upload(gl::Texture& texture, const Image& image) {
  std::vector<glm::vec4> texels;
  texels.reserve(image.pixels.size());
  for (int y = image.height - 1; y >= 0; --y)
    for (int x = 0; x < image.width; ++x) texels.emplace_back(image.at(x, y), 1.0f);
  texture.upload(gl::Texels::rgbaFloat, texels.data());
}

}  // namespace

gl::Texture textureOf(const std::string& name, const Image& image) {
  gl::Texture texture(name, gl::Format::rgba32f, glm::ivec2(image.width, image.height));
  upload(texture, image);
  return texture;
}

// The settings are those of engine/pathtracer/path_sampler.cpp, so that both give the same picture; another seed makes
// it independent of the cached samples.
LiveReference::LiveReference(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene,
                             glm::ivec2 size, PixelFilter filter, Component component, bool denoised)
    : context_(context),
      scene_(scene),
      size_(size),
      component_(component),
      cache_(measure::ReferenceCache::defaultFolder()) {
  PathTracer::Settings settings;
  settings.size = size;
  settings.transport = transportOf(component);
  settings.diffuseOnly = true;
  settings.filter = filter;
  settings.submissionSeconds = 0.02;
  Hash seed;
  seed.add(std::string_view("live"));
  seed.add(static_cast<std::uint64_t>(std::chrono::system_clock::now().time_since_epoch().count()));
  settings.seed = static_cast<std::uint32_t>(seed.value() ^ seed.value() >> 32);
  settings.halves = true;  // which know their noise
  tracer_ = std::make_unique<PathTracer>(context, programs, scene, settings);
  if (denoised) denoiser_.emplace(programs, *tracer_);
  meanTexture_ = gl::Texture("reference", gl::Format::rgba32f, size);
  errorTexture_ = gl::Texture("standard error of the reference", gl::Format::rgba32f, size);
}

LiveReference::~LiveReference() = default;

PixelFilter LiveReference::filter() const { return tracer_->settings().filter; }

void LiveReference::look(const Camera& camera) {
  keep();
  tracer_->setCamera(camera);
  if (denoiser_) denoiser_->forget();
  showsDenoised_ = false;
  denoisedAt_ = 0;
  key_ = measure::keyOf(scene_, camera, size_, transportOf(component_),
                        PathSampler::versionOf(tracer_->settings().filter));
  cached_ = cache_.load(*key_);
  cachedSamples_ = cached_ ? cached_->samples : 0;
  shownSamples_ = keptSamples_ = 0;
  target_ = 1;
  seconds_ = 0.0;
  shown_ = {};
  if (cached_) publish();
}

void LiveReference::advance(double seconds) {
  if (!key_) return;
  const auto begin = Clock::now();
  do {
    const auto start = Clock::now();
    const bool more = tracer_->advance(target_);
    submission_ = secondsSince(start);
    seconds_ += submission_;
    if (more) continue;
    shownSamples_ = target_;
    target_ += std::clamp(target_, 1u, 16u);
    publish();
  } while (secondsSince(begin) + submission_ <= seconds);
}

// Publishes only whole passes: every pixel has the same number of samples.
void LiveReference::publish() {
  measure::Reference mine;
  if (shownSamples_ >= 2) {
    mine.transport = transportOf(component_);
    mine.mean = tracer_->mean();
    mine.standardError = tracer_->standardError();
    const glm::dvec3 error = tracer_->statistics().meanError;
    mine.meanError = (error.x + error.y + error.z) / 3.0;  // channels are fully correlated
    mine.samples = shownSamples_;
    mine.seconds = seconds_;
    mine.renderer = context_.capabilities().renderer;
  }
  if (cached_ && shownSamples_ >= 2) shown_ = measure::merged(*cached_, mine);
  else if (cached_) shown_ = *cached_;
  else if (shownSamples_ >= 2) shown_ = std::move(mine);
  else return;
  showsDenoised_ = denoiser_ && shownSamples_ >= 2 && shownSamples_ > cachedSamples_;
  if (showsDenoised_) {
    // Anew whenever the samples have doubled: it takes as long as several samples.
    if (shownSamples_ >= 2 * denoisedAt_) {
      denoiser_->denoise();
      gl::copyTexels(denoiser_->result(), {0, 0}, meanTexture_, {0, 0}, size_);
      denoisedAt_ = shownSamples_;
    }
  } else {
    upload(meanTexture_, shown_.mean);
  }
  upload(errorTexture_, shown_.standardError);
  ++version_;
}

void LiveReference::keep() {
  if (!key_ || shownSamples_ < keptSamples_ + kWorthKeeping || shown_.samples == 0) return;
  try {
    cache_.store(*key_, shown_);
  } catch (const Error& error) { logWarning("{}; the reference of this view is not stored", error.what()); }
  keptSamples_ = shownSamples_;
}

std::size_t LiveReference::gpuBytes() const {
  return tracer_->gpuBytes() + (denoiser_ ? denoiser_->gpuBytes() : 0) + meanTexture_.bytes() + errorTexture_.bytes();
}

Judgement::~Judgement() {
  if (pending_.valid()) pending_.wait();
}

void Judgement::clear() {
  known_ = false;
  flip_.reset();
  flipMap_ = {};
}

void Judgement::judge(Image picture, const measure::Reference& reference, bool withFlip) {
  nrmse_ = measure::nrmseInterval(picture, reference.mean, reference.standardError);
  const glm::dvec3 a = meanOf(picture), b = meanOf(reference.mean);
  const double mean = b.x + b.y + b.z;
  bias_ = mean > 0.0 ? (a.x + a.y + a.z) / mean - 1.0 : 0.0;
  known_ = true;
  if (!withFlip || pending_.valid()) return;  // the next one will have better pictures
  pending_ = std::async(std::launch::async, [picture = std::move(picture), exact = reference.mean] {
    const measure::Flip flip = measure::flipHdr(picture, exact);
    return FlipResult{flip.mean, flip.map, exact.width, exact.height};
  });
}

std::optional<double> Judgement::flip() {
  if (pending_.valid() && pending_.wait_for(std::chrono::seconds(0)) == std::future_status::ready) {
    const FlipResult result = pending_.get();
    flip_ = result.mean;
    Image map(result.width, result.height);
    for (std::size_t i = 0; i < result.map.size(); ++i) map.pixels[i] = glm::vec3(result.map[i]);
    flipMap_ = textureOf("FLIP", map);
  }
  return flip_;
}

}  // namespace lucerna::demo
