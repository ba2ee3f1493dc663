// References: pictures of one transport with many samples and their standard errors, cached on disk (no GL: the sampler
// is passed in).
#pragma once

#include "base/image.hpp"
#include "scene/scene.hpp"
#include "scene/transport.hpp"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace lucerna::measure {

/// The mean picture of `samples` paths per pixel, numbered from `first`: different numbers give independent pictures,
/// equal ones the same picture.
using Sampler = std::function<Image(std::uint64_t first, std::uint32_t samples)>;

struct Reference {
  Transport transport = Transport::all;
  Image mean;
  Image standardError;  ///< of each pixel and channel
  double meanError = 0.0;  ///< standard error of the mean over pixels and channels
  std::uint64_t samples = 0;  ///< paths per pixel
  double seconds = 0.0;  ///< spent on it
  std::string renderer;  ///< of the sampler
};

/// Mean and standard errors from batches of equal size, each a separate picture: correlation within a batch does not
/// bias the error.
class BatchMean {
 public:
  void add(const Image& batch);
  int batches() const { return batches_; }
  /// At least two batches.
  Image mean() const;
  Image standardError() const;
  double meanError() const;

  /// Everything that add() goes on from, as numbers for a file, and back. Empty if the numbers are no such state.
  std::vector<double> state() const;
  static std::optional<BatchMean> fromState(const std::vector<double>& state);

 private:
  int width_ = 0, height_ = 0, batches_ = 0;
  std::vector<glm::dvec3> sum_, squares_;  // Welford: mean, sum of squared deviations
  double meanOfMeans_ = 0.0, meanSquares_ = 0.0;
};

/// Two independent references as one, weighted by samples.
Reference merged(const Reference& a, const Reference& b);

struct SamplingGoal {
  std::uint64_t samples = 0;  ///< stop at this many per pixel; 0: by time
  double seconds = 60.0;  ///< stop after this time; at least kBatches batches of one sample are made
  static constexpr int kBatches = 16;
};

/// The batches so far of a reference by number of samples that was stopped.
struct UnfinishedReference {
  std::uint64_t first = 0;  ///< number of its first path
  std::uint32_t size = 0;  ///< samples per batch
  double seconds = 0.0;  ///< spent on it
  BatchMean mean{};
};

/// Samples from path number `first` until the goal is met. `stop` is called between batches; fewer than two batches
/// give no reference. `unfinished`, by number of samples only: what to go on from, and where a stop leaves off.
std::optional<Reference> sampleReference(const Sampler& sampler, Transport transport, std::uint64_t first,
                                         const SamplingGoal& goal, const std::function<bool()>& stop = {},
                                         UnfinishedReference* unfinished = nullptr);

/// Identity of a reference: the scene's content, view, size, transport, and the sampler (version and switches, as
/// text).
struct ReferenceKey {
  std::uint64_t value = 0;
  std::string name() const;  ///< 16 hexadecimal digits
};
ReferenceKey keyOf(const Scene& scene, const Camera& camera, glm::ivec2 size, Transport transport,
                   std::string_view sampler);

/// References in a folder, one file each, written completely or not at all and checked when read.
class ReferenceCache {
 public:
  /// Creates the folder; throws Error(badInput) if it cannot.
  explicit ReferenceCache(std::filesystem::path folder);
  /// Empty if there is none; a damaged file gives one warning and counts as none.
  std::optional<Reference> load(const ReferenceKey& key) const;
  void store(const ReferenceKey& key, const Reference& reference) const;
  std::filesystem::path fileOf(const ReferenceKey& key) const;
  /// Its own file beside the reference's, removed by store() of the reference. load: empty too if the stored one
  /// begins at another path or has batches of another size than `wanted`.
  std::optional<UnfinishedReference> load(const ReferenceKey& key, const UnfinishedReference& wanted) const;
  void store(const ReferenceKey& key, const UnfinishedReference& unfinished) const;

  /// LUCERNA_REFERENCES, else XDG_CACHE_HOME/lucerna, else ~/.cache/lucerna.
  static std::filesystem::path defaultFolder();

 private:
  std::filesystem::path unfinishedFileOf(const ReferenceKey& key) const;

  std::filesystem::path folder_;
};

/// From the cache if it meets the goal; otherwise sampled further and stored. A stop keeps what there is: by time a
/// reference of fewer samples, by number of samples the batches so far, from which the next call goes on to the bits
/// of one that was not stopped. Empty if stopped without any reference.
std::optional<Reference> obtainReference(const ReferenceCache& cache, const ReferenceKey& key, const Sampler& sampler,
                                         Transport transport, const SamplingGoal& goal, const std::string& renderer,
                                         const std::function<bool()>& stop = {});

}  // namespace lucerna::measure
