#include "radiosity/original/checkpoint.hpp"

#include "base/error.hpp"
#include "base/files.hpp"
#include "base/hash.hpp"

#include <cmath>
#include <cstring>

namespace lucerna {

namespace {

constexpr char kMagic[8] = {'L', 'U', 'C', 'R', 'A', 'D', 'S', 'W'};
constexpr std::uint32_t kVersion = 1;

struct Head {
  char magic[8];
  std::uint32_t version, sweeps;
  std::uint64_t before, after, settings, count, done;
  double change;
};
static_assert(sizeof(Head) == 64);

}  // namespace

std::uint64_t digestOf(std::span<const std::uint8_t> bytes) { return Hash::of(bytes.data(), bytes.size()); }

std::uint64_t digestOf(const OriginalRadiosity::Settings& s, double nearPlane, const std::string& renderer) {
  std::string text = fmt::format("{} {} {:.17g} {} {}", s.view, s.gaussSeidel, nearPlane, s.seed, renderer);
  for (const RadiosityDeviation& deviation : allRadiosityDeviations())
    text += s.deviations.*deviation.member ? '1' : '0';
  return digestOf(std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
}

std::filesystem::path checkpointOf(const std::filesystem::path& out) { return out.string() + ".sweep"; }

void writeCheckpoint(const std::filesystem::path& file, const OriginalCheckpoint& c) {
  const OriginalProgress& p = c.progress;
  Head head{};
  std::memcpy(head.magic, kMagic, sizeof kMagic);
  head.version = kVersion, head.sweeps = p.sweeps;
  head.before = c.before, head.after = c.after, head.settings = c.settings;
  head.count = p.received.size(), head.done = p.done, head.change = p.change;
  const std::size_t values = p.received.size() * sizeof(float), done = p.done * sizeof(float);
  std::vector<std::uint8_t> bytes(sizeof head + values + done + sizeof(std::uint64_t));
  std::memcpy(bytes.data(), &head, sizeof head);
  std::memcpy(bytes.data() + sizeof head, p.received.data(), values);
  std::memcpy(bytes.data() + sizeof head + values, p.next.data(), done);
  const std::uint64_t digest = digestOf(std::span(bytes).first(bytes.size() - sizeof digest));
  std::memcpy(bytes.data() + bytes.size() - sizeof digest, &digest, sizeof digest);
  writeFileDurably(file, bytes);
}

OriginalCheckpoint readCheckpoint(const std::filesystem::path& file) {
  const std::vector<std::uint8_t> bytes = readFileBytes(file);
  Head head{};
  if (bytes.size() < sizeof head + sizeof(std::uint64_t))
    throwBadInput("{}: has {} bytes, too few for a checkpoint", file.string(), bytes.size());
  std::memcpy(&head, bytes.data(), sizeof head);
  if (std::memcmp(head.magic, kMagic, sizeof kMagic) != 0)
    throwBadInput("{}: is not a checkpoint of this program", file.string());
  if (head.version != kVersion)
    throwBadInput("{}: is a checkpoint of version {}, expected {}", file.string(), head.version, kVersion);
  const std::size_t rest = bytes.size() - sizeof head - sizeof(std::uint64_t);
  if (head.count == 0 || head.count > rest || head.done > head.count ||
      (head.count + head.done) * sizeof(float) != rest)
    throwBadInput("{}: its header has {} values and {} done, which does not fit its {} bytes", file.string(),
                  head.count, head.done, bytes.size());
  std::uint64_t digest = 0;
  std::memcpy(&digest, bytes.data() + bytes.size() - sizeof digest, sizeof digest);
  if (digest != digestOf(std::span(bytes).first(bytes.size() - sizeof digest)))
    throwBadInput("{}: is damaged: wrong digest", file.string());
  OriginalCheckpoint c;
  c.before = head.before, c.after = head.after, c.settings = head.settings;
  c.progress.sweeps = head.sweeps, c.progress.done = head.done, c.progress.change = head.change;
  c.progress.received.resize(head.count);
  std::memcpy(c.progress.received.data(), bytes.data() + sizeof head, head.count * sizeof(float));
  c.progress.next = c.progress.received;
  std::memcpy(c.progress.next.data(), bytes.data() + sizeof head + head.count * sizeof(float),
              head.done * sizeof(float));
  return c;
}

}  // namespace lucerna
