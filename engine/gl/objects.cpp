#include "gl/objects.hpp"

#include "base/error.hpp"
#include "gl/barrier_ledger.hpp"
#include "gl/context.hpp"
#include "gl/limits.hpp"
#include "gl/wait.hpp"

#include <algorithm>
#include <array>

namespace lucerna::gl {

namespace {

constexpr GLuint kEditUnit = 79;  // the last of the 80 combined units that 4.3 guarantees is 79; editing binds there

const std::string kBetweenPasses = "an object, before the API uses it";

struct Transfer {
  Format stored;
  GLenum format, type;
  std::size_t bytes;
};

// One table of the formats in use; `format` and `type` serve uploads of zeros and read-backs.
constexpr std::array kTransfers{
    Transfer{Format::rgba8, GL_RGBA, GL_UNSIGNED_BYTE, 4},
    Transfer{Format::srgb8Alpha8, GL_RGBA, GL_UNSIGNED_BYTE, 4},
    Transfer{Format::r8, GL_RED, GL_UNSIGNED_BYTE, 1},
    Transfer{Format::rgba16f, GL_RGBA, GL_HALF_FLOAT, 8},
    Transfer{Format::rgba32f, GL_RGBA, GL_FLOAT, 16},
    Transfer{Format::rgba32ui, GL_RGBA_INTEGER, GL_UNSIGNED_INT, 16},
    Transfer{Format::r32f, GL_RED, GL_FLOAT, 4},
    Transfer{Format::r32i, GL_RED_INTEGER, GL_INT, 4},
    Transfer{Format::r32ui, GL_RED_INTEGER, GL_UNSIGNED_INT, 4},
    Transfer{Format::rg32ui, GL_RG_INTEGER, GL_UNSIGNED_INT, 8},
    Transfer{Format::depth32f, GL_DEPTH_COMPONENT, GL_FLOAT, 4},
    Transfer{Format::depth24, GL_DEPTH_COMPONENT, GL_UNSIGNED_INT, 4},
};

const Transfer& transferOf(Format format) {
  for (const Transfer& transfer : kTransfers)
    if (transfer.stored == format) return transfer;
  CHECK(false, "format {:#x} is not in the engine's table", raw(format));
  return kTransfers[0];
}

// OpenGL orders clears and fills with the draws and dispatches around them. NVIDIA's driver (580.159) does not always:
// textures filled from a buffer, and buffers cleared by glClearBufferData, showed their content of the frame before
// (docs/drivers.md). The barrier of all kinds keeps the two apart.
void waitOutFill() { memoryBarrier(Barrier::all); }

std::pair<GLenum, GLenum> formatAndType(Texels texels) {
  switch (texels) {
    case Texels::redByte: return {GL_RED, GL_UNSIGNED_BYTE};
    case Texels::redFloat: return {GL_RED, GL_FLOAT};
    case Texels::redInt: return {GL_RED_INTEGER, GL_INT};
    case Texels::rgbaByte: return {GL_RGBA, GL_UNSIGNED_BYTE};
    case Texels::rgbaHalf: return {GL_RGBA, GL_HALF_FLOAT};
    case Texels::rgbaFloat: return {GL_RGBA, GL_FLOAT};
    case Texels::rgbaWord: return {GL_RGBA_INTEGER, GL_UNSIGNED_INT};
    case Texels::depthFloat: return {GL_DEPTH_COMPONENT, GL_FLOAT};
  }
  return {};
}

}  // namespace

void memoryBarrier(Barrier barrier) {
  if (barrier != Barrier::none) glMemoryBarrier(raw(barrier));
}

void label(GLenum identifier, GLuint id, const std::string& name) {
  GLint most = 0;
  glGetIntegerv(GL_MAX_LABEL_LENGTH, &most);
  glObjectLabel(identifier, id, std::min(static_cast<GLint>(name.size()), most - 1), name.c_str());
}

std::size_t bytesPerTexel(Format format) { return transferOf(format).bytes; }

namespace detail {
void deleteBuffer(GLuint id) { glDeleteBuffers(1, &id); }
void deleteTexture(GLuint id) { glDeleteTextures(1, &id); }
void deleteFramebuffer(GLuint id) { glDeleteFramebuffers(1, &id); }
void deleteRenderbuffer(GLuint id) { glDeleteRenderbuffers(1, &id); }
void deleteVertexArray(GLuint id) { glDeleteVertexArrays(1, &id); }
void deleteSampler(GLuint id) { glDeleteSamplers(1, &id); }
}  // namespace detail

// ---------------------------------------------------------------------------------------------------- Buffer

Buffer::Buffer(const std::string& name, std::size_t bytes, const void* data, Usage usage) : bytes_(bytes) {
  GLuint id = 0;
  glGenBuffers(1, &id);
  handle_ = decltype(handle_)(id);
  glBindBuffer(GL_COPY_WRITE_BUFFER, id);
  label(GL_BUFFER, id, name);
  throwIfError("before " + name);
  glBufferData(GL_COPY_WRITE_BUFFER, static_cast<GLsizeiptr>(bytes), data, raw(usage));
  throwIfNotAllocated(name, bytes);
}

void Buffer::upload(std::size_t offset, std::size_t bytes, const void* data) {
  CHECK(offset + bytes <= bytes_, "offset {} + {} bytes > {}", offset, bytes, bytes_);
  settle(Barrier::bufferUpdate);
  glBindBuffer(GL_COPY_WRITE_BUFFER, id());
  glBufferSubData(GL_COPY_WRITE_BUFFER, static_cast<GLintptr>(offset), static_cast<GLsizeiptr>(bytes), data);
  if (shadersMayWrite_) waitOutFill();  // shaders may still count in it
}

void Buffer::clear(GLuint value) {
  settle(Barrier::bufferUpdate);
  glBindBuffer(GL_COPY_WRITE_BUFFER, id());
  glClearBufferData(GL_COPY_WRITE_BUFFER, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, &value);
  waitOutFill();
}

void Buffer::bindUniform(GLuint index) const {
  requireWithin(GL_MAX_UNIFORM_BLOCK_SIZE, bytes_, GL_BUFFER, id());
  glBindBufferBase(GL_UNIFORM_BUFFER, index, id());
}

void Buffer::bindStorage(GLuint index) const {
  requireWithin(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, bytes_, GL_BUFFER, id());
  shadersMayWrite_ = true;
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, index, id());
}

