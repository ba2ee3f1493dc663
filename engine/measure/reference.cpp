#include "measure/reference.hpp"

#include "base/clock.hpp"
#include "measure/batches.hpp"

#include "base/error.hpp"
#include "base/files.hpp"
#include "base/log.hpp"
#include "scene/fingerprint.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>

namespace lucerna::measure {

namespace fs = std::filesystem;

// ---------------------------------------------------------------------------------------------------- batches

void BatchMean::add(const Image& batch) {
  if (batches_ == 0) {
    width_ = batch.width;
    height_ = batch.height;
    sum_.assign(batch.pixels.size(), glm::dvec3(0.0));
    squares_ = sum_;
  }
  CHECK(batch.width == width_ && batch.height == height_, "a batch of {}x{} after {}x{}", batch.width, batch.height,
        width_, height_);
  const double n = ++batches_;
  for (std::size_t i = 0; i < batch.pixels.size(); ++i) {
    const glm::dvec3 value(batch.pixels[i]), before = value - sum_[i];
    sum_[i] += before / n;
    squares_[i] += before * (value - sum_[i]);
  }
  const glm::dvec3 colour = meanOf(batch);
  const double mean = (colour.x + colour.y + colour.z) / 3.0, before = mean - meanOfMeans_;
  meanOfMeans_ += before / n;
  meanSquares_ += before * (mean - meanOfMeans_);
}

Image BatchMean::mean() const {
  Image image(width_, height_);
  for (std::size_t i = 0; i < sum_.size(); ++i) image.pixels[i] = glm::vec3(sum_[i]);
  return image;
}

Image BatchMean::standardError() const {
  CHECK(batches_ >= 2, "{} batches", batches_);
  Image image(width_, height_);
  const double n = batches_;
  for (std::size_t i = 0; i < squares_.size(); ++i)
    image.pixels[i] = glm::vec3(glm::sqrt(squares_[i] / (n * (n - 1.0))));
  return image;
}

double BatchMean::meanError() const {
  CHECK(batches_ >= 2, "{} batches", batches_);
  const double n = batches_;
  return std::sqrt(meanSquares_ / (n * (n - 1.0)));
}

Reference merged(const Reference& a, const Reference& b) {
  CHECK(a.mean.width == b.mean.width && a.mean.height == b.mean.height && a.transport == b.transport, "{} and {}",
        nameOf(a.transport), nameOf(b.transport));
  Reference result = a;
  const double total = static_cast<double>(a.samples + b.samples), wa = static_cast<double>(a.samples) / total,
               wb = 1.0 - wa;
  for (std::size_t i = 0; i < a.mean.pixels.size(); ++i) {
    result.mean.pixels[i] = glm::vec3(wa * glm::dvec3(a.mean.pixels[i]) + wb * glm::dvec3(b.mean.pixels[i]));
    const glm::dvec3 ea = wa * glm::dvec3(a.standardError.pixels[i]), eb = wb * glm::dvec3(b.standardError.pixels[i]);
    result.standardError.pixels[i] = glm::vec3(glm::sqrt(ea * ea + eb * eb));
  }
  result.meanError = std::hypot(wa * a.meanError, wb * b.meanError);
  result.samples = a.samples + b.samples;
  result.seconds = a.seconds + b.seconds;
  result.renderer = b.renderer;
  return result;
}

std::uint32_t batchSize(std::uint64_t samples) {
  return static_cast<std::uint32_t>(
      std::max<std::uint64_t>(1, (samples + SamplingGoal::kBatches - 1) / SamplingGoal::kBatches));
}

std::optional<Reference> sampleReference(const Sampler& sampler, Transport transport, std::uint64_t first,
                                         const SamplingGoal& goal, const std::function<bool()>& stop) {
  const auto start = Clock::now();
  const auto elapsed = [&] { return secondsSince(start); };
  const bool byCount = goal.samples > 0;
  // By time: the batch size doubles until one batch takes a sixteenth of the time. Then all batches start again at that
  // size, so that they are equal.
  std::uint32_t size = byCount ? batchSize(goal.samples) : 1;
  std::uint64_t next = first;
  if (!byCount) sampler(next, 1);  // keep one-time work such as compiling out of the batch's time
  if (!byCount)
    for (double last = 0.0;;) {
      const double before = elapsed();
      sampler(next, size);  // discarded, so its numbers may be used again below
      last = elapsed() - before;
      if ((stop && stop()) || 2.0 * last * SamplingGoal::kBatches > goal.seconds || size >= (1u << 20)) break;
      size *= 2;
    }
  BatchMean mean;
  while (!(stop && stop())) {
    mean.add(sampler(next, size));
    next += size;
    if (mean.batches() < SamplingGoal::kBatches) continue;
    if (byCount || elapsed() >= goal.seconds) break;
  }
  if (mean.batches() < 2) return std::nullopt;
  Reference result;
  result.transport = transport;
  result.mean = mean.mean();
  result.standardError = mean.standardError();
  result.meanError = mean.meanError();
  result.samples = next - first;
  result.seconds = elapsed();
  return result;
}

// ---------------------------------------------------------------------------------------------------- the cache

namespace {

constexpr char kMagic[8] = {'L', 'U', 'C', 'R', 'E', 'F', '0', '1'};

struct Header {
  char magic[8];
  std::uint64_t key, samples;
  double seconds, meanError;
  std::int32_t width, height, transport, rendererLength;
};
static_assert(sizeof(Header) == 56);

std::vector<std::uint8_t> encode(const ReferenceKey& key, const Reference& r) {
  Header header{};
  std::memcpy(header.magic, kMagic, sizeof kMagic);
  header.key = key.value;
  header.samples = r.samples;
  header.seconds = r.seconds;
  header.meanError = r.meanError;
  header.width = r.mean.width;
  header.height = r.mean.height;
  header.transport = static_cast<std::int32_t>(r.transport);
  header.rendererLength = static_cast<std::int32_t>(r.renderer.size());
  std::vector<std::uint8_t> bytes;
  const auto append = [&](const void* data, std::size_t size) {
    const auto* p = static_cast<const std::uint8_t*>(data);
    bytes.insert(bytes.end(), p, p + size);
  };
  append(&header, sizeof header);
  append(r.renderer.data(), r.renderer.size());
  append(r.mean.pixels.data(), r.mean.pixels.size() * sizeof(glm::vec3));
  append(r.standardError.pixels.data(), r.standardError.pixels.size() * sizeof(glm::vec3));
  Hash check;
  check.bytes(bytes.data(), bytes.size());
  const std::uint64_t value = check.value();
  append(&value, sizeof value);
  return bytes;
}

/// Empty if anything differs from what was written.
std::optional<Reference> decode(const ReferenceKey& key, const std::vector<std::uint8_t>& bytes) {
  Header header;
  if (bytes.size() < sizeof header + sizeof(std::uint64_t)) return std::nullopt;
  Hash check;
  check.bytes(bytes.data(), bytes.size() - sizeof(std::uint64_t));
  std::uint64_t stored;
  std::memcpy(&stored, bytes.data() + bytes.size() - sizeof stored, sizeof stored);
  std::memcpy(&header, bytes.data(), sizeof header);
  if (stored != check.value() || std::memcmp(header.magic, kMagic, sizeof kMagic) != 0 || header.key != key.value)
    return std::nullopt;
  Reference r;
  r.samples = header.samples;
  r.seconds = header.seconds;
  r.meanError = header.meanError;
  const std::size_t rest = bytes.size() - sizeof header - sizeof stored;
  if (header.width < 1 || header.height < 1 || header.rendererLength < 0 ||
      static_cast<std::size_t>(header.rendererLength) > rest ||
      static_cast<std::uint64_t>(header.width) * static_cast<std::uint64_t>(header.height) >
          rest / (2 * sizeof(glm::vec3)))
    return std::nullopt;
  const std::size_t size =
      static_cast<std::size_t>(header.width) * static_cast<std::size_t>(header.height) * sizeof(glm::vec3);
  if (rest != static_cast<std::size_t>(header.rendererLength) + 2 * size) return std::nullopt;
  if (header.samples < 1 || !(header.seconds >= 0.0) || !(header.meanError >= 0.0) ||
      !std::isfinite(header.seconds + header.meanError))
    return std::nullopt;
  if (header.transport < 0 || header.transport > static_cast<std::int32_t>(Transport::indirect)) return std::nullopt;
  r.transport = static_cast<Transport>(header.transport);
  r.mean = Image(header.width, header.height);
  r.standardError = r.mean;
  const std::uint8_t* at = bytes.data() + sizeof header;
  r.renderer.assign(reinterpret_cast<const char*>(at), static_cast<std::size_t>(header.rendererLength));
  at += header.rendererLength;
  std::memcpy(&r.mean.pixels[0].x, at, size);
  std::memcpy(&r.standardError.pixels[0].x, at + size, size);
  return r;
}

}  // namespace

std::string ReferenceKey::name() const { return fmt::format("{:016x}", value); }

ReferenceKey keyOf(const Scene& scene, const Camera& camera, glm::ivec2 size, Transport transport,
                   std::string_view sampler) {
  Hash hash;
  addScene(hash, scene);
  addCamera(hash, camera);
  hash.add(size.x), hash.add(size.y);
  hash.add(nameOf(transport));
  hash.add(sampler);
  return {hash.value()};
}

ReferenceCache::ReferenceCache(fs::path folder) : folder_(std::move(folder)) {
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error || !fs::is_directory(folder_))
    throwBadInput("{}: cannot create the folder for references ({})", folder_.string(),
                  error ? error.message() : "a file of that name exists");
}

