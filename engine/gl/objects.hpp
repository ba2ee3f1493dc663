// Move-only owners of OpenGL objects. Every object carries a debug name (KHR_debug), shown by RenderDoc, apitrace and
// Nsight, and knows its size in bytes. OpenGL 4.3 has no direct state access: buffers are edited through
// GL_COPY_WRITE_BUFFER, textures through the last texture unit, so that no other binding changes.
//
// Only barriers order shader writes to storage blocks and images [OpenGL 4.3, 7.12.2]. Between shaders, passes issue
// them (pass.hpp). Between a shader and the API's own reads and writes it happens here: an object that was ever bound
// for shader writes issues the barrier before an upload, clear, copy or read.
#pragma once

#include "gl/types.hpp"

#include <glm/glm.hpp>

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace lucerna::gl {

namespace detail {
void deleteBuffer(GLuint id);
void deleteTexture(GLuint id);
void deleteFramebuffer(GLuint id);
void deleteRenderbuffer(GLuint id);
void deleteVertexArray(GLuint id);
void deleteSampler(GLuint id);
}  // namespace detail

/// The one place that issues glMemoryBarrier; none: no call.
void memoryBarrier(Barrier barrier);

/// Names the object for debuggers, truncated to GL_MAX_LABEL_LENGTH: longer labels are an error [OpenGL 4.3, 20.9].
void label(GLenum identifier, GLuint id, const std::string& name);

/// Owns the name of a GL object; zero when moved from.
template <void (*Delete)(GLuint)>
class Handle {
 public:
  Handle() = default;
  explicit Handle(GLuint id) : id_(id) {}
  ~Handle() {
    if (id_) Delete(id_);
  }
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, 0)) {}
  Handle& operator=(Handle&& other) noexcept {
    if (this == &other) return *this;
    if (id_) Delete(id_);
    id_ = std::exchange(other.id_, 0);
    return *this;
  }
  GLuint id() const { return id_; }

 private:
  GLuint id_ = 0;
};

class Buffer {
 public:
  Buffer() = default;
  /// `bytes` of storage; `data` may be null.
  Buffer(const std::string& name, std::size_t bytes, const void* data, Usage usage);
  Buffer(Buffer&&) noexcept = default;
  Buffer& operator=(Buffer&&) noexcept = default;

  GLuint id() const { return handle_.id(); }
  std::size_t bytes() const { return id() ? bytes_ : 0; }
  void upload(std::size_t offset, std::size_t bytes, const void* data);
  void clear(GLuint value = 0);
  void bindUniform(GLuint index) const;
  void bindStorage(GLuint index) const;
  /// Copies bytes of this buffer to the same place in `target`.
  void copyTo(Buffer& target, std::size_t bytes, std::size_t offset = 0) const;
  /// Issues a barrier if shaders may have written this buffer: bufferUpdate before the API changes or reads it.
  void settle(Barrier barrier) const;
  template <class T>
  std::vector<T> read() const {
    std::vector<T> values(bytes_ / sizeof(T));
    readBytes(values.data(), bytes_);
    return values;
  }
  /// Its first `count` values.
  template <class T>
  std::vector<T> read(std::size_t count) const {
    std::vector<T> values(count);
    readBytes(values.data(), count * sizeof(T));
    return values;
  }
  /// Its first value.
  template <class T>
  T readFirst() const {
    T value{};
    readBytes(&value, sizeof value);
    return value;
  }

 private:
  void readBytes(void* data, std::size_t bytes) const;
  Handle<detail::deleteBuffer> handle_;
  std::size_t bytes_ = 0;
  mutable bool shadersMayWrite_ = false;  ///< was bound as a storage block
};

/// How a texture is read. Defaults: nearest, clamped to the edge.
struct Sampling {
  Filter minFilter = Filter::nearest;
  Filter magFilter = Filter::nearest;
  Wrap wrap = Wrap::edge;
  glm::vec4 border{0.0f};
  float anisotropy = 1.0f;
  float bias = 0.0f;  ///< added to the mip level; below 0: sharper
  bool depthCompare = false;  ///< sampler2DShadow, less or equal
  std::optional<Wrap> vertical = {};  ///< of the second coordinate, if it is not `wrap`
};

/// While bound, replaces how the texture of a unit is read.
class Sampler {
 public:
  Sampler(const std::string& name, const Sampling& sampling);
  void bind(GLuint unit) const;
  static void unbind(GLuint unit);

 private:
  Handle<detail::deleteSampler> handle_;
};

/// Immutable storage, 2D, 2D array or 3D.
class Texture {
 public:
  Texture() = default;
  Texture(const std::string& name, Format format, glm::ivec2 size, const Sampling& sampling = {}, int levels = 1);
  Texture(const std::string& name, Format format, glm::ivec3 size, const Sampling& sampling = {}, int levels = 1,
          TextureKind kind = TextureKind::volume);
  Texture(Texture&&) noexcept = default;
  Texture& operator=(Texture&&) noexcept = default;

  /// Layers of an array, or faces of cube maps, as a texture of their own that shares this one's storage.
  Texture layers(const std::string& name, int first, int count) const;
  /// Another of this format, size, kind and single level.
  Texture sameShape(const std::string& name) const { return {name, format_, size_, {}, 1, kind_}; }

  GLuint id() const { return handle_.id(); }
  TextureKind kind() const { return kind_; }
  Format format() const { return format_; }
  glm::ivec3 size() const { return size_; }
  glm::ivec2 size2d() const { return {size_.x, size_.y}; }
  int levels() const { return levels_; }
  std::size_t bytes() const;  ///< of all levels, shared ones too; zero when moved from

