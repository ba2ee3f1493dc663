#include "radiosity/row_file.hpp"

#include "base/error.hpp"
#include "base/hash.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <numeric>
#include <span>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace lucerna {

namespace {

constexpr char kRowMagic[8] = {'L', 'U', 'C', 'R', 'O', 'W', 'S', '\n'};
constexpr std::uint32_t kRowVersion = 2;  // 2: rows depend on the visibility method

constexpr float kMostFactor = 1.01f;  // fractions of a hemisphere, with rounding

struct Header {
  char magic[8];
  std::uint32_t version, patches;
  std::uint64_t fingerprint;
};
struct BlockHeader {
  std::uint32_t first, rows;
  std::uint64_t entries, checksum;  ///< checksum over the rest of the block and the three previous fields
};

std::uint64_t checksumOf(const BlockHeader& header, std::span<const std::uint8_t> data) {
  Hash sum;
  sum.add(header.first);
  sum.add(header.rows);
  sum.add(header.entries);
  sum.bytes(data.data(), data.size());
  return sum.value();
}

std::size_t dataBytes(const BlockHeader& h) {
  return 12 * static_cast<std::size_t>(h.rows) + 8 * static_cast<std::size_t>(h.entries);
}

bool readAll(int descriptor, void* data, std::size_t bytes) {
  auto* at = static_cast<std::uint8_t*>(data);
  while (bytes > 0) {
    const ssize_t got = ::read(descriptor, at, bytes);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    at += got;
    bytes -= static_cast<std::size_t>(got);
  }
  return true;
}

}  // namespace

RowFile::RowFile(const std::filesystem::path& file, std::uint64_t fingerprint, std::uint32_t patches,
                 const std::function<void(const FormFactorRows&)>& take, std::uint32_t first)
    : file_(file), patches_(patches), first_(first) {
  descriptor_ = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (descriptor_ < 0) throwBadInput("{}: cannot be opened for writing: {}", file.string(), std::strerror(errno));
  const auto refuse = [&](const char* why) {
    ::close(descriptor_);
    descriptor_ = -1;
    throwBadInput("{}: {}; remove it to start over", file.string(), why);
  };
  struct stat status {};
  if (::fstat(descriptor_, &status) != 0 || !S_ISREG(status.st_mode)) refuse("is not a regular file");
  Header header{};
  if (status.st_size > 0) {
    if (!readAll(descriptor_, &header, sizeof header)) {
      // The file of a run killed before its first bytes were written, or a foreign file: overwrite only a prefix of our
      // own magic.
      char start[sizeof kRowMagic] = {};
      const auto got = static_cast<std::size_t>(std::max<ssize_t>(::pread(descriptor_, start, sizeof start, 0), 0));
      if (std::memcmp(start, kRowMagic, got) != 0) refuse("is not a checkpoint of radiosity");
      header = {};
    } else {
      if (std::memcmp(header.magic, kRowMagic, sizeof kRowMagic) != 0) refuse("is not a checkpoint of radiosity");
      if (header.version != kRowVersion) refuse("is a checkpoint of another version of this program");
      if (header.fingerprint != fingerprint || header.patches != patches)
        refuse("is the checkpoint of another scene or of other settings");
    }
  }
  end_ = header.version ? sizeof(Header) : 0;
  if (end_ > 0) {
    std::uint32_t expected = first_;
    while (const auto rows = readBlock(expected, end_)) {
      take(*rows);
      expected += static_cast<std::uint32_t>(rows->counts.size());
    }
  }
  if (::ftruncate(descriptor_, static_cast<off_t>(end_)) != 0)
    throwBadInput("{}: {}", file.string(), std::strerror(errno));
  ::lseek(descriptor_, static_cast<off_t>(end_), SEEK_SET);
  if (end_ == 0) {
    std::memcpy(header.magic, kRowMagic, sizeof kRowMagic);
    header.version = kRowVersion;
    header.patches = patches;
    header.fingerprint = fingerprint;
    if (::write(descriptor_, &header, sizeof header) != static_cast<ssize_t>(sizeof header))
      refuse("cannot be written: is the disk full?");
    end_ = sizeof header;
  }
}

std::optional<FormFactorRows> RowFile::readBlock(std::uint32_t expected, std::uint64_t& end) {
  struct stat status {};
  BlockHeader block{};
  if (::fstat(descriptor_, &status) != 0 || !readAll(descriptor_, &block, sizeof block) || block.first != expected ||
      block.rows == 0 || block.rows > patches_ - expected ||
      block.entries > static_cast<std::uint64_t>(status.st_size) ||
      block.entries > static_cast<std::uint64_t>(block.rows) * patches_ ||
      end + sizeof block + dataBytes(block) > static_cast<std::uint64_t>(status.st_size))
    return std::nullopt;
  std::vector<std::uint8_t> data(dataBytes(block));
  if (!readAll(descriptor_, data.data(), data.size()) || checksumOf(block, data) != block.checksum) return std::nullopt;
  FormFactorRows rows;
  rows.first = static_cast<int>(block.first);
  const std::uint8_t* at = data.data();
  const auto get = [&](auto& values, std::size_t count) {
    values.resize(count);
    if (count > 0) std::memcpy(values.data(), at, 4 * count);
    at += 4 * count;
  };
  get(rows.counts, block.rows);
  get(rows.fronts, block.rows);
  get(rows.backs, block.rows);
  get(rows.patches, block.entries);
  get(rows.factors, block.entries);
  // The checksum detects damage; this detects files that something else wrote.
  if (std::accumulate(rows.counts.begin(), rows.counts.end(), std::uint64_t{0}) != block.entries) return std::nullopt;
  for (std::size_t i = 0; i < rows.patches.size(); ++i)
    if (rows.patches[i] >= patches_ || !(rows.factors[i] >= 0.0f && rows.factors[i] <= kMostFactor))
      return std::nullopt;
  for (std::size_t i = 0; i < rows.fronts.size(); ++i)
    if (!(rows.fronts[i] >= 0.0f && rows.backs[i] >= 0.0f && rows.fronts[i] + rows.backs[i] <= kMostFactor))
      return std::nullopt;
  end += sizeof block + data.size();
  return rows;
}

