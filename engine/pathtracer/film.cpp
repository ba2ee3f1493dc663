#include "pathtracer/film.hpp"

#include "base/error.hpp"
#include "base/files.hpp"
#include "base/hash.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>

namespace lucerna {

namespace {

constexpr std::array<char, 8> kMagic{'L', 'U', 'C', 'P', 'A', 'T', 'H', '2'};
struct Header {
  std::array<char, 8> magic = kMagic;
  std::uint64_t identity = 0, hash = 0;
  std::uint32_t width = 0, height = 0, first = 0, halves = 0;
};

std::uint64_t hashOf(const std::uint8_t* words, std::size_t size, std::uint32_t first) {
  Hash hash;
  hash.bytes(words, size);
  hash.add(first);
  return hash.value();
}

glm::vec3 floatsOf(const glm::uvec4& w) {
  return {std::bit_cast<float>(w.x), std::bit_cast<float>(w.y), std::bit_cast<float>(w.z)};
}
glm::uvec4 wordsOf(const glm::vec3& v, std::uint32_t w) {
  return {std::bit_cast<std::uint32_t>(v.x), std::bit_cast<std::uint32_t>(v.y), std::bit_cast<std::uint32_t>(v.z), w};
}

/// Variance of a pixel's mean. Rounding may make a sum of squares slightly negative.
glm::dvec3 meanVariance(const FilmPixel& p) {
  const double n = p.samples;
  return p.samples < 2 ? glm::dvec3(0.0) : glm::max(glm::dvec3(p.m2), glm::dvec3(0.0)) / (n * (n - 1.0));
}

template <class Value>
Image toImage(const Film& film, Value value) {
  Image image(film.size.x, film.size.y);
  const std::vector<FilmPixel> pixels = film.pixels();
  for (int y = 0; y < film.size.y; ++y)
    for (int x = 0; x < film.size.x; ++x)
      image.at(x, film.size.y - 1 - y) = value(
          pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(film.size.x) + static_cast<std::size_t>(x)]);
  return image;
}

}  // namespace

FilmStatistics statisticsOf(std::span<const FilmPixel> pixels) {
  const double count = static_cast<double>(pixels.size());
  FilmStatistics result;
  result.fewestSamples = std::numeric_limits<std::uint32_t>::max();
  glm::dvec3 variances(0.0), lit(0.0);
  double unlitWeight = 0.0, litPixels = 0.0;
  for (const FilmPixel& pixel : pixels) {
    result.fewestSamples = std::min(result.fewestSamples, pixel.samples);
    result.mostSamples = std::max(result.mostSamples, pixel.samples);
    result.samples += pixel.samples / count;
    result.mean += glm::dvec3(pixel.mean) / count;
    variances += meanVariance(pixel);
    if (pixel.mean != glm::vec3(0.0f)) {
      lit += glm::dvec3(pixel.mean);
      ++litPixels;
    } else if (pixel.samples > 0) {
      unlitWeight += 3.0 / (static_cast<double>(pixel.samples) * pixel.samples);
    }
  }
  result.meanError = glm::sqrt(variances) / count;
  if (result.fewestSamples < 2) {
    result.standardError = result.relativeError = std::numeric_limits<double>::infinity();
    result.meanError = glm::dvec3(result.standardError);
    return result;
  }
  // Where n samples found nothing, up to 3 in n may find light (with 95 %, the rule of three [HanleyLippmanHand1983]),
  // as much as lit pixels have.
  if (litPixels > 0.0) variances += lit * lit * (unlitWeight / (litPixels * litPixels));
  result.standardError = std::sqrt((variances.x + variances.y + variances.z) / (3.0 * count));
  const double mean = (result.mean.x + result.mean.y + result.mean.z) / 3.0;
  // Nothing found at all says nothing about the error.
  result.relativeError = mean > 0.0 ? result.standardError / mean : std::numeric_limits<double>::infinity();
  return result;
}

std::string standardErrorText(double standardError, double relativeError) {
  if (!std::isfinite(standardError)) return "standard error not known, from one sample";
  if (!std::isfinite(relativeError)) return "standard error not known, as no light was found";
  return fmt::format("standard error of a pixel {:.3g} ({:.3g} of the mean)", standardError, relativeError);
}

glm::vec3 standardErrorOf(const FilmPixel& pixel) { return glm::vec3(glm::sqrt(meanVariance(pixel))); }

std::vector<FilmPixel> Film::pixels() const {
  std::vector<FilmPixel> result(mean.size());
  for (std::size_t i = 0; i < mean.size(); ++i) result[i] = {floatsOf(mean[i]), floatsOf(m2[i]), mean[i].w};
  return result;
}
Image Film::picture() const {
  return toImage(*this, [](const FilmPixel& p) { return p.mean; });
}
Image Film::standardError() const { return toImage(*this, standardErrorOf); }