void Buffer::settle(Barrier barrier) const {
  if (!shadersMayWrite_) return;
  nameNextBarrier(kBetweenPasses);
  memoryBarrier(barrier);
}

void Buffer::copyTo(Buffer& target, std::size_t bytes, std::size_t offset) const {
  CHECK(offset + bytes <= bytes_ && offset + bytes <= target.bytes_, "{} bytes at {} of {} into {}", bytes, offset,
        bytes_, target.bytes_);
  settle(Barrier::bufferUpdate);
  target.settle(Barrier::bufferUpdate);
  glBindBuffer(GL_COPY_READ_BUFFER, id());
  glBindBuffer(GL_COPY_WRITE_BUFFER, target.id());
  glCopyBufferSubData(GL_COPY_READ_BUFFER, GL_COPY_WRITE_BUFFER, static_cast<GLintptr>(offset),
                      static_cast<GLintptr>(offset), static_cast<GLsizeiptr>(bytes));
}

void Buffer::readBytes(void* data, std::size_t bytes) const {
  CHECK(bytes <= bytes_, "{} bytes of {}", bytes, bytes_);
  settle(Barrier::bufferUpdate);
  glBindBuffer(GL_COPY_READ_BUFFER, id());
  waitBeforeReading();
  glGetBufferSubData(GL_COPY_READ_BUFFER, 0, static_cast<GLsizeiptr>(bytes), data);
  throwIfError("a buffer was read back");
}