void RowFile::forEach(const std::function<void(const FormFactorRows&)>& take) {
  ::lseek(descriptor_, sizeof(Header), SEEK_SET);
  std::uint32_t expected = first_;
  for (std::uint64_t at = sizeof(Header); at < end_;) {
    const auto rows = readBlock(expected, at);
    if (!rows)
      throwBadInput("{}: was changed or damaged by another program while rows were read from it", file_.string());
    expected += static_cast<std::uint32_t>(rows->counts.size());
    take(*rows);
  }
}

std::optional<std::uint64_t> RowFile::fingerprintOf(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  Header header{};
  if (!stream.read(reinterpret_cast<char*>(&header), sizeof header) ||
      std::memcmp(header.magic, kRowMagic, sizeof kRowMagic) != 0 || header.version != kRowVersion)
    return std::nullopt;
  return header.fingerprint;
}

void joinRowFiles(const std::vector<std::pair<std::uint32_t, std::filesystem::path>>& parts,
                  const std::filesystem::path& whole) {
  CHECK(!parts.empty(), "no parts of rows");
  Header header{};
  std::ifstream stream(parts.front().second, std::ios::binary);
  if (!stream.read(reinterpret_cast<char*>(&header), sizeof header) ||
      std::memcmp(header.magic, kRowMagic, sizeof kRowMagic) != 0 || header.version != kRowVersion)
    throwBadInput("{}: is not a checkpoint of radiosity", parts.front().second.string());
  std::filesystem::path draft = whole;
  draft += ".joining";
  std::error_code ignored;
  std::filesystem::remove(draft, ignored);
  try {
    RowFile all(draft, header.fingerprint, header.patches, [](const FormFactorRows&) {});
    std::uint32_t next = 0;
    for (const auto& [first, file] : parts) {
      if (first != next)
        throwBadInput("{}: begins with row {}, and the rows before it end with {}", file.string(), first, next);
      RowFile(
          file, header.fingerprint, header.patches,
          [&](const FormFactorRows& rows) {
            all.append(rows);
            next += static_cast<std::uint32_t>(rows.counts.size());
          },
          first);
    }
    if (next != header.patches)
      throwBadInput("{}: the rows end with {} of {}", parts.back().second.string(), next, header.patches);
  } catch (...) {
    std::filesystem::remove(draft, ignored);
    throw;
  }
  std::filesystem::rename(draft, whole);
}

RowFile::~RowFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void RowFile::append(const FormFactorRows& rows) {
  struct stat here {
  }, there{};
  if (::fstat(descriptor_, &here) != 0 || ::stat(file_.c_str(), &there) != 0 || here.st_ino != there.st_ino ||
      here.st_dev != there.st_dev || static_cast<std::uint64_t>(here.st_size) != end_)
    throwBadInput("{}: was changed or replaced by another program while rows were written to it; it is left unchanged",
                  file_.string());
  BlockHeader block{static_cast<std::uint32_t>(rows.first), static_cast<std::uint32_t>(rows.counts.size()),
                    rows.patches.size(), 0};
  std::vector<std::uint8_t> bytes(sizeof block + dataBytes(block));
  std::uint8_t* at = bytes.data() + sizeof block;
  const auto put = [&](const auto& values) {
    if (!values.empty()) std::memcpy(at, values.data(), 4 * values.size());
    at += 4 * values.size();
  };
  put(rows.counts);
  put(rows.fronts);
  put(rows.backs);
  put(rows.patches);
  put(rows.factors);
  block.checksum = checksumOf(block, std::span(bytes).subspan(sizeof block));
  std::memcpy(bytes.data(), &block, sizeof block);
  const std::uint8_t* from = bytes.data();
  for (std::size_t left = bytes.size(); left > 0;) {
    const ssize_t put_ = ::write(descriptor_, from, left);
    if (put_ < 0 && errno == EINTR) continue;
    if (put_ <= 0) {
      const std::string reason = std::strerror(put_ < 0 ? errno : ENOSPC);
      const bool cut = ::ftruncate(descriptor_, static_cast<off_t>(end_)) == 0;
      throwBadInput("{}: {}; it holds {} rows{}", file_.string(), reason, rows.first, cut ? "" : ", ignore its end");
    }
    from += put_;
    left -= static_cast<std::size_t>(put_);
  }
  end_ += bytes.size();
}

}  // namespace lucerna
