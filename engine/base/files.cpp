// Whole files in and out. Writing goes through a temporary file and rename(2), which replaces a file in one step as long as
// both names are on one file system; that is why the temporary file lies beside its target.
#include "base/files.hpp"

#include "base/error.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>

namespace lucerna {

namespace fs = std::filesystem;

namespace {

template <class Container>
Container readWhole(const fs::path& file) {
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (!fs::exists(status)) throwBadInput("{}: no such file", file.string());
  if (fs::is_directory(status)) throwBadInput("{}: is a folder, expected a file", file.string());
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throwBadInput("{}: cannot be opened: {}", file.string(), std::strerror(errno));
  Container content;
  // Pieces rather than the size asked beforehand: pipes and the like have none.
  constexpr std::size_t kPiece = 1u << 20;
  std::size_t used = 0;
  while (stream) {
    content.resize(used + kPiece);
    stream.read(reinterpret_cast<char*>(content.data()) + used, static_cast<std::streamsize>(kPiece));
    used += static_cast<std::size_t>(stream.gcount());
  }
  if (stream.bad()) throwBadInput("{}: cannot be read: {}", file.string(), std::strerror(errno));
  content.resize(used);
  return content;
}

/// Writes and closes; returns 0 or the errno of what failed first.
int writeAll(const fs::path& file, std::span<const std::uint8_t> bytes, bool durably) {
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (descriptor < 0) return errno;
  int failure = 0;
  while (!bytes.empty() && failure == 0) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written >= 0) bytes = bytes.subspan(static_cast<std::size_t>(written));
    else if (errno != EINTR) failure = errno;
  }
  if (durably && failure == 0 && ::fsync(descriptor) != 0) failure = errno;
  // Network file systems may tell of a full disk only here.
  if (::close(descriptor) != 0 && failure == 0) failure = errno;
  return failure;
}

void replaceFile(const fs::path& file, std::span<const std::uint8_t> bytes, bool durably) {
  if (!file.has_filename()) throwBadInput("'{}': cannot be written: expected a file name", file.string());
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  std::error_code error;
  if (!fs::is_directory(folder, error)) throwBadInput("{}: cannot be written: there is no folder {}", file.string(), folder.string());
  if (fs::is_directory(file, error)) throwBadInput("{}: cannot be written: it is a folder", file.string());

  static std::atomic<unsigned> counter{0};
  const fs::path temporary = folder / fmt::format(".lucerna-{}-{}.tmp", ::getpid(), counter++);
  int failure = writeAll(temporary, bytes, durably);
  if (failure == 0 && std::rename(temporary.c_str(), file.c_str()) != 0) failure = errno;
  if (failure != 0) {
    ::unlink(temporary.c_str());
    throwBadInput("{}: cannot be written: {}", file.string(), std::strerror(failure));
  }
  if (!durably) return;
  // The new name too must survive a power cut; a file system that cannot sync a folder has nothing more to offer.
  if (const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC); descriptor >= 0) {
    ::fsync(descriptor);
    ::close(descriptor);
  }
}

}  // namespace

std::vector<std::uint8_t> readFileBytes(const fs::path& file) { return readWhole<std::vector<std::uint8_t>>(file); }

std::string readFileText(const fs::path& file) { return readWhole<std::string>(file); }

void writeFileAtomically(const fs::path& file, std::span<const std::uint8_t> bytes) { replaceFile(file, bytes, false); }

void writeFileDurably(const fs::path& file, std::span<const std::uint8_t> bytes) { replaceFile(file, bytes, true); }

void writeFileAtomically(const fs::path& file, std::string_view text) {
  writeFileAtomically(file, std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
}

std::string lowerExtension(const fs::path& file) {
  std::string extension = file.extension().string();
  for (char& c : extension)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return extension;
}

}  // namespace lucerna