// ---------------------------------------------------------------------------------------------------- Sampler

namespace {

/// To a texture's target or a sampler: their functions have the same types.
void applySampling(const Sampling& s, GLuint to, void(GLAPIENTRY* integer)(GLuint, GLenum, GLint),
                   void(GLAPIENTRY* number)(GLuint, GLenum, GLfloat),
                   void(GLAPIENTRY* numbers)(GLuint, GLenum, const GLfloat*)) {
  const auto parameter = [&](GLenum key, GLenum value) { integer(to, key, static_cast<GLint>(value)); };
  parameter(GL_TEXTURE_MIN_FILTER, raw(s.minFilter));
  parameter(GL_TEXTURE_MAG_FILTER, raw(s.magFilter));
  parameter(GL_TEXTURE_WRAP_S, raw(s.wrap));
  parameter(GL_TEXTURE_WRAP_T, raw(s.vertical.value_or(s.wrap)));
  parameter(GL_TEXTURE_WRAP_R, raw(s.wrap));
  numbers(to, GL_TEXTURE_BORDER_COLOR, &s.border.x);
  if (s.bias != 0.0f) number(to, GL_TEXTURE_LOD_BIAS, s.bias);
  if (s.anisotropy > 1.0f) number(to, GL_TEXTURE_MAX_ANISOTROPY_EXT, s.anisotropy);
  if (s.depthCompare) {
    parameter(GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
    parameter(GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
  }
}

}  // namespace

Sampler::Sampler(const std::string& name, const Sampling& sampling) {
  GLuint id = 0;
  glGenSamplers(1, &id);
  handle_ = decltype(handle_)(id);
  glBindSampler(kEditUnit, id);  // creates it, so that it can have a label
  glBindSampler(kEditUnit, 0);
  label(GL_SAMPLER, id, name);
  applySampling(sampling, id, glSamplerParameteri, glSamplerParameterf, glSamplerParameterfv);
}

void Sampler::bind(GLuint unit) const { glBindSampler(unit, handle_.id()); }

void Sampler::unbind(GLuint unit) { glBindSampler(unit, 0); }

// ---------------------------------------------------------------------------------------------------- Texture

Texture::Texture(const std::string& name, Format format, glm::ivec2 size, const Sampling& sampling, int levels)
    : kind_(TextureKind::plane), format_(format), size_(size, 1), levels_(levels) {
  create(name, sampling);
}

Texture::Texture(const std::string& name, Format format, glm::ivec3 size, const Sampling& sampling, int levels,
                 TextureKind kind)
    : kind_(kind), format_(format), size_(size), levels_(levels) {
  create(name, sampling);
}

void Texture::create(const std::string& name, const Sampling& s) {
  CHECK(size_.x > 0 && size_.y > 0 && size_.z > 0, "texture {}: {}x{}x{}", name, size_.x, size_.y, size_.z);
  requireWithin(target() == GL_TEXTURE_3D ? GL_MAX_3D_TEXTURE_SIZE : GL_MAX_TEXTURE_SIZE,
                static_cast<std::size_t>(std::max(size_.x, size_.y)), name);
  if (target() != GL_TEXTURE_2D)
    requireWithin(target() == GL_TEXTURE_3D ? GL_MAX_3D_TEXTURE_SIZE : GL_MAX_ARRAY_TEXTURE_LAYERS,
                  static_cast<std::size_t>(size_.z), name);
  throwIfError("before " + name);
  GLuint id = 0;
  glGenTextures(1, &id);
  handle_ = decltype(handle_)(id);
  glActiveTexture(GL_TEXTURE0 + kEditUnit);
  glBindTexture(target(), id);
  label(GL_TEXTURE, id, name);
  if (target() == GL_TEXTURE_2D) glTexStorage2D(target(), levels_, raw(format_), size_.x, size_.y);
  else glTexStorage3D(target(), levels_, raw(format_), size_.x, size_.y, size_.z);
  throwIfNotAllocated(name, bytes());
  applySampling(s, target(), glTexParameteri, glTexParameterf, glTexParameterfv);
}

Texture Texture::layers(const std::string& name, int first, int count) const {
  CHECK(first >= 0 && count > 0 && first + count <= size_.z, "layers {} to {} of {}", first, first + count, size_.z);
  Texture part;
  part.kind_ = kind_;
  part.format_ = format_;
  part.size_ = {size_.x, size_.y, count};
  GLuint id = 0;
  glGenTextures(1, &id);
  part.handle_ = decltype(part.handle_)(id);
  glTextureView(id, target(), handle_.id(), raw(format_), 0, static_cast<GLuint>(levels_), static_cast<GLuint>(first),
                static_cast<GLuint>(count));
  throwIfError(name);
  glActiveTexture(GL_TEXTURE0 + kEditUnit);
  glBindTexture(target(), id);
  label(GL_TEXTURE, id, name);
  return part;
}

glm::ivec3 Texture::levelSize(int level) const {
  glm::ivec3 size = glm::max(size_ >> level, glm::ivec3(1));
  if (target() == GL_TEXTURE_2D_ARRAY) size.z = size_.z;  // the number of layers stays
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

void Texture::upload(Texels texels, const void* data, int level) {
  const auto [format, type] = formatAndType(texels);
  upload(format, type, data, level);
}

void Texture::upload(GLenum format, GLenum type, const void* data, int level) {
  settle(Barrier::textureUpdate);
  glActiveTexture(GL_TEXTURE0 + kEditUnit);
  glBindTexture(target(), id());
  const glm::ivec3 size = levelSize(level);
  if (target() == GL_TEXTURE_2D) glTexSubImage2D(target(), level, 0, 0, size.x, size.y, format, type, data);
  else glTexSubImage3D(target(), level, 0, 0, 0, size.x, size.y, size.z, format, type, data);
}

void Texture::copyFrom(const Buffer& buffer, std::size_t offset) {
  const Transfer& transfer = transferOf(format_);
  CHECK(levels_ == 1 && offset + bytes() <= buffer.bytes(), "{} bytes at {} of {}", bytes(), offset, buffer.bytes());
  buffer.settle(Barrier::pixelBuffer);
  waitOutFill();
  glBindBuffer(GL_PIXEL_UNPACK_BUFFER, buffer.id());
  upload(transfer.format, transfer.type, reinterpret_cast<const void*>(offset), 0);
  glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
  waitOutFill();
}

void Texture::generateMipmaps() {
  settle(Barrier::textureUpdate);
  glActiveTexture(GL_TEXTURE0 + kEditUnit);
  glBindTexture(target(), id());
  glGenerateMipmap(target());
}

void Texture::bind(GLuint unit) const {
  glActiveTexture(GL_TEXTURE0 + unit);
  glBindTexture(target(), id());
}

void Texture::bindImage(GLuint unit, Access access, int level) const {
  shadersMayWrite_ = shadersMayWrite_ || access != Access::read;
  glBindImageTexture(unit, id(), level, target() == GL_TEXTURE_2D ? GL_FALSE : GL_TRUE, 0, raw(access), raw(format_));
}

void Texture::settle(Barrier barrier) const {
  if (!shadersMayWrite_) return;
  nameNextBarrier(kBetweenPasses);
  memoryBarrier(barrier);
}

std::vector<glm::vec4> Texture::readRgba(int level) const {
  settle(Barrier::textureUpdate);
  const glm::ivec3 size = levelSize(level);
  std::vector<glm::vec4> texels(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) *
                                static_cast<std::size_t>(size.z));
  glActiveTexture(GL_TEXTURE0 + kEditUnit);
  glBindTexture(target(), id());
  waitBeforeReading();
  glGetTexImage(target(), level, GL_RGBA, GL_FLOAT, texels.data());
  throwIfError("a texture was read back");
  return texels;
}

std::vector<float> Texture::readDepth() const {
  std::vector<float> texels(static_cast<std::size_t>(size_.x) * static_cast<std::size_t>(size_.y) *
                            static_cast<std::size_t>(size_.z));
  glActiveTexture(GL_TEXTURE0 + kEditUnit);
  glBindTexture(target(), id());
  waitBeforeReading();
  glGetTexImage(target(), 0, GL_DEPTH_COMPONENT, GL_FLOAT, texels.data());
  throwIfError("a depth texture was read back");
  return texels;
}

std::vector<glm::uvec4> Texture::readWords() const {
  CHECK(format_ == Format::rgba32ui, "format {:#x}", raw(format_));
  settle(Barrier::textureUpdate);
  std::vector<glm::uvec4> words(static_cast<std::size_t>(size_.x) * static_cast<std::size_t>(size_.y) *
                                static_cast<std::size_t>(size_.z));
  glActiveTexture(GL_TEXTURE0 + kEditUnit);
  glBindTexture(target(), id());
  waitBeforeReading();
  glGetTexImage(target(), 0, GL_RGBA_INTEGER, GL_UNSIGNED_INT, words.data());
  throwIfError("a film was read back");
  return words;
}

BufferTexture::BufferTexture(const std::string& name, Format format, std::size_t bytes, const void* data, Usage usage)
    : buffer_(name, bytes, data, usage) {
  requireWithin(GL_MAX_TEXTURE_BUFFER_SIZE, bytes / bytesPerTexel(format), name);
  GLuint id = 0;
  glGenTextures(1, &id);
  texture_ = decltype(texture_)(id);
  glActiveTexture(GL_TEXTURE0 + kEditUnit);
  glBindTexture(GL_TEXTURE_BUFFER, id);
  label(GL_TEXTURE, id, name);
  glTexBuffer(GL_TEXTURE_BUFFER, raw(format), buffer_.id());
  throwIfError(name);
}

void BufferTexture::bind(GLuint unit) const {
  glActiveTexture(GL_TEXTURE0 + unit);
  glBindTexture(GL_TEXTURE_BUFFER, texture_.id());
}

void copyTexels(const Texture& from, glm::ivec2 fromCorner, const Texture& to, glm::ivec2 toCorner, glm::ivec2 size) {
  CHECK(from.format() == to.format(), "formats {:#x} and {:#x}", raw(from.format()), raw(to.format()));
  from.settle(Barrier::textureUpdate);
  to.settle(Barrier::textureUpdate);
  glCopyImageSubData(from.id(), raw(from.kind()), 0, fromCorner.x, fromCorner.y, 0, to.id(), raw(to.kind()), 0,
                     toCorner.x, toCorner.y, 0, size.x, size.y, 1);
}

void copyTexels(const Texture& from, const Texture& to) {
  CHECK(from.format() == to.format() && from.size() == to.size(), "formats {:#x} and {:#x}", raw(from.format()),
        raw(to.format()));
  from.settle(Barrier::textureUpdate);
  to.settle(Barrier::textureUpdate);
  glCopyImageSubData(from.id(), raw(from.kind()), 0, 0, 0, 0, to.id(), raw(to.kind()), 0, 0, 0, 0, from.size().x,
                     from.size().y, from.size().z);
}

void clearToZero(std::span<const Texture* const> textures, bool haveClearTexture) {
  std::vector<std::byte> zeros;
  for (const Texture* texture : textures) {
    const Transfer& transfer = transferOf(texture->format());
    texture->settle(Barrier::textureUpdate);
    if (!haveClearTexture) zeros.resize(std::max(zeros.size(), texture->bytes()), std::byte{0});
    for (int level = 0; level < texture->levels(); ++level) {
      if (haveClearTexture) glClearTexImage(texture->id(), level, transfer.format, transfer.type, nullptr);
      else const_cast<Texture*>(texture)->upload(transfer.format, transfer.type, zeros.data(), level);
    }
  }
  waitOutFill();
}

// ---------------------------------------------------------------------------------------------------- Framebuffer

Framebuffer::Framebuffer(const std::string& name) {
  GLuint id = 0;
  glGenFramebuffers(1, &id);
  handle_ = decltype(handle_)(id);
  glBindFramebuffer(GL_FRAMEBUFFER, id);
  label(GL_FRAMEBUFFER, id, name);
}

Framebuffer::Framebuffer(const std::string& name, std::span<const Texture* const> colors, const Texture* depth)
    : Framebuffer(name) {
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
  requireComplete(name);
}

void Framebuffer::requireComplete(const std::string& name) const {
  const GLenum status = glCheckFramebufferStatus(GL_FRAMEBUFFER);
  throwIfError(name);
  if (status != GL_FRAMEBUFFER_COMPLETE)
    throwMissingCapability("framebuffer {}: this driver cannot draw into it (status {:#x})", name, status);
}

// ---------------------------------------------------------------------------------------------------- Multisampled

namespace {

/// The driver's number of samples of a format that is nearest to those asked for, and not below.
int samplesOf(const std::string& name, Format format, int samples) {
  std::array<GLint, 16> offered{};  // in descending order
  glGetInternalformativ(GL_RENDERBUFFER, raw(format), GL_SAMPLES, static_cast<GLsizei>(offered.size()), offered.data());
  int nearest = 0;
  for (const GLint n : offered)
    if (n >= samples) nearest = n;
  if (nearest == 0)
    throwMissingCapability("{}: {} samples per pixel needed, this driver has {} at most", name, samples, offered[0]);
  return nearest;
}

}  // namespace

MultisampledTarget::MultisampledTarget(const std::string& name, Format color, Format depth, glm::ivec2 size,
                                       int samples)
    : target_(name), samples_(std::max(samplesOf(name, color, samples), samplesOf(name, depth, samples))) {
  const auto attach = [&](GLenum attachment, Format format) {
    GLuint id = 0;
    glGenRenderbuffers(1, &id);
    glBindRenderbuffer(GL_RENDERBUFFER, id);
    label(GL_RENDERBUFFER, id, name);
    glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples_, raw(format), size.x, size.y);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, attachment, GL_RENDERBUFFER, id);
    bytes_ += static_cast<std::size_t>(samples_) * static_cast<std::size_t>(size.x * size.y) * bytesPerTexel(format);
    return id;
  };
  color_ = decltype(color_)(attach(GL_COLOR_ATTACHMENT0, color));
  depth_ = decltype(depth_)(attach(GL_DEPTH_ATTACHMENT, depth));
  glDrawBuffer(GL_COLOR_ATTACHMENT0);
  target_.size_ = size;
  target_.requireComplete(name);
}