fs::path ReferenceCache::fileOf(const ReferenceKey& key) const { return folder_ / (key.name() + ".lucref"); }

std::optional<Reference> ReferenceCache::load(const ReferenceKey& key) const {
  const fs::path file = fileOf(key);
  if (!fs::exists(file)) return std::nullopt;
  std::optional<Reference> reference = decode(key, readFileBytes(file));
  if (!reference) logWarning("{}: damaged reference, will be replaced", file.string());
  return reference;
}

void ReferenceCache::store(const ReferenceKey& key, const Reference& reference) const {
  writeFileAtomically(fileOf(key), encode(key, reference));
}

fs::path ReferenceCache::defaultFolder() {
  const auto variable = [](const char* name) -> std::string {
    const char* value = std::getenv(name);
    return value ? value : "";
  };
  if (const std::string own = variable("LUCERNA_REFERENCES"); !own.empty()) return own;
  if (const std::string cache = variable("XDG_CACHE_HOME"); !cache.empty()) return fs::path(cache) / "lucerna";
  if (const std::string home = variable("HOME"); !home.empty()) return fs::path(home) / ".cache" / "lucerna";
  return fs::path(".lucerna-references");
}

std::optional<Reference> obtainReference(const ReferenceCache& cache, const ReferenceKey& key, const Sampler& sampler,
                                         Transport transport, const SamplingGoal& goal, const std::string& renderer,
                                         const std::function<bool()>& stop) {
  std::optional<Reference> known = cache.load(key);
  SamplingGoal rest = goal;
  if (known) {
    if (goal.samples > 0 ? known->samples >= goal.samples : known->seconds >= 0.9 * goal.seconds) return known;
    if (goal.samples > 0) rest.samples = goal.samples - known->samples;
    rest.seconds = goal.seconds - known->seconds;
  }
  std::optional<Reference> more = sampleReference(sampler, transport, known ? known->samples : 0, rest, stop);
  if (!more) return known;
  more->renderer = renderer;
  const Reference result = known ? merged(*known, *more) : *more;
  cache.store(key, result);
  return result;
}

}  // namespace lucerna::measure