  void upload(Texels texels, const void* data, int level = 0);
  /// Level 0 from a buffer with texels in the texture's own format, starting at `offset`.
  void copyFrom(const Buffer& buffer, std::size_t offset);
  void generateMipmaps();
  void bind(GLuint unit) const;
  void bindImage(GLuint unit, Access access, int level = 0) const;
  /// Issues a barrier if shaders may have stored into this texture: textureUpdate before the API changes or reads it.
  void settle(Barrier barrier) const;
  /// All texels of a level as float RGBA (depth textures: one float per texel).
  std::vector<glm::vec4> readRgba(int level = 0) const;
  std::vector<float> readDepth() const;
  std::vector<glm::uvec4> readWords() const;  ///< of an RGBA32UI texture

 private:
  friend void clearToZero(std::span<const Texture* const> textures, bool haveClearTexture);
  void create(const std::string& name, const Sampling& sampling);
  void upload(GLenum format, GLenum type, const void* data, int level);
  GLenum target() const { return raw(kind_); }
  glm::ivec3 levelSize(int level) const;
  Handle<detail::deleteTexture> handle_;
  TextureKind kind_ = TextureKind::plane;
  Format format_ = Format::rgba8;
  glm::ivec3 size_{0};
  int levels_ = 1;
  mutable bool shadersMayWrite_ = false;  ///< was bound as a writable image
};

/// A buffer that shaders read as texels (samplerBuffer): on llvmpipe gathers are three times as fast as from a storage
/// block.
class BufferTexture {
 public:
  BufferTexture() = default;
  /// `bytes` above 0.
  BufferTexture(const std::string& name, Format format, std::size_t bytes, const void* data,
                Usage usage = Usage::staticDraw);
  BufferTexture(BufferTexture&&) noexcept = default;
  BufferTexture& operator=(BufferTexture&&) noexcept = default;

  std::size_t bytes() const { return buffer_.bytes(); }
  void upload(std::size_t offset, std::size_t bytes, const void* data) { buffer_.upload(offset, bytes, data); }
  void clear() { buffer_.clear(); }
  void bind(GLuint unit) const;
  /// The same storage as a writable storage block; Barrier::textureFetch before texel fetches.
  Buffer& buffer() { return buffer_; }
  const Buffer& buffer() const { return buffer_; }

 private:
  Buffer buffer_;
  Handle<detail::deleteTexture> texture_;
};

/// Copies texels of level 0 between 2D textures of the same format.
void copyTexels(const Texture& from, glm::ivec2 fromCorner, const Texture& to, glm::ivec2 toCorner, glm::ivec2 size);
/// Level 0 of a texture into one of the same format and size.
void copyTexels(const Texture& from, const Texture& to);

/// Sets every texel of every level of every listed texture to zero: ARB_clear_texture if available, else an upload of
/// zeros.
void clearToZero(std::span<const Texture* const> textures, bool haveClearTexture);

class Framebuffer {
 public:
  Framebuffer() = default;
  /// Attaches whole textures (a 3D or array texture becomes layered). Throws Error(missingCapability) if incomplete.
  Framebuffer(const std::string& name, std::span<const Texture* const> colors, const Texture* depth = nullptr);
  Framebuffer(Framebuffer&&) noexcept = default;
  Framebuffer& operator=(Framebuffer&&) noexcept = default;

  GLuint id() const { return handle_.id(); }
  glm::ivec2 size() const { return size_; }

 private:
  friend class MultisampledTarget;
  explicit Framebuffer(const std::string& name);
  void requireComplete(const std::string& name) const;

  Handle<detail::deleteFramebuffer> handle_;
  glm::ivec2 size_{0};
};

/// Colour and depth at several points of each pixel. A fragment is shaded once for all points of a pixel that its
/// triangle covers.
class MultisampledTarget {
 public:
  /// `samples`: at least so many. Throws Error(missingCapability) if the driver has fewer for one of the formats.
  MultisampledTarget(const std::string& name, Format color, Format depth, glm::ivec2 size, int samples);

  const Framebuffer& target() const { return target_; }
  int samples() const { return samples_; }
  /// The mean of each pixel's samples into the first colour of a framebuffer of the same size.
  void resolveTo(const Framebuffer& picture) const;
  std::size_t bytes() const { return bytes_; }

 private:
  Handle<detail::deleteRenderbuffer> color_, depth_;
  Framebuffer target_;
  int samples_ = 0;
  std::size_t bytes_ = 0;
};

class VertexArray {
 public:
  struct Attribute {
    GLuint location;
    GLint components;
    std::size_t offset;  ///< bytes into a vertex; 32-bit floats
  };
  VertexArray() = default;
  /// Without attributes, for draws whose vertices come from gl_VertexID.
  explicit VertexArray(const std::string& name);
  VertexArray(const std::string& name, const Buffer& vertices, std::size_t stride,
              std::span<const Attribute> attributes, const Buffer* indices);
  /// Of another buffer.
  void add(const Buffer& vertices, std::size_t stride, std::span<const Attribute> attributes);
  VertexArray(VertexArray&&) noexcept = default;
  VertexArray& operator=(VertexArray&&) noexcept = default;

  GLuint id() const { return handle_.id(); }
  void bind() const;

 private:
  Handle<detail::deleteVertexArray> handle_;
};

/// Bytes per texel, for the formats the engine uses.
std::size_t bytesPerTexel(Format format);

}  // namespace lucerna::gl
