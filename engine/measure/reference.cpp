#include "measure/reference.hpp"

#include "base/clock.hpp"
#include "measure/batches.hpp"

#include "base/error.hpp"
#include "base/files.hpp"
#include "base/log.hpp"
#include "scene/fingerprint.hpp"

#include <algorithm>
#include <bit>
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

std::vector<double> BatchMean::state() const {
  std::vector<double> numbers{static_cast<double>(width_), static_cast<double>(height_), static_cast<double>(batches_),
                              meanOfMeans_, meanSquares_};
  for (const auto* values : {&sum_, &squares_})
    for (const glm::dvec3& value : *values) numbers.insert(numbers.end(), {value.x, value.y, value.z});
  return numbers;
}

std::optional<BatchMean> BatchMean::fromState(const std::vector<double>& state) {
  constexpr std::size_t kHead = 5;
  constexpr double kMost = 1 << 20;
  if (state.size() < kHead || !(state[0] >= 1.0 && state[0] < kMost && state[1] >= 1.0 && state[1] < kMost) ||
      !(state[2] >= 1.0 && state[2] < kMost))
    return std::nullopt;
  BatchMean mean;
  mean.width_ = static_cast<int>(state[0]), mean.height_ = static_cast<int>(state[1]);
  mean.batches_ = static_cast<int>(state[2]);
  mean.meanOfMeans_ = state[3], mean.meanSquares_ = state[4];
  const std::size_t pixels = static_cast<std::size_t>(mean.width_) * static_cast<std::size_t>(mean.height_);
  if (state.size() != kHead + 6 * pixels) return std::nullopt;
  for (std::size_t i = 0; i < 2 * pixels; ++i) {
    const double* at = &state[kHead + 3 * i];
    (i < pixels ? mean.sum_ : mean.squares_).emplace_back(at[0], at[1], at[2]);
  }
  return mean;
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
                                         const SamplingGoal& goal, const std::function<bool()>& stop,
                                         UnfinishedReference* unfinished) {
  const auto start = Clock::now();
  const bool byCount = goal.samples > 0;
  CHECK(!unfinished || byCount, "by time nothing can be gone on from");
  const double before = unfinished ? unfinished->seconds : 0.0;
  const auto elapsed = [&] { return before + secondsSince(start); };
  // By time: the batch size doubles until one batch takes a sixteenth of the time. Then all batches start again at that
  // size, so that they are equal.
  std::uint32_t size = byCount ? batchSize(goal.samples) : 1;
  std::uint64_t next = first;
  if (!byCount) sampler(next, 1);  // keep one-time work such as compiling out of the batch's time
  if (!byCount)
    for (double last = 0.0;;) {
      const double begun = elapsed();
      sampler(next, size);  // discarded, so its numbers may be used again below
      last = elapsed() - begun;
      if ((stop && stop()) || 2.0 * last * SamplingGoal::kBatches > goal.seconds || size >= (1u << 20)) break;
      size *= 2;
    }
  BatchMean mean = unfinished ? unfinished->mean : BatchMean();
  next += static_cast<std::uint64_t>(mean.batches()) * size;
  while (!(stop && stop())) {
    mean.add(sampler(next, size));
    next += size;
    if (mean.batches() < SamplingGoal::kBatches) continue;
    if (byCount || elapsed() >= goal.seconds) break;
  }
  if (unfinished) *unfinished = {first, size, elapsed(), mean};
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
  std::error_code none;
  fs::remove(unfinishedFileOf(key), none);
}

fs::path ReferenceCache::unfinishedFileOf(const ReferenceKey& key) const {
  return folder_ / (key.name() + ".unfinished");
}

// Words of 8 bytes: key, first path, samples per batch, seconds, the batches' state, a hash of all before it.
void ReferenceCache::store(const ReferenceKey& key, const UnfinishedReference& unfinished) const {
  std::vector<std::uint64_t> words{key.value, unfinished.first, unfinished.size,
                                   std::bit_cast<std::uint64_t>(unfinished.seconds)};
  for (const double number : unfinished.mean.state()) words.push_back(std::bit_cast<std::uint64_t>(number));
  words.push_back(Hash::of(words.data(), words.size() * sizeof(std::uint64_t)));
  std::vector<std::uint8_t> bytes(words.size() * sizeof(std::uint64_t));
  std::memcpy(bytes.data(), words.data(), bytes.size());
  writeFileAtomically(unfinishedFileOf(key), bytes);
}

std::optional<UnfinishedReference> ReferenceCache::load(const ReferenceKey& key,
                                                        const UnfinishedReference& wanted) const {
  const fs::path file = unfinishedFileOf(key);
  if (!fs::exists(file)) return std::nullopt;
  const std::vector<std::uint8_t> bytes = readFileBytes(file);
  std::vector<std::uint64_t> words(bytes.size() / sizeof(std::uint64_t));
  if (words.size() < 5) return std::nullopt;
  std::memcpy(words.data(), bytes.data(), words.size() * sizeof(std::uint64_t));
  if (words[0] != key.value || words[1] != wanted.first || words[2] != wanted.size ||
      words.back() != Hash::of(words.data(), (words.size() - 1) * sizeof(std::uint64_t)))
    return std::nullopt;
  std::vector<double> state;
  for (std::size_t i = 4; i + 1 < words.size(); ++i) state.push_back(std::bit_cast<double>(words[i]));
  const std::optional<BatchMean> mean = BatchMean::fromState(state);
  if (!mean || mean->batches() >= SamplingGoal::kBatches) return std::nullopt;
  return UnfinishedReference{wanted.first, wanted.size, std::bit_cast<double>(words[3]), *mean};
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
  const std::uint64_t first = known ? known->samples : 0;
  std::optional<Reference> more;
  if (goal.samples > 0) {
    UnfinishedReference unfinished{.first = first, .size = batchSize(rest.samples)};
    unfinished = cache.load(key, unfinished).value_or(unfinished);
    more = sampleReference(sampler, transport, first, rest, stop, &unfinished);
    if (unfinished.mean.batches() < SamplingGoal::kBatches) {
      if (unfinished.mean.batches() > 0) cache.store(key, unfinished);
      return known;
    }
  } else {
    more = sampleReference(sampler, transport, first, rest, stop);
  }
  if (!more) return known;
  more->renderer = renderer;
  const Reference result = known ? merged(*known, *more) : *more;
  cache.store(key, result);
  return result;
}

}  // namespace lucerna::measure
