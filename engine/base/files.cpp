// Reads and writes whole files. Writing uses a temporary file and rename(2), which replaces a file atomically if
// both names are on one file system; so the temporary file is in the target's folder.
#include "base/files.hpp"

#include "base/error.hpp"
#include "base/hash.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstring>
#include <fstream>
#include <mutex>
#include <set>
#include <system_error>

namespace lucerna {

namespace fs = std::filesystem;

namespace {

template <class Container>
Container readWhole(const fs::path& file) {
  std::error_code error;
  if (fs::is_directory(file, error)) throwBadInput("{}: is a folder, expected a file", file.string());
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throwCannotOpen(file, errno);
  Container content;
  // Read in chunks, as pipes have no size; the first chunk holds all of a regular file, plus one byte to detect its
  // end.
  std::size_t chunk = 1u << 20, used = 0;
  if (const std::uintmax_t size = fs::file_size(file, error); !error) chunk = static_cast<std::size_t>(size) + 1;
  for (; stream; chunk = 1u << 20) {
    content.resize(used + chunk);
    stream.read(reinterpret_cast<char*>(content.data()) + used, static_cast<std::streamsize>(chunk));
    used += static_cast<std::size_t>(stream.gcount());
  }
  if (stream.bad()) throwBadInput("{}: cannot be read: {}", file.string(), std::strerror(errno));
  content.resize(used);
  return content;
}

/// Prefix of this machine's temporary files: process numbers mean nothing on another machine or in another container.
const std::string& temporaryPrefix() {
  static const std::string prefix = [] {
    char name[256] = {};
    ::gethostname(name, sizeof name - 1);
    struct stat processes {};
    ::stat("/proc/self/ns/pid", &processes);
    Hash hash;
    hash.add(std::string_view(name));
    hash.add(static_cast<std::uint64_t>(processes.st_ino));
    return fmt::format(".lucerna-{:08x}-", hash.value() & 0xffffffffu);
  }();
  return prefix;
}

/// Removes the temporary files that killed processes of this machine left in a folder. Runs once per folder and
/// process, before the first file is written there.
void sweepOnce(const fs::path& folder) {
  static std::mutex mutex;
  static std::set<std::string> swept;
  const std::lock_guard lock(mutex);
  std::error_code error;
  if (!swept.insert(fs::absolute(folder, error).string()).second) return;
  const std::string& prefix = temporaryPrefix();
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (!name.starts_with(prefix) || !name.ends_with(".tmp")) continue;
    pid_t process = 0;
    const auto [stop, failure] = std::from_chars(name.data() + prefix.size(), name.data() + name.size(), process);
    if (failure != std::errc() || *stop != '-' || process <= 0) continue;
    if (::kill(process, 0) == 0 || errno != ESRCH) continue;  // alive, and may be writing
    ::unlink(entry->path().c_str());
  }
}

/// Writes and closes; returns 0 or the errno of the first failure.
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
  // Network file systems may report a full disk only here.
  if (::close(descriptor) != 0 && failure == 0) failure = errno;
  return failure;
}

/// A name next to the file, from which it may be renamed. Throws if the file cannot be written.
fs::path temporaryFor(const fs::path& file) {
  if (!file.has_filename()) throwBadInput("'{}': cannot be written: expected a file name", file.string());
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  std::error_code error;
  const bool isFolder = fs::is_directory(folder, error);
  if (error && error != std::errc::no_such_file_or_directory && error != std::errc::not_a_directory)
    throwBadInput("{}: cannot be written: {}", file.string(), error.message());
  if (!isFolder) throwBadInput("{}: cannot be written: no such folder: {}", file.string(), folder.string());
  if (fs::is_directory(file, error)) throwBadInput("{}: cannot be written: is a folder", file.string());

  sweepOnce(folder);
  static std::atomic<unsigned> counter{0};
  return folder / fmt::format("{}{}-{}.tmp", temporaryPrefix(), ::getpid(), counter++);
}

void replaceFile(const fs::path& file, std::span<const std::uint8_t> bytes, bool durably) {
  const fs::path temporary = temporaryFor(file), folder = temporary.parent_path();
  int failure = writeAll(temporary, bytes, durably);
  if (failure == 0 && std::rename(temporary.c_str(), file.c_str()) != 0) failure = errno;
  if (failure != 0) {
    ::unlink(temporary.c_str());
    throwBadInput("{}: cannot be written: {}", file.string(), std::strerror(failure));
  }
  if (!durably) return;
  // The new name must survive a power cut too; a file system that cannot sync a folder cannot guarantee that.
  if (const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC); descriptor >= 0) {
    ::fsync(descriptor);
    ::close(descriptor);
  }
}

}  // namespace

void throwCannotOpen(const fs::path& file, int reason) {
  if (reason == ENOENT) throwBadInput("{}: no such file", file.string());
  if (reason == EMFILE || reason == ENFILE || reason == ENOMEM)
    throwMissingCapability("{}: cannot be opened: {}", file.string(), std::strerror(reason));
  throwBadInput("{}: cannot be opened: {}", file.string(), std::strerror(reason));
}

std::vector<std::uint8_t> readFileBytes(const fs::path& file) { return readWhole<std::vector<std::uint8_t>>(file); }

std::string readFileText(const fs::path& file) { return readWhole<std::string>(file); }

std::string textOf(const fs::path& file, std::span<const std::uint8_t> bytes) {
  std::string text;
  const auto begins = [&](int a, int b) { return bytes.size() >= 2 && bytes[0] == a && bytes[1] == b; };
  if (begins(0xff, 0xfe) || begins(0xfe, 0xff)) {
    const std::size_t high = begins(0xfe, 0xff) ? 0 : 1;
    const auto unit = [&](std::size_t i) { return std::uint32_t{bytes[i + high]} << 8 | bytes[i + 1 - high]; };
    for (std::size_t i = 2; i + 1 < bytes.size(); i += 2) {
      std::uint32_t code = unit(i);
      if (code >= 0xd800 && code < 0xdc00 && i + 3 < bytes.size()) {  // two units above U+FFFF
        code = 0x10000 + ((code - 0xd800) << 10) + (unit(i + 2) & 0x3ffu);
        i += 2;
      }
      const int more = code < 0x80 ? 0 : code < 0x800 ? 1 : code < 0x10000 ? 2 : 3;
      constexpr std::uint32_t kLead[] = {0, 0xc0, 0xe0, 0xf0};
      text += static_cast<char>(kLead[more] | code >> (6 * more));
      for (int k = more; k-- > 0;) text += static_cast<char>(0x80u | (code >> (6 * k) & 0x3fu));
    }
  } else {
    const bool mark = begins(0xef, 0xbb) && bytes.size() >= 3 && bytes[2] == 0xbf;
    text.assign(bytes.begin() + (mark ? 3 : 0), bytes.end());
  }
  if (text.find('\0') != std::string::npos)
    throwBadInput("{}: binary data, expected text in UTF-8, or UTF-16 with a byte order mark", file.string());
  return text;
}

void checkWritable(const fs::path& file) {
  const fs::path temporary = temporaryFor(file);
  const int failure = writeAll(temporary, {}, false);
  ::unlink(temporary.c_str());
  if (failure != 0) throwBadInput("{}: cannot be written: {}", file.string(), std::strerror(failure));
}

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
