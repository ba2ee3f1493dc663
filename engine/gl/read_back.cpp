#include "gl/read_back.hpp"

#include "gl/wait.hpp"

namespace lucerna::gl {

ReadBackRing::ReadBackRing(const std::string& name, std::size_t bytes) : bytes_(bytes) {
  for (Buffer& buffer : buffers_) buffer = Buffer(name, bytes, nullptr, Usage::streamRead);
}

ReadBackRing::~ReadBackRing() {
  for (GLsync fence : fences_)
    if (fence) glDeleteSync(fence);
}

void ReadBackRing::copy(const Buffer& source) {
  if (fences_[next_]) return;
  source.copyTo(buffers_[next_], bytes_);
  fences_[next_] = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
  next_ = (next_ + 1) % kRing;
}

std::vector<GLuint> ReadBackRing::fetch(bool wait) {
  GLsync& fence = fences_[oldest_];
  if (!fence) return {};
  if (wait) waitFor(fence);
  else if (glClientWaitSync(fence, 0, 0) == GL_TIMEOUT_EXPIRED) return {};
  glDeleteSync(fence);
  fence = nullptr;
  const std::vector<GLuint> words = buffers_[oldest_].read<GLuint>();
  oldest_ = (oldest_ + 1) % kRing;
  return words;
}

void Staging::copy(const Buffer& source, std::size_t bytes) {
  if (buffer_.bytes() < bytes) buffer_ = Buffer(name_, bytes, nullptr, Usage::streamRead);
  source.copyTo(buffer_, bytes);
}

}  // namespace lucerna::gl
