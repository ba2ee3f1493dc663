#include "gl/objects.hpp"

#include "base/error.hpp"
#include "gl/context.hpp"
#include "gl/limits.hpp"

#include <algorithm>
#include <array>

namespace lucerna::gl {

namespace {

constexpr GLuint kEditUnit = 79;  // the last of the 80 combined units that 4.3 guarantees is 79; editing binds there

struct Format {
  GLenum internal, format, type;
  std::size_t bytes;
};

// One table of the formats in use; `format` and `type` serve uploads of zeros and read-backs.
constexpr std::array kFormats{
    Format{GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, 4},
    Format{GL_SRGB8_ALPHA8, GL_RGBA, GL_UNSIGNED_BYTE, 4},
    Format{GL_R8, GL_RED, GL_UNSIGNED_BYTE, 1},
    Format{GL_RGBA16F, GL_RGBA, GL_HALF_FLOAT, 8},
    Format{GL_RGBA32F, GL_RGBA, GL_FLOAT, 16},
    Format{GL_RGBA32UI, GL_RGBA_INTEGER, GL_UNSIGNED_INT, 16},
    Format{GL_R32F, GL_RED, GL_FLOAT, 4},
    Format{GL_R32I, GL_RED_INTEGER, GL_INT, 4},
    Format{GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, 4},
    Format{GL_RG32UI, GL_RG_INTEGER, GL_UNSIGNED_INT, 8},
    Format{GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT, GL_FLOAT, 4},
    Format{GL_DEPTH_COMPONENT24, GL_DEPTH_COMPONENT, GL_UNSIGNED_INT, 4},
};

const Format& formatOf(GLenum internalFormat) {
  for (const Format& f : kFormats)
    if (f.internal == internalFormat) return f;
  CHECK(false, "format {:#x} is not in the engine's table", internalFormat);
  return kFormats[0];
}

}  // namespace

void label(GLenum identifier, GLuint id, const std::string& name) {
  GLint most = 0;
  glGetIntegerv(GL_MAX_LABEL_LENGTH, &most);
  glObjectLabel(identifier, id, std::min(static_cast<GLint>(name.size()), most - 1), name.c_str());
}

std::size_t bytesPerTexel(GLenum internalFormat) { return formatOf(internalFormat).bytes; }

namespace detail {
void deleteBuffer(GLuint id) { glDeleteBuffers(1, &id); }
void deleteTexture(GLuint id) { glDeleteTextures(1, &id); }
void deleteFramebuffer(GLuint id) { glDeleteFramebuffers(1, &id); }
void deleteVertexArray(GLuint id) { glDeleteVertexArrays(1, &id); }
}  // namespace detail

// ---------------------------------------------------------------------------------------------------- Buffer

Buffer::Buffer(const std::string& name, std::size_t bytes, const void* data, GLenum usage) : bytes_(bytes) {
  GLuint id = 0;
  glGenBuffers(1, &id);
  handle_ = decltype(handle_)(id);
  glBindBuffer(GL_COPY_WRITE_BUFFER, id);
  label(GL_BUFFER, id, name);
  throwIfError("before " + name);
  glBufferData(GL_COPY_WRITE_BUFFER, static_cast<GLsizeiptr>(bytes), data, usage);
  throwIfNotAllocated(name, bytes);
}

void Buffer::upload(std::size_t offset, std::size_t bytes, const void* data) {
  CHECK(offset + bytes <= bytes_, "offset {} + {} bytes > {}", offset, bytes, bytes_);
  settle(GL_BUFFER_UPDATE_BARRIER_BIT);
  glBindBuffer(GL_COPY_WRITE_BUFFER, id());
  glBufferSubData(GL_COPY_WRITE_BUFFER, static_cast<GLintptr>(offset), static_cast<GLsizeiptr>(bytes), data);
}

void Buffer::clear(GLuint value) {
  settle(GL_BUFFER_UPDATE_BARRIER_BIT);
  glBindBuffer(GL_COPY_WRITE_BUFFER, id());
  glClearBufferData(GL_COPY_WRITE_BUFFER, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, &value);
}

void Buffer::bind(GLenum target, GLuint index) const {
  if (target == GL_SHADER_STORAGE_BUFFER) requireWithin(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, bytes_, GL_BUFFER, id());
  if (target == GL_UNIFORM_BUFFER) requireWithin(GL_MAX_UNIFORM_BLOCK_SIZE, bytes_, GL_BUFFER, id());
  shadersMayWrite_ = shadersMayWrite_ || target == GL_SHADER_STORAGE_BUFFER;
  glBindBufferBase(target, index, id());
}

void Buffer::settle(GLbitfield barrier) const {
  if (shadersMayWrite_) glMemoryBarrier(barrier);
}

void Buffer::copyTo(Buffer& target, std::size_t bytes) const {
  CHECK(bytes <= bytes_ && bytes <= target.bytes_, "{} bytes of {} into {}", bytes, bytes_, target.bytes_);
  settle(GL_BUFFER_UPDATE_BARRIER_BIT);
  target.settle(GL_BUFFER_UPDATE_BARRIER_BIT);
  glBindBuffer(GL_COPY_READ_BUFFER, id());
  glBindBuffer(GL_COPY_WRITE_BUFFER, target.id());
  glCopyBufferSubData(GL_COPY_READ_BUFFER, GL_COPY_WRITE_BUFFER, 0, 0, static_cast<GLsizeiptr>(bytes));
}

void Buffer::readBytes(void* data, std::size_t bytes) const {
  CHECK(bytes <= bytes_, "{} bytes of {}", bytes, bytes_);
  settle(GL_BUFFER_UPDATE_BARRIER_BIT);
  glBindBuffer(GL_COPY_READ_BUFFER, id());
  glGetBufferSubData(GL_COPY_READ_BUFFER, 0, static_cast<GLsizeiptr>(bytes), data);
  throwIfError("a buffer was read back");
}

// ---------------------------------------------------------------------------------------------------- Texture

Texture::Texture(const std::string& name, GLenum internalFormat, glm::ivec2 size, const Sampling& sampling, int levels)
    : target_(GL_TEXTURE_2D), format_(internalFormat), size_(size, 1), levels_(levels) {
  create(name, sampling);
}

Texture::Texture(const std::string& name, GLenum internalFormat, glm::ivec3 size, const Sampling& sampling, int levels,
                 GLenum target)
    : target_(target), format_(internalFormat), size_(size), levels_(levels) {
  create(name, sampling);
}

void Texture::create(const std::string& name, const Sampling& s) {
  CHECK(size_.x > 0 && size_.y > 0 && size_.z > 0, "texture {}: {}x{}x{}", name, size_.x, size_.y, size_.z);
  requireWithin(target_ == GL_TEXTURE_3D ? GL_MAX_3D_TEXTURE_SIZE : GL_MAX_TEXTURE_SIZE,
                static_cast<std::size_t>(std::max(size_.x, size_.y)), name);
  if (target_ != GL_TEXTURE_2D)
    requireWithin(target_ == GL_TEXTURE_3D ? GL_MAX_3D_TEXTURE_SIZE : GL_MAX_ARRAY_TEXTURE_LAYERS,
                  static_cast<std::size_t>(size_.z), name);
  throwIfError("before " + name);
  GLuint id = 0;
  glGenTextures(1, &id);
  handle_ = decltype(handle_)(id);
  glActiveTexture(GL_TEXTURE0 + kEditUnit);
  glBindTexture(target_, id);
  label(GL_TEXTURE, id, name);
  if (target_ == GL_TEXTURE_2D) glTexStorage2D(target_, levels_, format_, size_.x, size_.y);
  else glTexStorage3D(target_, levels_, format_, size_.x, size_.y, size_.z);
  throwIfNotAllocated(name, bytes());
  const auto parameter = [&](GLenum key, GLenum value) { glTexParameteri(target_, key, static_cast<GLint>(value)); };
  parameter(GL_TEXTURE_MIN_FILTER, s.minFilter);
  parameter(GL_TEXTURE_MAG_FILTER, s.magFilter);
  parameter(GL_TEXTURE_WRAP_S, s.wrap);
  parameter(GL_TEXTURE_WRAP_T, s.wrap);
  parameter(GL_TEXTURE_WRAP_R, s.wrap);
  glTexParameterfv(target_, GL_TEXTURE_BORDER_COLOR, &s.border.x);
  if (s.anisotropy > 1.0f) glTexParameterf(target_, GL_TEXTURE_MAX_ANISOTROPY_EXT, s.anisotropy);
  if (s.depthCompare) {
    parameter(GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
    parameter(GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
  }
}

glm::ivec3 Texture::levelSize(int level) const {
  glm::ivec3 size = glm::max(size_ >> level, glm::ivec3(1));
  if (target_ == GL_TEXTURE_2D_ARRAY) size.z = size_.z;  // layers stay
  return size;
}

std::size_t Texture::bytes() const {
  if (!id()) return 0;
  std::size_t texels = 0;
  for (int level = 0; level < levels_; ++level) {
    const glm::ivec3 size = levelSize(level);
    texels += static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) * static_cast<std::size_t>(size.z);
  }
  return texels * bytesPerTexel(format_);
}

void Texture::upload(GLenum format, GLenum type, const void* data, int level) {
  settle(GL_TEXTURE_UPDATE_BARRIER_BIT);
  glActiveTexture(GL_TEXTURE0 + kEditUnit);
  glBindTexture(target_, id());
  const glm::ivec3 size = levelSize(level);
  if (target_ == GL_TEXTURE_2D) glTexSubImage2D(target_, level, 0, 0, size.x, size.y, format, type, data);
  else glTexSubImage3D(target_, level, 0, 0, 0, size.x, size.y, size.z, format, type, data);
}

void Texture::copyFrom(const Buffer& buffer, std::size_t offset) {
  const Format& format = formatOf(format_);
  CHECK(levels_ == 1 && offset + bytes() <= buffer.bytes(), "{} bytes at {} of {}", bytes(), offset, buffer.bytes());
  buffer.settle(GL_PIXEL_BUFFER_BARRIER_BIT);
  glBindBuffer(GL_PIXEL_UNPACK_BUFFER, buffer.id());
  upload(format.format, format.type, reinterpret_cast<const void*>(offset));
  glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
}

void Texture::generateMipmaps() {
  settle(GL_TEXTURE_UPDATE_BARRIER_BIT);
  glActiveTexture(GL_TEXTURE0 + kEditUnit);
  glBindTexture(target_, id());
  glGenerateMipmap(target_);
}

void Texture::bind(GLuint unit) const {
  glActiveTexture(GL_TEXTURE0 + unit);
  glBindTexture(target_, id());
}

void Texture::bindImage(GLuint unit, GLenum access, int level) const {
  shadersMayWrite_ = shadersMayWrite_ || access != GL_READ_ONLY;
  glBindImageTexture(unit, id(), level, target_ == GL_TEXTURE_2D ? GL_FALSE : GL_TRUE, 0, access, format_);
}

void Texture::settle(GLbitfield barrier) const {
  if (shadersMayWrite_) glMemoryBarrier(barrier);
}

std::vector<glm::vec4> Texture::readRgba(int level) const {
  settle(GL_TEXTURE_UPDATE_BARRIER_BIT);
  const glm::ivec3 size = levelSize(level);
  std::vector<glm::vec4> texels(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) *
                                static_cast<std::size_t>(size.z));
  glActiveTexture(GL_TEXTURE0 + kEditUnit);
  glBindTexture(target_, id());
  glGetTexImage(target_, level, GL_RGBA, GL_FLOAT, texels.data());
  throwIfError("a texture was read back");
  return texels;
}

std::vector<float> Texture::readDepth() const {
  std::vector<float> texels(static_cast<std::size_t>(size_.x) * static_cast<std::size_t>(size_.y) *
                            static_cast<std::size_t>(size_.z));
  glActiveTexture(GL_TEXTURE0 + kEditUnit);
  glBindTexture(target_, id());
  glGetTexImage(target_, 0, GL_DEPTH_COMPONENT, GL_FLOAT, texels.data());
  throwIfError("a depth texture was read back");
  return texels;
}

std::vector<glm::uvec4> Texture::readWords() const {
  CHECK(format_ == GL_RGBA32UI, "format {:#x}", format_);
  settle(GL_TEXTURE_UPDATE_BARRIER_BIT);
  std::vector<glm::uvec4> words(static_cast<std::size_t>(size_.x) * static_cast<std::size_t>(size_.y) *
                                static_cast<std::size_t>(size_.z));
  glActiveTexture(GL_TEXTURE0 + kEditUnit);
  glBindTexture(target_, id());
  glGetTexImage(target_, 0, GL_RGBA_INTEGER, GL_UNSIGNED_INT, words.data());
  throwIfError("a film was read back");
  return words;
}

BufferTexture::BufferTexture(const std::string& name, GLenum format, std::size_t bytes, const void* data, GLenum usage)
    : buffer_(name, bytes, data, usage) {
  requireWithin(GL_MAX_TEXTURE_BUFFER_SIZE, bytes / bytesPerTexel(format), name);
  GLuint id = 0;
  glGenTextures(1, &id);
  texture_ = decltype(texture_)(id);
  glActiveTexture(GL_TEXTURE0 + kEditUnit);
  glBindTexture(GL_TEXTURE_BUFFER, id);
  label(GL_TEXTURE, id, name);
  glTexBuffer(GL_TEXTURE_BUFFER, format, buffer_.id());
  throwIfError(name);
}

void BufferTexture::bind(GLuint unit) const {
  glActiveTexture(GL_TEXTURE0 + unit);
  glBindTexture(GL_TEXTURE_BUFFER, texture_.id());
}

void copyTexels(const Texture& from, glm::ivec2 fromCorner, const Texture& to, glm::ivec2 toCorner, glm::ivec2 size) {
  CHECK(from.format() == to.format(), "formats {:#x} and {:#x}", from.format(), to.format());
  glCopyImageSubData(from.id(), from.target(), 0, fromCorner.x, fromCorner.y, 0, to.id(), to.target(), 0, toCorner.x,
                     toCorner.y, 0, size.x, size.y, 1);
}

void clearToZero(std::span<const Texture* const> textures, bool haveClearTexture) {
  std::vector<std::byte> zeros;
  for (const Texture* texture : textures) {
    const Format& format = formatOf(texture->format());
    texture->settle(GL_TEXTURE_UPDATE_BARRIER_BIT);
    if (!haveClearTexture) zeros.resize(std::max(zeros.size(), texture->bytes()), std::byte{0});
    for (int level = 0; level < texture->levels(); ++level) {
      if (haveClearTexture) glClearTexImage(texture->id(), level, format.format, format.type, nullptr);
      else const_cast<Texture*>(texture)->upload(format.format, format.type, zeros.data(), level);
    }
  }
}

// ---------------------------------------------------------------------------------------------------- Framebuffer

Framebuffer::Framebuffer(const std::string& name, std::span<const Texture* const> colors, const Texture* depth) {
  GLuint id = 0;
  glGenFramebuffers(1, &id);
  handle_ = decltype(handle_)(id);
  glBindFramebuffer(GL_FRAMEBUFFER, id);
  label(GL_FRAMEBUFFER, id, name);
  std::vector<GLenum> buffers;
  for (const Texture* color : colors) {
    const auto attachment = static_cast<GLenum>(GL_COLOR_ATTACHMENT0 + buffers.size());
    glFramebufferTexture(GL_FRAMEBUFFER, attachment, color->id(), 0);
    buffers.push_back(attachment);
    size_ = color->size2d();
  }
  if (depth) {
    glFramebufferTexture(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, depth->id(), 0);
    size_ = depth->size2d();
  }
  if (buffers.empty()) {
    glDrawBuffer(GL_NONE);
    glReadBuffer(GL_NONE);
  } else {
    glDrawBuffers(static_cast<GLsizei>(buffers.size()), buffers.data());
  }
  const GLenum status = glCheckFramebufferStatus(GL_FRAMEBUFFER);
  throwIfError(name);
  if (status != GL_FRAMEBUFFER_COMPLETE)
    throwMissingCapability("framebuffer {}: this driver cannot draw into it (status {:#x})", name, status);
}

// ---------------------------------------------------------------------------------------------------- VertexArray

VertexArray::VertexArray(const std::string& name) {
  GLuint id = 0;
  glGenVertexArrays(1, &id);
  handle_ = decltype(handle_)(id);
  glBindVertexArray(id);
  label(GL_VERTEX_ARRAY, id, name);
}

VertexArray::VertexArray(const std::string& name, const Buffer& vertices, std::size_t stride,
                         std::span<const Attribute> attributes, const Buffer* indices)
    : VertexArray(name) {
  glBindBuffer(GL_ARRAY_BUFFER, vertices.id());
  for (const Attribute& a : attributes) {
    glEnableVertexAttribArray(a.location);
    glVertexAttribPointer(a.location, a.components, GL_FLOAT, GL_FALSE, static_cast<GLsizei>(stride),
                          reinterpret_cast<const void*>(a.offset));
  }
  if (indices) glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices->id());
  glBindVertexArray(0);
}

void VertexArray::bind() const { glBindVertexArray(id()); }

}  // namespace lucerna::gl
