#include "pathtracer/denoiser.hpp"

#include "base/error.hpp"
#include "gl/pass.hpp"

#include <algorithm>
#include <cmath>

namespace lucerna {

namespace {

constexpr int kGroup = 8, kFeatureSamples = 32, kSamplesAtOnce = 4;
constexpr int kHalves = 2, kRegressors = 11, kWindow = 9;  // of the shaders
constexpr GLuint kConstantsBinding = 0;

}  // namespace

DenoisedError denoisedError(std::span<const DenoisedBlock> blocks, int columns, double mean) {
  DenoisedBlock all;
  for (const DenoisedBlock& b : blocks) {
    all.error += b.error;
    all.heldOut += b.heldOut;
    all.raw += b.raw;
    all.pixels += b.pixels;
  }
  DenoisedError result;
  const auto count = static_cast<int>(blocks.size()), rows = count / std::max(columns, 1);
  if (count < 2 || !(all.pixels > 0.0) || !(mean > 0.0)) return result;
  const double values = 3.0 * all.pixels;

  // How far a block is from the mean of all.
  const auto apartOf = [&](double DenoisedBlock::*sum, int i) {
    const DenoisedBlock& b = blocks[static_cast<std::size_t>(i)];
    return b.*sum - all.*sum * (b.pixels / all.pixels);
  };
  // Standard error of a sum over all blocks, from its differences from the mean in each block and in those around it.
  const auto standardError = [&](double DenoisedBlock::*sum) {
    const auto apart = [&](int i) { return apartOf(sum, i); };
    double own = 0.0, shared = 0.0;
    for (int y = 0; y < rows; ++y)
      for (int x = 0; x < columns; ++x) {
        const double here = apart(y * columns + x);
        own += here * here;
        if (x + 1 < columns) shared += 2.0 * here * apart(y * columns + x + 1);
        if (y + 1 < rows) shared += 2.0 * here * apart((y + 1) * columns + x);
      }
    return std::sqrt(2.0 * std::max(own, own + shared) * count / (count - 1.0)) / values;
  };
  // Student's quantile of 99 % by the first terms of its expansion in 1 / freedom [AbramowitzStegun1964, 26.7.5].
  constexpr double kNormal = 2.576;
  const double freedom = count - 1.0, z2 = kNormal * kNormal,
               quantile = kNormal * (1.0 + (z2 + 1.0) / (4.0 * freedom) +
                                     (5.0 * z2 * z2 + 16.0 * z2 + 3.0) / (96.0 * freedom * freedom));
  // Rare bright blocks make the mean's distribution lean: what was not seen is more [Johnson1978].
  double squares = 0.0, cubes = 0.0;
  for (int i = 0; i < count; ++i) {
    const double apart = apartOf(&DenoisedBlock::heldOut, i);
    squares += apart * apart / freedom;
    cubes += apart * apart * apart / count;
  }
  const double lean =
      squares > 0.0 ? std::max(cubes, 0.0) * (1.0 + 2.0 * quantile * quantile) / (6.0 * squares * values) : 0.0;
  const auto relative = [&](double square) { return std::sqrt(std::max(square, 0.0)) / mean; };
  const double low = all.error / values, high = all.heldOut / values;
  result.known = true;
  result.value = relative(0.5 * (low + high));
  result.low = relative(std::min(low, high) - quantile * standardError(&DenoisedBlock::error));
  result.high = relative(std::max(low, high) + quantile * standardError(&DenoisedBlock::heldOut) + lean);
  result.raw = relative(all.raw / values);
  return result;
}

Denoiser::Denoiser(gl::ProgramLibrary& programs, const PathTracer& tracer)
    : tracer_(tracer),
      constants_("denoiser constants", sizeof(shared::PathConstants), nullptr, gl::Usage::dynamicDraw) {
  const PathTracer::Settings& settings = tracer.settings();
  CHECK(settings.halves, "the film of a denoised picture has two halves");
  features_ =
      &programs.loadCompute("features", "pathtracer/features.comp",
                            gl::with(tracer.scene().flags(), {{"LINEAR_SEEDS", 0},
                                                              {"GLOSSY", 0},
                                                              {"SHARED_STACK", tracer.scene().rays().sharedStack()},
                                                              {"DIFFUSE_ONLY", settings.diffuseOnly},
                                                              {"PIXEL_FILTER", PathTracer::filterFlag(settings.filter)},
                                                              {"SAMPLES", kSamplesAtOnce}}));
  const auto fit = [&](const char* name, int number, int radius, int stride) {
    return &programs.loadCompute(name, "pathtracer/denoise_regress.comp",
                                 {{"FIT", number}, {"RADIUS", radius}, {"STRIDE", stride}});
  };
  readFilm_ = &programs.loadCompute("film of halves", "pathtracer/denoise_film.comp", {});
  narrowFit_ = fit("narrow fit", 0, kNarrow, 1);
  wideFit_ = fit("wide fit", 1, kWide, 1);
  colouredFit_ = fit("coloured fit", 2, kWide, 1);
  farFit_ = fit("far fit", 3, kWide, kStride);
  terms_ = &programs.loadCompute("terms", "pathtracer/denoise_terms.comp", {});
  rows_ = &programs.loadCompute("rows of terms", "pathtracer/denoise_rows.comp", {});
  combine_ = &programs.loadCompute("denoised", "pathtracer/denoise_combine.comp", {});
  rawSums_ = &programs.loadCompute("sums of radiance", "pathtracer/denoise_sums.comp", {{"ALL", 0}});
  allSums_ = &programs.loadCompute("sum of sums", "pathtracer/denoise_sums.comp", {{"ALL", 1}});
  allocate();
}

void Denoiser::allocate() {
  const glm::ivec2 size = tracer_.settings().size, halves(size.x, kHalves * size.y);
  const auto plane = [](const char* name, glm::ivec2 texels) { return gl::Texture(name, gl::Format::rgba32f, texels); };
  colours_ = plane("surface colours", size);
  places_ = plane("surface places", size);
  film_ = plane("film of halves", halves);
  narrow_ = plane("narrow fit", halves);
  wide_ = plane("wide fit", halves);
  coloured_ = plane("coloured fit", halves);
  far_ = plane("far fit", halves);
  for (gl::Texture& texture : term_) texture = plane("denoiser terms", size);
  for (gl::Texture& texture : row_) texture = plane("denoiser rows", size);
  result_ = plane("denoised", size);
  errors_ = plane("squared errors", size);
  blocks_ = plane("sums of blocks", (size + kGroup - 1) / kGroup);
  total_ = plane("sum of radiance", {1, 1});
  hasFeatures_ = false;
}

void Denoiser::forget() {
  if (result_.size2d() != tracer_.settings().size) allocate();
  hasFeatures_ = false;
}

void Denoiser::traceFeatures() {
  const shared::PathConstants& constants = tracer_.constants();
  constants_.upload(0, sizeof constants, &constants);
  for (int first = 0; first < kFeatureSamples; first += kSamplesAtOnce) {
    const gl::ComputePass pass("features", gl::Barrier::image, gl::Barrier::image);
    features_->use();
    tracer_.scene().bind();
    constants_.bindUniform(kConstantsBinding);
    colours_.bindImage(0, gl::Access::readWrite);
    places_.bindImage(1, gl::Access::readWrite);
    features_->set("firstSample", first);
    chunks_.forEach(tracer_.settings().size, kSamplesAtOnce * gl::kIterationsOfRay, kGroup,
                    [&](glm::ivec2 corner, glm::ivec2 size) {
                      features_->set("firstPixel", corner);
                      pass.dispatch(glm::ivec3(size, 1), glm::ivec3(kGroup, kGroup, 1));
                    });
  }
  hasFeatures_ = true;
}

// Means and variances of the film's pixels, into film_.
void Denoiser::readFilm() {
  const gl::ComputePass pass("film of halves", gl::Barrier::image);
  readFilm_->use();
  readFilm_->set("picture", tracer_.settings().size);
  tracer_.bindMean(0);
  tracer_.bindSquares(1);
  film_.bindImage(0, gl::Access::write);
  pass.dispatch(glm::ivec3(tracer_.settings().size, kHalves), glm::ivec3(kGroup, kGroup, 1));
}

void Denoiser::regress(const gl::Program& program, const gl::Texture& to, const gl::Texture* guide, int radius) {
  const glm::ivec2 picture = tracer_.settings().size;
  const gl::ComputePass pass("denoiser fit", gl::Barrier::image);
  program.use();
  program.set("picture", picture);
  tracer_.bindMean(0);
  to.bindImage(0, gl::Access::write);
  colours_.bindImage(1, gl::Access::read);
  places_.bindImage(2, gl::Access::read);
  film_.bindImage(3, gl::Access::read);
  if (guide) guide->bindImage(4, gl::Access::read);
  const int layers = guide ? kHalves : 1;  // without a guide an invocation makes both halves
  const double pixels = layers * (2.0 * radius + 1.0) * (2.0 * radius + 1.0);
  chunks_.forEach(picture, pixels * kRegressors, kGroup, [&](glm::ivec2 corner, glm::ivec2 size) {
    program.set("firstPixel", corner);
    pass.dispatch(glm::ivec3(size, layers), glm::ivec3(kGroup, kGroup, 1));
  });
}

// The raw picture's sum, into total_.
void Denoiser::sumRadiance() {
  {
    const gl::ComputePass pass("sums of blocks", gl::Barrier::textureFetch);
    rawSums_->use();
    rawSums_->set("picture", tracer_.settings().size);
    tracer_.bindMean(0);
    blocks_.bindImage(0, gl::Access::write);
    pass.dispatch(glm::ivec3(tracer_.settings().size, 1), glm::ivec3(kGroup, kGroup, 1));
  }
  const gl::ComputePass pass("sum of blocks", gl::Barrier::textureFetch);
  allSums_->use();
  blocks_.bind(2);
  total_.bindImage(0, gl::Access::write);
  pass.dispatch({1, 1, 1}, {1, 1, 1});
}

// From the candidates to the picture.
void Denoiser::combine() {
  const glm::ivec2 picture = tracer_.settings().size;
  const auto bindCandidates = [&] {
    tracer_.bindMean(0);
    narrow_.bind(4);
    wide_.bind(5);
    coloured_.bind(6);
    far_.bind(7);
  };
  const auto run = [&](const gl::Program& program, double iterations, const gl::ComputePass& pass) {
    chunks_.forEach(picture, iterations, kGroup, [&](glm::ivec2 corner, glm::ivec2 size) {
      program.set("firstPixel", corner);
      pass.dispatch(glm::ivec3(size, 1), glm::ivec3(kGroup, kGroup, 1));
    });
  };
  {
    const gl::ComputePass pass("denoiser terms", gl::Barrier::textureFetch, gl::Barrier::image);
    terms_->use();
    terms_->set("picture", picture);
    bindCandidates();
    total_.bind(8);
    for (GLuint i = 0; i < term_.size(); ++i) term_[i].bindImage(i, gl::Access::write);
    run(*terms_, kRegressors, pass);
  }
  {
    const gl::ComputePass pass("denoiser rows", gl::Barrier::textureFetch);
    rows_->use();
    rows_->set("picture", picture);
    for (GLuint i = 0; i < row_.size(); ++i) term_[i].bind(i), row_[i].bindImage(i, gl::Access::write);
    run(*rows_, 2.0 * kWindow, pass);
  }
  const gl::ComputePass pass("denoised", gl::Barrier::textureFetch);
  combine_->use();
  combine_->set("picture", picture);
  bindCandidates();
  for (GLuint i = 0; i < row_.size(); ++i) row_[i].bind(8 + i), term_[i].bind(12 + i);
  result_.bindImage(0, gl::Access::write);
  errors_.bindImage(1, gl::Access::write);
  constexpr double kSteps = 2 * 32 * 10;  // of denoise_combine.comp, in which shares move
  run(*combine_, 4.0 * kWindow + kSteps, pass);
}

void Denoiser::denoise() {
  if (tracer_.samples() >= 2) {
    if (!hasFeatures_) traceFeatures();
    readFilm();
    regress(*narrowFit_, narrow_, nullptr, kNarrow);
    regress(*wideFit_, wide_, nullptr, kWide);
    regress(*colouredFit_, coloured_, &narrow_, kWide);
    regress(*farFit_, far_, &coloured_, kWide);
    sumRadiance();
  }
  combine();
}

Image Denoiser::picture() const {
  const std::vector<glm::vec4> texels = result_.readRgba();
  Image image(result_.size2d().x, result_.size2d().y);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      image.at(x, image.height - 1 - y) = glm::vec3(
          texels[static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x)]);
  return image;
}

