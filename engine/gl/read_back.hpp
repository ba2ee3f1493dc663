// Reads shader results on the CPU through separate buffers: a driver moves a buffer that the CPU reads repeatedly into
// host memory, where shader writes are slow. ReadBackRing: small buffers without waiting, copied into a ring during the
// frame and fetched when they have arrived. Staging: waits.
#pragma once

#include "gl/objects.hpp"

#include <array>
#include <string>
#include <vector>

namespace lucerna::gl {

class ReadBackRing {
 public:
  ReadBackRing() = default;
  ReadBackRing(const std::string& name, std::size_t bytes);
  ~ReadBackRing();
  ReadBackRing(const ReadBackRing&) = delete;
  ReadBackRing& operator=(const ReadBackRing&) = delete;

  /// Copies the buffer's first bytes after all work recorded so far. If the ring is full, the sample is dropped.
  void copy(const Buffer& source);
  /// The oldest sample as 32-bit words, in order; empty if it has not arrived. wait: waits for it.
  std::vector<GLuint> fetch(bool wait);
  std::size_t bytes() const { return kRing * bytes_; }

 private:
  static constexpr std::size_t kRing = 4;
  std::array<Buffer, kRing> buffers_;
  std::array<GLsync, kRing> fences_{};
  std::size_t next_ = 0, oldest_ = 0, bytes_ = 0;
};

class Staging {
 public:
  Staging() = default;
  explicit Staging(const std::string& name) : name_(name) {}

  /// The first `count` values of a buffer, after all work recorded so far; waits for it.
  template <class T>
  std::vector<T> read(const Buffer& source, std::size_t count) {
    std::vector<T> values;
    if (count == 0) return values;
    copy(source, count * sizeof(T));
    return buffer_.read<T>(count);
  }
  template <class T>
  T readFirst(const Buffer& source) {
    copy(source, sizeof(T));
    return buffer_.readFirst<T>();
  }
  std::size_t bytes() const { return buffer_.bytes(); }

 private:
  void copy(const Buffer& source, std::size_t bytes);  // grows to the largest size requested
  std::string name_;
  Buffer buffer_;
};

}  // namespace lucerna::gl
