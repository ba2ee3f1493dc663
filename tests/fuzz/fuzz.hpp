// What the fuzz targets share. A target gives the fuzzer's bytes to one parser: it must take them or throw
// Error(badInput) in one go. Any other exception, a crash, a hang, a sanitizer's finding, or memory beyond the limit
// that tests/fuzz/run sets is a finding.
#pragma once

#include "base/error.hpp"
#include "base/log.hpp"

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <string_view>
#include <unistd.h>

namespace lucerna::fuzz {

/// A folder in memory of this process alone; left behind when it ends (tests/fuzz/run removes it).
inline const std::filesystem::path& folder() {
  static const std::filesystem::path path = [] {
    setLogLevel(LogLevel::quiet);
    const char* base = std::getenv("LUCERNA_FUZZ_FOLDER");
    std::filesystem::path p =
        std::filesystem::path(base ? base : "/dev/shm") / ("lucerna-fuzz-" + std::to_string(::getpid()));
    std::filesystem::create_directories(p);
    return p;
  }();
  return path;
}

inline std::filesystem::path write(std::string_view name, std::string_view content) {
  const std::filesystem::path file = folder() / name;
  std::ofstream(file, std::ios::binary | std::ios::trunc)
      .write(content.data(), static_cast<std::streamsize>(content.size()));
  return file;
}

inline std::string_view textOf(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

/// Runs a parser; only Error(badInput) may come out of it.
template <class Parse>
int parse(Parse&& run) {
  clearLoggedWarnings();
  try {
    run();
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::badInput) throw;
  }
  return 0;
}

}  // namespace lucerna::fuzz
