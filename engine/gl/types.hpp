// Enum types for the OpenGL constants that the engine passes around: a format cannot be passed where a usage is meant.
#pragma once

#include "host/api.hpp"

#include <type_traits>

namespace lucerna::gl {

/// Texel formats of textures and texture buffers.
enum class Format : GLenum {
  r8 = GL_R8,
  r32f = GL_R32F,
  r32i = GL_R32I,
  r32ui = GL_R32UI,
  rg32ui = GL_RG32UI,
  rgba8 = GL_RGBA8,
  rgba16f = GL_RGBA16F,
  rgba32f = GL_RGBA32F,
  rgba32ui = GL_RGBA32UI,
  srgb8Alpha8 = GL_SRGB8_ALPHA8,
  depth24 = GL_DEPTH_COMPONENT24,
  depth32f = GL_DEPTH_COMPONENT32F,
};

/// Texel formats in memory, for upload().
enum class Texels { redByte, redFloat, redInt, rgbaByte, rgbaHalf, rgbaFloat, rgbaWord, depthFloat };

enum class TextureKind : GLenum {
  plane = GL_TEXTURE_2D,
  array = GL_TEXTURE_2D_ARRAY,
  cubeArray = GL_TEXTURE_CUBE_MAP_ARRAY,
  volume = GL_TEXTURE_3D,
};

enum class Filter : GLenum { nearest = GL_NEAREST, linear = GL_LINEAR, linearMipmaps = GL_LINEAR_MIPMAP_LINEAR };
/// `border` has zeros there unless Sampling says otherwise.
enum class Wrap : GLenum {
  edge = GL_CLAMP_TO_EDGE,
  border = GL_CLAMP_TO_BORDER,
  repeat = GL_REPEAT,
  mirror = GL_MIRRORED_REPEAT
};

/// How often a buffer changes, and who reads it.
enum class Usage : GLenum {
  staticDraw = GL_STATIC_DRAW,
  dynamicDraw = GL_DYNAMIC_DRAW,
  dynamicCopy = GL_DYNAMIC_COPY,
  dynamicRead = GL_DYNAMIC_READ,
  streamDraw = GL_STREAM_DRAW,
  streamRead = GL_STREAM_READ,
};

/// How shaders access an image.
enum class Access : GLenum { read = GL_READ_ONLY, write = GL_WRITE_ONLY, readWrite = GL_READ_WRITE };

/// The use of shader writes that a barrier waits for [OpenGL 4.3, 7.12.2].
enum class Barrier : GLbitfield {
  none = 0,
  textureFetch = GL_TEXTURE_FETCH_BARRIER_BIT,
  image = GL_SHADER_IMAGE_ACCESS_BARRIER_BIT,
  storage = GL_SHADER_STORAGE_BARRIER_BIT,
  command = GL_COMMAND_BARRIER_BIT,
  framebuffer = GL_FRAMEBUFFER_BARRIER_BIT,
  pixelBuffer = GL_PIXEL_BUFFER_BARRIER_BIT,
  bufferUpdate = GL_BUFFER_UPDATE_BARRIER_BIT,
  textureUpdate = GL_TEXTURE_UPDATE_BARRIER_BIT,
  all = GL_ALL_BARRIER_BITS,
};
constexpr Barrier operator|(Barrier a, Barrier b) {
  return static_cast<Barrier>(static_cast<GLbitfield>(a) | static_cast<GLbitfield>(b));
}

/// The underlying OpenGL constant.
template <class Enum>
constexpr std::underlying_type_t<Enum> raw(Enum value) {
  return static_cast<std::underlying_type_t<Enum>>(value);
}

}  // namespace lucerna::gl