void MultisampledTarget::resolveTo(const Framebuffer& picture) const {
  const glm::ivec2 size = target_.size();
  CHECK(picture.size() == size, "{}x{} resolved to {}x{}", size.x, size.y, picture.size().x, picture.size().y);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, target_.id());
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, picture.id());
  glDisable(GL_SCISSOR_TEST);
  glBlitFramebuffer(0, 0, size.x, size.y, 0, 0, size.x, size.y, GL_COLOR_BUFFER_BIT, GL_NEAREST);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
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
  add(vertices, stride, attributes);
  glBindVertexArray(id());
  if (indices) glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices->id());
  glBindVertexArray(0);
}

void VertexArray::add(const Buffer& vertices, std::size_t stride, std::span<const Attribute> attributes) {
  glBindVertexArray(id());
  glBindBuffer(GL_ARRAY_BUFFER, vertices.id());
  for (const Attribute& a : attributes) {
    glEnableVertexAttribArray(a.location);
    glVertexAttribPointer(a.location, a.components, GL_FLOAT, GL_FALSE, static_cast<GLsizei>(stride),
                          reinterpret_cast<const void*>(a.offset));
  }
  glBindVertexArray(0);
}

void VertexArray::bind() const { glBindVertexArray(id()); }

}  // namespace lucerna::gl
