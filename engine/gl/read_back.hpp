// Small buffers read back without waiting: copied into a ring as the frame goes, fetched when the GPU has got there.
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

  /// Copies the buffer's first bytes behind all work recorded so far. With the whole ring on its way the sample is dropped.
  void copy(const Buffer& source);
  /// The oldest sample as 32-bit words, in order; empty where it has not arrived. wait: it is waited for.
  std::vector<GLuint> fetch(bool wait);
  std::size_t bytes() const { return kRing * bytes_; }

 private:
  static constexpr std::size_t kRing = 4;
  std::array<Buffer, kRing> buffers_;
  std::array<GLsync, kRing> fences_{};
  std::size_t next_ = 0, oldest_ = 0, bytes_ = 0;
};

}  // namespace lucerna::gl