Film filmOf(std::span<const std::uint8_t> bytes, const std::string& name) {
  Header header;
  if (bytes.size() < sizeof header)
    throwBadInput("{}: not a checkpoint of a path-traced picture ({} bytes)", name, bytes.size());
  std::memcpy(&header, bytes.data(), sizeof header);
  if (header.magic != kMagic)
    throwBadInput("{}: not a checkpoint of a path-traced picture, or one of another version", name);
  const std::size_t texels = static_cast<std::size_t>(header.width) * header.height,
                    plane = texels * sizeof(glm::uvec4);
  if (header.width > (1u << 16) || header.height > (1u << 16) || texels == 0 ||
      bytes.size() != sizeof header + 3 * plane ||
      header.hash != hashOf(bytes.data() + sizeof header, 3 * plane, header.first))
    throwBadInput("{}: the checkpoint is damaged or truncated", name);
  Film film;
  film.identity = header.identity;
  film.size = {static_cast<int>(header.width), static_cast<int>(header.height)};
  film.first = header.first;
  film.halves = header.halves != 0;
  const std::uint8_t* from = bytes.data() + sizeof header;
  for (std::vector<glm::uvec4>* words : {&film.mean, &film.m2, &film.rest}) {
    words->resize(texels);
    std::memcpy(static_cast<void*>(words->data()), from, plane);
    from += plane;
  }
  return film;
}

std::vector<std::uint8_t> bytesOf(const Film& film) {
  Header header;
  header.identity = film.identity;
  header.width = static_cast<std::uint32_t>(film.size.x);
  header.height = static_cast<std::uint32_t>(film.size.y);
  header.first = film.first;
  header.halves = film.halves;
  std::vector<std::uint8_t> bytes(sizeof header);
  for (const std::vector<glm::uvec4>* words : {&film.mean, &film.m2, &film.rest}) {
    const auto* begin = reinterpret_cast<const std::uint8_t*>(words->data());
    bytes.insert(bytes.end(), begin, begin + words->size() * sizeof(glm::uvec4));
  }
  header.hash = hashOf(bytes.data() + sizeof header, bytes.size() - sizeof header, header.first);
  std::memcpy(bytes.data(), &header, sizeof header);
  return bytes;
}

std::uint32_t firstSampleOf(const std::filesystem::path& file) {
  Header header;
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throwCannotOpen(file, errno);
  if (!stream.read(reinterpret_cast<char*>(&header), sizeof header) || header.magic != kMagic)
    throwBadInput("{}: not a checkpoint of a path-traced picture, or one of another version", file.string());
  return header.first;
}

void FilmMerge::add(const Film& film, const std::string& name) {
  if (film.halves) throwBadInput("{}: the film of a denoised picture, which has no parts to merge", name);
  const std::uint32_t samples = film.mean.front().w;
  if (samples == 0 ||
      std::any_of(film.mean.begin(), film.mean.end(), [&](const glm::uvec4& w) { return w.w != samples; }))
    throwBadInput("{}: the part is not finished; the command that makes it resumes it with it", name);
  if (films_ == 0) {
    head_ = film;
    headName_ = name;
    next_ = film.first;
    mean_.assign(film.mean.size(), glm::dvec3(0.0));
    m2_ = mean_;
  }
  if (film.size != head_.size)
    throwBadInput("{}: {} x {} pixels; {} has {} x {}", name, film.size.x, film.size.y, headName_, head_.size.x,
                  head_.size.y);
  if (film.identity != head_.identity) throwBadInput("{}: of another scene, view or setting than {}", name, headName_);
  if (film.first < next_)
    throwBadInput("{} and {} hold the same samples ({} to {})", before_, name, film.first,
                  std::min<std::uint64_t>(next_, film.first + std::uint64_t{samples}) - 1);
  if (film.first > next_)
    throwBadInput("samples {} to {} are in no part (between {} and {})", next_, film.first - 1, before_, name);

  const double n = static_cast<double>(next_ - head_.first), m = samples, all = n + m;
  for (std::size_t i = 0; i < mean_.size(); ++i) {
    const glm::dvec3 own = glm::dvec3(floatsOf(film.mean[i])) + glm::dvec3(floatsOf(film.rest[i])),
                     difference = own - mean_[i];
    m2_[i] += glm::dvec3(floatsOf(film.m2[i])) + difference * difference * (n * m / all);
    mean_[i] += difference * (m / all);
  }
  next_ += samples;
  before_ = name;
  ++films_;
}

Film FilmMerge::result() const {
  CHECK(films_ > 0, "{} films", films_);
  Film result = head_;
  for (std::size_t i = 0; i < mean_.size(); ++i) {
    const glm::vec3 high(mean_[i]);
    result.mean[i] = wordsOf(high, static_cast<std::uint32_t>(next_ - head_.first));
    result.rest[i] = wordsOf(glm::vec3(mean_[i] - glm::dvec3(high)), head_.rest[i].w);
    result.m2[i] = wordsOf(glm::vec3(m2_[i]), head_.m2[i].w);
  }
  return result;
}

}  // namespace lucerna