DenoisedError Denoiser::error() const {
  if (tracer_.samples() < kFewestSamples) return {};
  const std::vector<glm::vec4> texels = errors_.readRgba();
  const glm::ivec2 size = errors_.size2d(), count = (size + kGroup - 1) / kGroup;
  std::vector<DenoisedBlock> blocks(static_cast<std::size_t>(count.x) * static_cast<std::size_t>(count.y));
  for (int y = 0; y < size.y; ++y)
    for (int x = 0; x < size.x; ++x) {
      const glm::dvec4 t(
          texels[static_cast<std::size_t>(y) * static_cast<std::size_t>(size.x) + static_cast<std::size_t>(x)]);
      DenoisedBlock& b = blocks[static_cast<std::size_t>(y / kGroup) * static_cast<std::size_t>(count.x) +
                                static_cast<std::size_t>(x / kGroup)];
      b.error += t.x;
      b.heldOut += t.y;
      b.raw += t.z;
      b.pixels += t.w;
    }
  const glm::dvec3 mean = meanOf(tracer_.mean());
  return denoisedError(blocks, count.x, (mean.x + mean.y + mean.z) / 3.0);
}

std::size_t Denoiser::gpuBytes() const {
  std::size_t bytes = constants_.bytes();
  for (const gl::Texture* texture :
       {&colours_, &places_, &film_, &narrow_, &wide_, &coloured_, &far_, &result_, &errors_, &blocks_, &total_})
    bytes += texture->bytes();
  for (std::size_t i = 0; i < term_.size(); ++i) bytes += term_[i].bytes() + row_[i].bytes();
  return bytes;
}

}  // namespace lucerna
