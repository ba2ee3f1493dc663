// The thin layer over OpenGL: objects, programs, passes, timer queries, and the layout of structs shared with GLSL.
#include "support/gl_fixture.hpp"
#include "support/temp_folder.hpp"

#include "base/files.hpp"
#include "base/log.hpp"
#include "base/statistics.hpp"
#include "gl/live_objects.hpp"
#include "gl/pass.hpp"
#include "gl/read_back.hpp"
#include "gl/time_query.hpp"
#include "lpv/light_propagation_volume.hpp"
#include "shared/frame.h"
#include "shared/cascades.h"
#include "shared/irradiance_cache.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <thread>
#include <type_traits>
#include <utility>

namespace lucerna::gl {
namespace {

namespace fs = std::filesystem;
using test::badInputMessage;
using test::TempFolder;

::testing::AssertionResult has(const std::string& text, std::string_view part) {
  if (text.find(part) != std::string::npos) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << "\"" << text << "\" has no \"" << part << "\"";
}

// ---- objects
// -----------------------------------------------------------------------------------------------------------

class GlObjects : public test::GlTest {
 protected:
  static Texture small(const std::string& name = "small") { return Texture(name, Format::rgba8, glm::ivec2(2)); }
  static std::string labelOf(GLenum identifier, GLuint id) {
    std::array<char, 256> text{};
    GLsizei length = 0;
    glGetObjectLabel(identifier, id, static_cast<GLsizei>(text.size()), &length, text.data());
    return {text.data(), static_cast<std::size_t>(length)};
  }
  /// What move construction, move assignment and the end of a scope must do to any of the owners.
  template <class Object, class Make, class IsAlive>
  static void expectMoveOnly(const Make& make, const IsAlive& isAlive) {
    static_assert(!std::is_copy_constructible_v<Object> && !std::is_copy_assignable_v<Object>);
    static_assert(std::is_nothrow_move_constructible_v<Object> && std::is_nothrow_move_assignable_v<Object>);
    EXPECT_EQ(Object().id(), 0u);
    GLuint first = 0, second = 0;
    {
      Object a = make();
      first = a.id();
      ASSERT_NE(first, 0u);
      Object b(std::move(a));
      EXPECT_EQ(a.id(), 0u);  // NOLINT: what a moved-from one holds is the question
      EXPECT_EQ(b.id(), first);
      EXPECT_TRUE(isAlive(first));
      Object c = make();
      second = c.id();
      c = std::move(b);
      EXPECT_EQ(b.id(), 0u);  // NOLINT
      EXPECT_EQ(c.id(), first);
      EXPECT_TRUE(isAlive(first));
      EXPECT_FALSE(isAlive(second)) << "what was there before is deleted at once";
      Object& self = c;
      c = std::move(self);
      EXPECT_EQ(c.id(), first);
      EXPECT_TRUE(isAlive(first));
    }
    EXPECT_FALSE(isAlive(first));
    // Deleted once: a name that was given out again must survive the end of the moved-from owner.
    Object moved = make();
    {
      Object old = make();
      moved = std::move(old);
    }
    EXPECT_TRUE(isAlive(moved.id()));
  }
};

TEST_F(GlObjects, AreMoveOnlyAndDeletedOnce) {
  expectMoveOnly<Buffer>([] { return Buffer("b", 16, nullptr, Usage::staticDraw); },
                         [](GLuint id) { return glIsBuffer(id) == GL_TRUE; });
  expectMoveOnly<Texture>([] { return small(); }, [](GLuint id) { return glIsTexture(id) == GL_TRUE; });
  const Texture target = small();
  const std::array<const Texture*, 1> targets{&target};
  expectMoveOnly<Framebuffer>([&] { return Framebuffer("f", targets); },
                              [](GLuint id) { return glIsFramebuffer(id) == GL_TRUE; });
  expectMoveOnly<VertexArray>([] { return VertexArray("v"); },
                              [](GLuint id) { return glIsVertexArray(id) == GL_TRUE; });
}

TEST_F(GlObjects, AMovedFromObjectHoldsNoBytes) {
  Buffer a("a", 64, nullptr, Usage::staticDraw);
  const Buffer b(std::move(a));
  EXPECT_EQ(a.bytes(), 0u);  // NOLINT
  EXPECT_EQ(b.bytes(), 64u);
  Texture c = small();
  const Texture d(std::move(c));
  EXPECT_EQ(c.bytes(), 0u);  // NOLINT
  EXPECT_EQ(d.bytes(), 16u);
}

TEST_F(GlObjects, CarryTheirNames) {
  const Buffer buffer("my buffer", 4, nullptr, Usage::staticDraw);
  const Texture texture = small("my texture");
  const std::array<const Texture*, 1> targets{&texture};
  const Framebuffer framebuffer("my framebuffer", targets);
  const VertexArray vertexArray("my vertex array");
  EXPECT_EQ(labelOf(GL_BUFFER, buffer.id()), "my buffer");
  EXPECT_EQ(labelOf(GL_TEXTURE, texture.id()), "my texture");
  EXPECT_EQ(labelOf(GL_FRAMEBUFFER, framebuffer.id()), "my framebuffer");
  EXPECT_EQ(labelOf(GL_VERTEX_ARRAY, vertexArray.id()), "my vertex array");
  EXPECT_EQ(
      labelOf(GL_PROGRAM, programs().loadRaster("my program", "lib/fullscreen.vert", "forward/tonemap.frag").id()),
      "my program");
}

TEST_F(GlObjects, NamesAreCutAtTheDriversLength) {
  GLint most = 0;
  glGetIntegerv(GL_MAX_LABEL_LENGTH, &most);
  ASSERT_GE(most, 256);  // [OpenGL 4.3, table 23.61]
  const std::string name(static_cast<std::size_t>(most) + 1000, 'n');
  const Buffer buffer(name, 16, nullptr, Usage::staticDraw);
  const Texture texture = small(name);
  GLsizei length = 0;
  glGetObjectLabel(GL_BUFFER, buffer.id(), 0, &length, nullptr);
  EXPECT_EQ(length, most - 1);  // less than the limit [OpenGL 4.3, 20.7]
  EXPECT_TRUE(context().takeErrors().empty());
  GLint longest = 0;
  glGetIntegerv(GL_MAX_DEBUG_MESSAGE_LENGTH, &longest);
  { const DebugGroup group(std::string(static_cast<std::size_t>(longest) + 1, 'g')); }
  EXPECT_TRUE(context().takeErrors().empty());
}

/// Stands in for glMemoryBarrier and keeps the bits, except those of the workaround for clears and fills: all.
struct BarrierSpy {
  BarrierSpy() {
    seen() = 0, __glewMemoryBarrier = [](GLbitfield bits) { seen() |= bits == GL_ALL_BARRIER_BITS ? 0 : bits; };
  }
  ~BarrierSpy() { __glewMemoryBarrier = real_; }
  static Barrier take() { return static_cast<Barrier>(std::exchange(seen(), 0)); }

 private:
  static GLbitfield& seen() {
    static GLbitfield bits = 0;
    return bits;
  }
  PFNGLMEMORYBARRIERPROC real_ = __glewMemoryBarrier;
};

TEST_F(GlObjects, BuffersThatShadersMayWriteAreSettledBeforeTheApiTouchesThem) {
  const std::array<GLuint, 4> words{1, 2, 3, 4};
  Buffer buffer("words", sizeof words, words.data(), Usage::dynamicCopy),
      other("other", sizeof words, nullptr, Usage::streamRead);
  BufferTexture texels("texels", Format::r32ui, sizeof words, words.data());
  Texture copy("copy", Format::r32ui, glm::ivec2(2));
  const BarrierSpy spy;
  const auto touchAll = [&](Barrier expected, Barrier expectedOfPixels) {
    buffer.upload(0, sizeof words, words.data());
    EXPECT_EQ(spy.take(), expected);
    buffer.copyTo(other, sizeof words);
    EXPECT_EQ(spy.take(), expected);
    EXPECT_EQ(buffer.read<GLuint>()[3], 4u);
    EXPECT_EQ(spy.take(), expected);
    copy.copyFrom(buffer, 0);
    EXPECT_EQ(spy.take(), expectedOfPixels);
    buffer.clear();
    EXPECT_EQ(spy.take(), expected);
    texels.clear();
    EXPECT_EQ(spy.take(), expected);
  };
  buffer.bindUniform(0);  // which shaders only read
  texels.bind(0);
  touchAll(Barrier::none, Barrier::none);
  buffer.bindStorage(0);
  texels.buffer().bindStorage(0);
  touchAll(Barrier::bufferUpdate, Barrier::pixelBuffer);
  const Buffer moved = std::move(buffer);  // takes along that it may have been written
  EXPECT_EQ(moved.read<GLuint>().size(), 4u);
  EXPECT_EQ(spy.take(), Barrier::bufferUpdate);
}

TEST_F(GlObjects, TexturesThatShadersMayWriteAreSettledBeforeTheApiTouchesThem) {
  const std::array<GLfloat, 16> texels{};
  Texture texture("image", Format::rgba32f, glm::ivec2(2));
  const BarrierSpy spy;
  const auto touchAll = [&](Barrier expected) {
    texture.upload(Texels::rgbaFloat, texels.data());
    EXPECT_EQ(spy.take(), expected);
    texture.readRgba();
    EXPECT_EQ(spy.take(), expected);
    texture.generateMipmaps();
    EXPECT_EQ(spy.take(), expected);
    for (const bool extension : {false, true}) {
      if (extension && !capabilities().clearTexture) continue;
      const std::array<const Texture*, 1> cleared{&texture};
      clearToZero(cleared, extension);
      EXPECT_EQ(spy.take(), expected);
    }
  };
  texture.bindImage(0, Access::read);
  touchAll(Barrier::none);
  texture.bindImage(0, Access::readWrite);
  touchAll(Barrier::textureUpdate);
}

TEST_F(GlObjects, WhatIsReadBackEachFrameIsReadFromABufferThatNoShaderSees) {
  const std::array<GLuint, 4> words{1, 2, 3, 4};
  const Buffer counters("counters", sizeof words, words.data(), Usage::dynamicCopy);
  counters.bindStorage(0);
  static GLuint readFrom;
  const auto real = __glewGetBufferSubData;
  __glewGetBufferSubData = [](GLenum target, GLintptr, GLsizeiptr, void*) {
    GLint bound = 0;
    glGetIntegerv(target == GL_COPY_READ_BUFFER ? GL_COPY_READ_BUFFER_BINDING : GL_COPY_WRITE_BUFFER_BINDING, &bound);
    readFrom = static_cast<GLuint>(bound);
  };
  Staging staging("staging");
  staging.readFirst<GLuint>(counters);
  __glewGetBufferSubData = real;
  EXPECT_NE(readFrom, 0u);
  EXPECT_NE(readFrom, counters.id());
  EXPECT_EQ(staging.readFirst<GLuint>(counters), 1u);
  EXPECT_EQ(staging.read<GLuint>(counters, 4), (std::vector<GLuint>{1, 2, 3, 4}));  // it grows
  EXPECT_TRUE(staging.read<GLuint>(counters, 0).empty());
  EXPECT_EQ(staging.bytes(), sizeof words);
}

class GlDebugOutput : public test::GlTest {
 protected:
  void SetUp() override {
    GlTest::SetUp();
    glGetPointerv(GL_DEBUG_CALLBACK_FUNCTION, &listener_);
    glGetPointerv(GL_DEBUG_CALLBACK_USER_PARAM, &user_);
  }
  /// The fixture's context listens again.
  void TearDown() override {
    setLogLevel(level_);
    glEnable(GL_DEBUG_OUTPUT);
    glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
    glDebugMessageCallback(reinterpret_cast<GLDEBUGPROC>(listener_), user_);
    GlTest::TearDown();
  }

 private:
  LogLevel level_ = logLevel();
  void *listener_ = nullptr, *user_ = nullptr;
};

TEST_F(GlDebugOutput, IsOffUnlessTheRunIsVerbose) {
  for (const LogLevel level : {LogLevel::quiet, LogLevel::warnings, LogLevel::info, LogLevel::verbose}) {
    setLogLevel(level);
    Context quietOrNot;
    const GLboolean verbose = level == LogLevel::verbose;
    EXPECT_EQ(glIsEnabled(GL_DEBUG_OUTPUT_SYNCHRONOUS), verbose);
    EXPECT_EQ(glIsEnabled(GL_DEBUG_OUTPUT), verbose);
    setLogLevel(LogLevel::quiet);
    glEnable(GL_STATIC_DRAW);  // no capability
    EXPECT_EQ(quietOrNot.takeErrors().size(), 1u);  // either way
  }
}

TEST_F(GlObjects, BuffersKeepWhatIsUploaded) {
  const std::array<std::uint32_t, 4> initial{1, 2, 3, 4};
  Buffer buffer("b", sizeof initial, initial.data(), Usage::dynamicDraw);
  EXPECT_EQ(buffer.read<std::uint32_t>(), (std::vector<std::uint32_t>{1, 2, 3, 4}));
  const std::array<std::uint32_t, 2> part{7, 8};
  buffer.upload(4, sizeof part, part.data());
  EXPECT_EQ(buffer.read<std::uint32_t>(), (std::vector<std::uint32_t>{1, 7, 8, 4}));
  buffer.clear(0xabcd1234u);
  EXPECT_EQ(buffer.read<std::uint32_t>(), std::vector<std::uint32_t>(4, 0xabcd1234u));
  buffer.clear();
  EXPECT_EQ(buffer.read<std::uint32_t>(), std::vector<std::uint32_t>(4, 0u));
  EXPECT_EQ(buffer.bytes(), 16u);
}

class GlObjectsDeathTest : public GlObjects {};
TEST_F(GlObjectsDeathTest, AnUploadBeyondTheEndAborts) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  Buffer buffer("b", 16, nullptr, Usage::staticDraw);
  const std::uint32_t word = 0;
  EXPECT_DEATH(buffer.upload(13, sizeof word, &word), "offset 13 \\+ 4 bytes > 16");
  EXPECT_DEATH(bytesPerTexel(static_cast<Format>(GL_RGB9_E5)), "not in the engine's table");
}

TEST_F(GlObjects, TexturesKeepWhatIsUploaded) {
  std::vector<glm::vec4> values;
  for (int i = 0; i < 12; ++i) values.emplace_back(0.25 * i, -1.5, 0.125 * i * i, 1.0);  // exact in 16-bit floats
  for (const gl::Format format : std::initializer_list<Format>{Format::rgba32f, Format::rgba16f}) {
    Texture flat("2d", format, glm::ivec2(4, 3));
    flat.upload(Texels::rgbaFloat, values.data());
    EXPECT_EQ(flat.readRgba(), values);
    Texture deep("3d", format, glm::ivec3(2, 3, 2));
    deep.upload(Texels::rgbaFloat, values.data());
    EXPECT_EQ(deep.readRgba(), values);
    Texture layered("array", format, glm::ivec3(2, 2, 3), {}, 2, TextureKind::array);
    layered.upload(Texels::rgbaFloat, values.data());
    layered.upload(Texels::rgbaFloat, values.data(), 1);
    EXPECT_EQ(layered.readRgba(), values);
    EXPECT_EQ(layered.readRgba(1),
              std::vector<glm::vec4>(values.begin(), values.begin() + 3));  // layers stay, texels halve
  }
  // 32-bit floats to the last bit, huge and tiny, and what 16-bit ones make of them.
  const std::vector<glm::vec4> extremes{{3.0e38f, 1e-38f, 1.0f / 3.0f, 70000.0f}};
  Texture full("full", Format::rgba32f, glm::ivec2(1)), half("half", Format::rgba16f, glm::ivec2(1));
  full.upload(Texels::rgbaFloat, extremes.data());
  half.upload(Texels::rgbaFloat, extremes.data());
  EXPECT_EQ(full.readRgba(), extremes);
  EXPECT_NEAR(half.readRgba()[0].z, 1.0 / 3.0, 1e-3 / 3.0);
  EXPECT_EQ(half.readRgba()[0].y, 0.0f);

  const std::array<float, 6> floats{0.0f, 0.25f, 0.5f, 0.75f, 1.0f, 0.125f};
  Texture red("red", Format::r32f, glm::ivec2(3, 2)), depth("depth", Format::depth32f, glm::ivec2(3, 2));
  red.upload(Texels::redFloat, floats.data());
  depth.upload(Texels::depthFloat, floats.data());
  const auto read = red.readRgba();
  for (std::size_t i = 0; i < floats.size(); ++i) EXPECT_EQ(read[i], glm::vec4(floats[i], 0.0f, 0.0f, 1.0f));
  EXPECT_EQ(depth.readDepth(), std::vector<float>(floats.begin(), floats.end()));

  // 8 bits, rows of 3 bytes: no row is padded.
  const std::array<std::uint8_t, 6> bytes{0, 51, 102, 153, 204, 255};
  Texture mask("mask", Format::r8, glm::ivec2(3, 2));
  mask.upload(Texels::redByte, bytes.data());
  const auto readMask = mask.readRgba();
  for (std::size_t i = 0; i < bytes.size(); ++i) EXPECT_FLOAT_EQ(readMask[i].x, static_cast<float>(bytes[i]) / 255.0f);
  const std::array<std::uint8_t, 8> colours{255, 0, 51, 255, 1, 2, 3, 4};
  for (const gl::Format format : std::initializer_list<Format>{Format::rgba8, Format::srgb8Alpha8}) {
    Texture colour("colour", format, glm::ivec2(2, 1));
    colour.upload(Texels::rgbaByte, colours.data());
    std::array<std::uint8_t, 8> back{};
    glActiveTexture(GL_TEXTURE0);
    colour.bind(0);
    glGetTexImage(GL_TEXTURE_2D, 0, GL_RGBA, GL_UNSIGNED_BYTE, back.data());
    EXPECT_EQ(back, colours);
  }
  const std::array<std::int32_t, 2> integers{-2147483647, 2147483647};
  Texture integer("integer", Format::r32i, glm::ivec2(2, 1));
  integer.upload(Texels::redInt, integers.data());
  std::array<std::int32_t, 2> back{};
  integer.bind(0);
  glGetTexImage(GL_TEXTURE_2D, 0, GL_RED_INTEGER, GL_INT, back.data());
  EXPECT_EQ(back, integers);
}

TEST_F(GlObjects, ClearToZeroWithAndWithoutTheExtension) {
  for (const bool haveClearTexture : {false, true}) {
    if (haveClearTexture && !capabilities().clearTexture) {
      std::cout << "[ skipped  ] no ARB_clear_texture here\n";
      continue;
    }
    const std::vector<glm::vec4> ones(4 * 4 * 2, glm::vec4(1.0f));
    Texture deep("3d", Format::rgba16f, glm::ivec3(4, 4, 2)), flat("2d", Format::rgba32f, glm::ivec2(4, 4), {}, 3),
        red("red", Format::r8, glm::ivec2(3, 3)), depth("depth", Format::depth32f, glm::ivec2(2, 2));
    deep.upload(Texels::rgbaFloat, ones.data());
    for (int level = 0; level < 3; ++level) flat.upload(Texels::rgbaFloat, ones.data(), level);
    red.upload(Texels::redFloat, ones.data());
    depth.upload(Texels::depthFloat, ones.data());
    const std::array<const Texture*, 4> all{&deep, &flat, &red, &depth};
    clearToZero(all, haveClearTexture);
    EXPECT_EQ(deep.readRgba(), std::vector<glm::vec4>(32, glm::vec4(0.0f)));
    for (int level = 0; level < 3; ++level) {
      for (const glm::vec4& texel : flat.readRgba(level)) EXPECT_EQ(texel, glm::vec4(0.0f)) << level;
    }
    for (const glm::vec4& texel : red.readRgba()) EXPECT_EQ(texel.x, 0.0f);
    EXPECT_EQ(depth.readDepth(), std::vector<float>(4, 0.0f));
  }
}

TEST_F(GlObjects, BytesAreThoseOfAllLevels) {
  EXPECT_EQ(Texture("t", Format::rgba8, glm::ivec2(8, 4)).bytes(), 8u * 4 * 4);
  EXPECT_EQ(Texture("t", Format::rgba8, glm::ivec2(8, 4), {}, 4).bytes(), 4u * (32 + 8 + 2 + 1));
  EXPECT_EQ(Texture("t", Format::rgba16f, glm::ivec3(3, 5, 7)).bytes(), 8u * 105);
  EXPECT_EQ(Texture("t", Format::rgba32f, glm::ivec3(4, 4, 4), {}, 3).bytes(), 16u * (64 + 8 + 1));
  EXPECT_EQ(Texture("t", Format::r8, glm::ivec3(4, 4, 5), {}, 3, TextureKind::array).bytes(), 5u * (16 + 4 + 1));
}

TEST_F(GlObjects, EditingLeavesTheUnitsOfOthersAlone) {
  Texture mine = small(), other = small();
  mine.bind(3);
  const std::vector<std::uint8_t> data(16, 9);
  other.upload(Texels::rgbaByte, data.data());
  other.readRgba();
  other.generateMipmaps();
  GLint bound = 0;
  glActiveTexture(GL_TEXTURE3);
  glGetIntegerv(GL_TEXTURE_BINDING_2D, &bound);
  EXPECT_EQ(static_cast<GLuint>(bound), mine.id());
}

// ---- programs
// ------------------------------------------------------------------------------------------------------------

class GlPrograms : public test::GlTest {
 protected:
  void SetUp() override {
    GlTest::SetUp();
    write("lib/value.glsl", "float value() { return 0.25; }\n");
    write("fill.vert",
          "void main() { gl_Position = vec4(vec2((gl_VertexID << 1) & 2, gl_VertexID & 2) * 2.0 - 1.0, 0.5, 1.0); }\n");
    write("fill.frag",
          "#include \"lib/value.glsl\"\nlayout(location = 0) out vec4 colour;\nuniform float unused;\nuniform float "
          "factor;\n"
          "void main() {\n#if TWICE\n  colour = vec4(2.0 * value() * factor);\n#else\n  colour = vec4(value() * "
          "factor);\n#endif\n}\n");
    library_ = std::make_unique<ProgramLibrary>(folder_.path());
  }
  void TearDown() override {
    library_.reset();
    GlTest::TearDown();
  }
  ProgramLibrary& library() { return *library_; }
  const Program& fill(bool twice = false) {
    return library().loadRaster("fill", "fill.vert", "fill.frag", {{"TWICE", twice}});
  }

  /// Writes a shader and makes sure that its time of change differs.
  void write(const std::string& name, const std::string& text) {
    const fs::path file = folder_.write(name, text);
    fs::last_write_time(file, fs::file_time_type::clock::now() + std::chrono::seconds(++writes_));
  }
  /// What the program fills a pixel with.
  static float filled(const Program& program) {
    const Texture target("target", Format::rgba32f, glm::ivec2(1));
    const std::array<const Texture*, 1> targets{&target};
    const Framebuffer framebuffer("target", targets);
    const VertexArray empty("empty");
    {
      const RasterPass pass("fill", framebuffer, {});
      program.use();
      program.set("factor", 1.0f);
      drawFullScreen(empty);
    }
    return target.readRgba()[0].x;
  }
  const TempFolder& folder() const { return folder_; }
  /// Mesa also tells its debug output of what does not compile.
  static void forgetCompileErrors() {
    for (const std::string& error : context().takeErrors()) EXPECT_TRUE(has(error, "error: "));
  }

 private:
  TempFolder folder_;
  std::unique_ptr<ProgramLibrary> library_;
  int writes_ = 0;
};

TEST_F(GlPrograms, ReusesTheSameFilesAndFlags) {
  const Program& once = fill(false);
  const Program& twice = fill(true);
  EXPECT_EQ(&once, &fill(false));
  EXPECT_NE(&once, &twice);
  EXPECT_EQ(library().statistics().built, 2);
  EXPECT_EQ(library().statistics().reused, 1);
  EXPECT_EQ(library().names(), (std::vector<std::string>{"fill", "fill"}));
  EXPECT_EQ(filled(once), 0.25f);
  EXPECT_EQ(filled(twice), 0.5f);
}

TEST_F(GlPrograms, UniformsByNameAndThoseOptimisedAwayAreSkipped) {
  const Program& program = fill();
  program.set("unused", 3.0f);
  program.set("neverHeardOf", glm::mat4(1.0f));
  const auto resources = program.activeResources();
  EXPECT_NE(std::find(resources.begin(), resources.end(), "factor"), resources.end());
  EXPECT_EQ(std::find(resources.begin(), resources.end(), "unused"), resources.end());
}

TEST_F(GlPrograms, ACompileErrorNamesItsFileAndLine) {
  write("lib/value.glsl", "\n// two\nfloat value() { return undeclaredName; }\n");
  const std::string message = badInputMessage([&] { fill(); });
  EXPECT_TRUE(has(message, "program fill: shaders/fill.frag does not compile"));
  EXPECT_TRUE(has(message, "shaders/lib/value.glsl:3: "));
  EXPECT_TRUE(has(message, "undeclaredName"));
  EXPECT_TRUE(library().names().empty());
  forgetCompileErrors();
}

TEST_F(GlPrograms, ErrorsBeforeTheDriverReachTheCaller) {
  write("cycle.glsl", "#include \"cycle.glsl\"\n");
  write("cycle.frag", "#include \"cycle.glsl\"\nvoid main() {}\n");
  write("flag.frag", "#if TWCE\n#endif\nvoid main() {}\n");
  write("version.frag", "#version 430\nvoid main() {}\n");
  const auto load = [&](const char* file) {
    return badInputMessage([&] { library().loadRaster("p", "fill.vert", file, {{"TWICE", 1}}); });
  };
  EXPECT_TRUE(has(load("cycle.frag"), "program p: shaders/cycle.glsl:1: include cycle back to shaders/cycle.glsl"));
  EXPECT_TRUE(has(load("flag.frag"), "shaders/flag.frag:1: flag TWCE is not declared"));
  EXPECT_TRUE(has(load("version.frag"), "shaders/version.frag:1: #version"));
  EXPECT_TRUE(has(load("missing.frag"), "shader file shaders/missing.frag is missing"));
}

TEST_F(GlPrograms, ALinkErrorIsAnError) {
  // An input that no stage writes would do for Mesa; NVIDIA links it.
  write("wants.frag",
        "float nobodyDefinesThis();\nlayout(location = 0) out vec4 c;\nvoid main() { c = vec4(nobodyDefinesThis()); "
        "}\n");
  EXPECT_TRUE(
      has(badInputMessage([&] { library().loadRaster("p", "fill.vert", "wants.frag"); }), "program p: does not link"));
}

TEST_F(GlPrograms, HotReloadTakesAChangedInclude) {
  const Program& program = fill();
  const GLuint before = program.id();
  EXPECT_EQ(library().reloadChanged().reloaded, 0);
  EXPECT_EQ(program.id(), before);
  write("lib/value.glsl", "float value() { return 0.75; }\n");
  EXPECT_EQ(library().reloadChanged().reloaded, 1);
  EXPECT_EQ(filled(program), 0.75f);
  EXPECT_EQ(library().reloadChanged().reloaded, 0);
}

TEST_F(GlPrograms, HotReloadKeepsTheOldProgramUntilTheFileIsMended) {
  // Broken in each of the ways there are: for the driver, for our preprocessor, in linking; the file itself and an
  // include.
  struct Break {
    const char* file;
    const char* text;
    const char* message;
  };
  const std::string goodFragment =
      "layout(location = 0) out vec4 colour;\nuniform float factor;\nvoid main() { colour = vec4(0.5 * factor); }\n";
  for (const Break& broken :
       {Break{"lib/value.glsl", "float value() { return ; }\n", "shaders/lib/value.glsl:1"},
        Break{"lib/value.glsl", "#if UNKNOWN\n#endif\n", "flag UNKNOWN is not declared"},
        Break{"fill.frag", "#include \"lib/none.glsl\"\n", "shaders/lib/none.glsl is missing"},
        Break{"fill.vert", "#version 430\n", "#version"},
        Break{"fill.frag", "float nobody();\nlayout(location = 0) out vec4 c;\nvoid main() { c = vec4(nobody()); }\n",
              "does not link"}}) {
    SetUp();
    const Program& program = fill();
    const GLuint before = program.id();
    const std::string good = readFileText(folder() / broken.file);
    write(broken.file, broken.text);
    const auto failed = library().reloadChanged();
    EXPECT_EQ(failed.reloaded, 0);
    ASSERT_EQ(failed.failures.size(), 1u) << broken.message;
    EXPECT_TRUE(has(failed.failures[0], broken.message));
    forgetCompileErrors();
    EXPECT_EQ(program.id(), before);
    EXPECT_EQ(filled(program), 0.25f) << "the old program still draws";
    EXPECT_TRUE(library().reloadChanged().failures.empty()) << "the same failure is told once";
    write(broken.file, good);
    const auto mended = library().reloadChanged();
    EXPECT_EQ(mended.reloaded, 1) << broken.message;
    EXPECT_TRUE(mended.failures.empty());
    write("fill.frag", goodFragment);
    EXPECT_EQ(library().reloadChanged().reloaded, 1) << broken.message;
    EXPECT_EQ(filled(program), 0.5f);
  }
}

TEST_F(GlPrograms, AShaderFolderThatIsMissingIsNamed) {
  const char* known = std::getenv("LUCERNA_SHADERS");
  const std::string before = known ? known : "";
  ::setenv("LUCERNA_SHADERS", "/nowhere/at/all", 1);
  const std::string message = badInputMessage([] { ProgramLibrary(); });
  ::setenv("LUCERNA_SHADERS", before.c_str(), 1);  // empty: the project's own
  EXPECT_TRUE(has(message, "/nowhere/at/all"));
  EXPECT_TRUE(has(message, "LUCERNA_SHADERS"));
}

// ---- passes
// --------------------------------------------------------------------------------------------------------------

class GlPasses : public GlPrograms {
 protected:
  /// Every piece of state that could spoil a pass, set to what spoils it.
  static void poison() {
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    glDepthMask(GL_FALSE);
    glEnable(GL_SCISSOR_TEST);
    glScissor(0, 0, 0, 0);
    glEnable(GL_STENCIL_TEST);
    glStencilFunc(GL_NEVER, 0, 0);
    glEnable(GL_BLEND);
    glBlendFunc(GL_ZERO, GL_ZERO);
    glBlendEquation(GL_FUNC_REVERSE_SUBTRACT);
    glEnable(GL_CULL_FACE);
    glCullFace(GL_FRONT_AND_BACK);
    glFrontFace(GL_CW);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_NEVER);
    glDepthRange(0.9, 0.1);
    glEnable(GL_DEPTH_CLAMP);
    glEnable(GL_POLYGON_OFFSET_FILL);
    glPolygonOffset(1000.0f, 100000.0f);
    glPolygonMode(GL_FRONT_AND_BACK, GL_POINT);
    glViewport(1, 1, 1, 1);
    glEnable(GL_FRAMEBUFFER_SRGB);
    glDisable(GL_PROGRAM_POINT_SIZE);
    glDisable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
    glEnable(GL_RASTERIZER_DISCARD);
    glEnable(GL_COLOR_LOGIC_OP);
    glLogicOp(GL_CLEAR);
    glEnable(GL_SAMPLE_ALPHA_TO_COVERAGE);
    glEnable(GL_SAMPLE_MASK);
    glSampleMaski(0, 0);
    glEnable(GL_PRIMITIVE_RESTART);
    glPrimitiveRestartIndex(0);
  }
  /// Runs after every test: what poison() touched, as a new context has it.
  void TearDown() override {
    glDisable(GL_SCISSOR_TEST);
    glDisable(GL_STENCIL_TEST);
    GlPrograms::TearDown();
  }
};

TEST_F(GlPasses, SetTheirStateWhateverWasBefore) {
  write("depth.vert",
        "uniform float z;\nvoid main() { gl_Position = vec4(vec2((gl_VertexID << 1) & 2, gl_VertexID & 2) * 2.0 - 1.0, "
        "z, 1.0); }\n");
  write("colour.frag",
        "uniform float value;\nlayout(location = 0) out vec4 colour;\nvoid main() { colour = vec4(value); }\n");
  const Program& program = library().loadRaster("p", "depth.vert", "colour.frag");
  const VertexArray empty("empty");
  const auto draw = [&](float value, float z) {
    program.use();
    program.set("value", value);
    program.set("z", z);
    drawFullScreen(empty);
  };
  const auto picture = [&](bool poisoned) {
    const Texture color("colour", Format::rgba32f, glm::ivec2(5, 3)),
        depth("depth", Format::depth32f, glm::ivec2(5, 3));
    const std::array<const Texture*, 1> targets{&color};
    const Framebuffer framebuffer("target", targets, &depth);
    if (poisoned) poison();
    {
      RasterState state;
      state.depth = Depth::lessWrite;
      const RasterPass pass("depth", framebuffer, state);
      pass.clearColor(0, glm::vec4(8.0f));
      pass.clearDepth();
      draw(1.0f, 0.5f);  // nearer than the clear
      draw(2.0f, 0.75f);  // behind: hidden
    }
    GLint bound = -1;
    glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &bound);
    EXPECT_EQ(bound, 0);  // so that shaders may read what was drawn
    if (poisoned) poison();
    {
      RasterState state;
      state.blend = Blend::add;
      const RasterPass pass("add", framebuffer, state);
      draw(0.25f, 0.9f);  // no depth test
      draw(0.25f, 0.9f);
    }
    if (poisoned) poison();
    {
      RasterState state;
      state.depth = Depth::equalReadOnly;
      state.cull = Cull::back;
      const RasterPass pass("equal", framebuffer, state);
      draw(7.0f, 0.6f);  // not equal
    }
    auto result = color.readRgba();
    for (const float z : depth.readDepth()) result.emplace_back(z);
    return result;
  };
  const auto clean = picture(false);
  for (std::size_t i = 0; i < 15; ++i) EXPECT_EQ(clean[i], glm::vec4(1.5f)) << i;
  for (std::size_t i = 15; i < 30; ++i) EXPECT_FLOAT_EQ(clean[i].x, 0.75f) << i;
  EXPECT_EQ(picture(true), clean);
}

TEST_F(GlPasses, ComputeCoversWhatIsAskedForAndMakesItVisible) {
  write("count.comp",
        "layout(local_size_x = 4, local_size_y = 2, local_size_z = 1) in;\nlayout(binding = 0, rgba32f) writeonly "
        "uniform image3D target;\n"
        "void main() { imageStore(target, ivec3(gl_GlobalInvocationID), vec4(gl_GlobalInvocationID + 1u, 1.0)); }\n");
  Texture target("t", Format::rgba32f, glm::ivec3(5, 3, 2));
  poison();
  {
    const ComputePass pass("count");
    library().loadCompute("count", "count.comp").use();
    target.bindImage(0, Access::write);
    pass.dispatch(target.size(), {4, 2, 1});
  }
  const auto texels = target.readRgba();
  for (int i = 0; i < 30; ++i)
    EXPECT_EQ(texels[static_cast<std::size_t>(i)], glm::vec4(i % 5 + 1, i / 5 % 3 + 1, i / 15 + 1, 1)) << i;
}

// ---- timer queries
// -------------------------------------------------------------------------------------------------------

TEST_F(GlPasses, AUniformThatBranchesDependOnIsThatOfItsDispatch) {
  // Dispatches of two programs in turns, each with other values: zink, as it is by default over a software Vulkan, runs
  // one of them with stale ones.
  write("choose.comp",
        "layout(local_size_x = 1) in;\nlayout(std430, binding = 0) buffer Seen { int last; int seen[]; };\n"
        "uniform bool first;\nuniform float share;\nuniform int slot;\n"
        "void main() {\n  int value = 7;\n  if (!first) value = seen[30] + 1;\n  seen[slot] = value + (share > 0.5 ? "
        "100 : 0);\n}\n");
  write("other.comp",
        "layout(local_size_x = 1) in;\nlayout(std430, binding = 0) buffer Seen { int last; int seen[]; };\nuniform int "
        "number;\n"
        "void main() { if (number > 0) last = number; }\n");
  std::array<GLint, 32> words{};
  words[31] = 40;
  const Buffer seen("seen", sizeof words, words.data(), Usage::dynamicCopy);
  const Program &choose = library().loadCompute("choose", "choose.comp"),
                &other = library().loadCompute("other", "other.comp");
  const std::array<bool, 8> firsts{true, false, false, true, false, true, true, false};
  seen.bindStorage(0);
  for (int k = 0; k < 8; ++k) {
    {
      const ComputePass pass("other", Barrier::storage);
      other.use();
      other.set("number", k);
      pass.dispatch({1, 1, 1}, {1, 1, 1});
    }
    const ComputePass pass("choose", Barrier::storage);
    choose.use();
    choose.set("first", firsts[static_cast<std::size_t>(k)] ? 1 : 0);
    choose.set("share", 1.0f);
    choose.set("slot", k);
    pass.dispatch({1, 1, 1}, {1, 1, 1});
  }
  const std::vector<GLint> back = seen.read<GLint>();
  for (std::size_t k = 0; k < 8; ++k) EXPECT_EQ(back[1 + k], firsts[k] ? 107 : 141) << k;
}

class GlTimeQuery : public GlPrograms {};

TEST_F(GlTimeQuery, DropsTheWarmUpAndCountsTheRest) {
  for (const bool finish : {true, false}) {
    TimeQuery timer(finish);
    for (int frame = 0; frame < 5; ++frame) {
      {
        const TimeQuery::Scope stage(timer, "fill");
        filled(fill());
      }
      {
        const TimeQuery::Scope stage(timer, "again");
        filled(fill());
      }
      timer.drain();  // nothing is lost
      EXPECT_EQ(timer.querySamples("fill").size(), static_cast<std::size_t>(frame));
      EXPECT_EQ(timer.wallSamples("fill").size(), finish ? static_cast<std::size_t>(frame) : 0u);
    }
    EXPECT_EQ(timer.dropped(), 0u);
    const auto statistics = timer.statistics();
    ASSERT_EQ(statistics.size(), 2u);
    EXPECT_EQ(statistics[0].name, "fill");
    EXPECT_EQ(statistics[1].name, "again");
    const StageStatistics& s = statistics[0];
    EXPECT_EQ(s.count, 4u);
    EXPECT_DOUBLE_EQ(s.queryMedianMs, median(timer.querySamples("fill")));
    EXPECT_DOUBLE_EQ(s.queryP95Ms, percentile(timer.querySamples("fill"), 0.95));
    EXPECT_EQ(std::isnan(s.wallMedianMs), !finish);
    EXPECT_DOUBLE_EQ(s.medianMs, finish ? median(timer.wallSamples("fill")) : s.queryMedianMs);
    EXPECT_GT(s.medianMs, 0.0);
    for (const double ms : timer.querySamples("fill")) EXPECT_TRUE(ms >= 0.0 && ms < 10000.0) << ms;
    timer.reset();
    EXPECT_EQ(timer.statistics()[0].count, 0u);
    EXPECT_TRUE(std::isfinite(
        timer.statistics()[0].medianMs));  // the warm-up's time is kept: what a stage that runs no more would take
    EXPECT_TRUE(std::isnan(timer.statistics()[0].queryMedianMs));
    EXPECT_TRUE(timer.querySamples("no such stage").empty());
  }
}

TEST_F(GlTimeQuery, CountsFramesAndWhatStagesThatDidNotRunInThemSaved) {
  TimeQuery timer(true);
  for (int frame = 0; frame < 8; ++frame) {
    if (frame < 2) {
      const TimeQuery::Scope stage(timer, "at first");
      filled(fill());
    }
    if (frame == 0) {
      const TimeQuery::Scope stage(timer, "once");
      filled(fill());
    }
    {
      const TimeQuery::Scope stage(timer, "each");
      filled(fill());
    }
    timer.collect();
  }
  timer.drain();
  const auto statistics = timer.statistics();
  ASSERT_EQ(statistics.size(), 3u);
  for (const StageStatistics& s : statistics) EXPECT_EQ(s.frames, 8u);
  EXPECT_EQ(statistics[0].ran, 2u);
  EXPECT_EQ(statistics[1].ran, 1u);
  EXPECT_EQ(statistics[2].ran, 8u);
  EXPECT_EQ(statistics[1].count, 0u);  // it was the warm-up, whose time stands for what it saved
  EXPECT_GT(statistics[1].medianMs, 0.0);
  EXPECT_DOUBLE_EQ(statistics[0].savedMs(), statistics[0].medianMs * 6.0 / 8.0);
  EXPECT_DOUBLE_EQ(statistics[1].savedMs(), statistics[1].medianMs * 7.0 / 8.0);
  EXPECT_EQ(statistics[2].savedMs(), 0.0);
  timer.reset();
  EXPECT_EQ(timer.statistics()[2].ran, 0u);
  EXPECT_EQ(timer.statistics()[2].frames, 0u);
  EXPECT_EQ(timer.statistics()[2].savedMs(), 0.0);
}

TEST_F(GlTimeQuery, NeverMorePendingThanTheRingAndEverySampleIsAccountedFor) {
  TimeQuery timer(false);
  constexpr int kFrames = 50;
  for (int frame = 0; frame < kFrames; ++frame) {
    const TimeQuery::Scope stage(timer, "fill");
    filled(fill());
  }
  const auto fetched = [&] {
    return timer.querySamples("fill").size() + timer.statistics()[0].refused + 1;
  };  // warm-up
  EXPECT_LE(kFrames - timer.dropped() - fetched(), 6u);
  timer.drain();
  EXPECT_EQ(fetched() + timer.dropped(), static_cast<std::size_t>(kFrames));
}

/// A driver that answers time queries with `milliseconds`, or never if that is negative.
class DriverThatAnswers {
 public:
  explicit DriverThatAnswers(double milliseconds) {
    answer_ = milliseconds;
    glGetQueryObjectui64v = [](GLuint, GLenum, GLuint64* result) { *result = static_cast<GLuint64>(1e6 * answer_); };
    glGetQueryObjectiv = [](GLuint, GLenum, GLint* result) { *result = answer_ >= 0.0; };
  }
  ~DriverThatAnswers() {
    glGetQueryObjectui64v = value_;
    glGetQueryObjectiv = number_;
  }

 private:
  inline static double answer_ = 0.0;
  PFNGLGETQUERYOBJECTUI64VPROC value_ = glGetQueryObjectui64v;
  PFNGLGETQUERYOBJECTIVPROC number_ = glGetQueryObjectiv;
};

TEST_F(GlTimeQuery, RefusesWhatTheWallClockContradicts) {
  for (const bool finish : {true, false}) {
    TimeQuery timer(finish);
    const auto stages = [&](int count, double answer) {
      const DriverThatAnswers driver(answer);
      for (int i = 0; i < count; ++i) {
        const TimeQuery::Scope stage(timer, "fill");
        filled(fill());
      }
      timer.drain();
    };
    stages(3, 12241132.0);
    EXPECT_EQ(timer.statistics()[0].refused, 2u);  // and the warm-up
    EXPECT_TRUE(timer.querySamples("fill").empty());
    EXPECT_TRUE(std::isnan(timer.statistics()[0].queryMedianMs));
    EXPECT_EQ(std::isnan(timer.statistics()[0].medianMs), !finish);
    EXPECT_EQ(timer.statistics()[0].savedMs(), 0.0);
    stages(2, 0.0);
    EXPECT_EQ(timer.statistics()[0].refused, 2u);
    EXPECT_EQ(timer.querySamples("fill"), (std::vector<double>{0.0, 0.0}));
    timer.reset();
    EXPECT_EQ(timer.statistics()[0].refused, 0u);
  }
  // A stage that is finished took no longer than until then, however late its answer is asked for.
  TimeQuery timer(true);
  const DriverThatAnswers driver(2000.0);
  for (int i = 0; i < 2; ++i) {
    const TimeQuery::Scope stage(timer, "fill");
    filled(fill());
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(2100));
  timer.drain();
  EXPECT_EQ(timer.statistics()[0].refused, 1u);
}

TEST_F(GlTimeQuery, DoesNotWaitForAnAnswerThatNeverComes) {
  TimeQuery timer(false, 50.0);
  {
    const DriverThatAnswers driver(-1.0);
    for (int i = 0; i < 8; ++i) {
      const TimeQuery::Scope stage(timer, "fill");
      filled(fill());
    }
    timer.drain();
  }
  EXPECT_EQ(timer.statistics()[0].refused + timer.dropped(), 7u);  // and the warm-up
  EXPECT_EQ(timer.dropped(), 2u);
  for (int i = 0; i < 2; ++i) {  // queries that a driver answers again
    const TimeQuery::Scope stage(timer, "fill");
    filled(fill());
  }
  timer.drain();
  EXPECT_EQ(timer.querySamples("fill").size(), 2u);
}

class GlTimeQueryDeathTest : public GlTimeQuery {};
TEST_F(GlTimeQueryDeathTest, StagesDoNotNest) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  TimeQuery timer(true);
  timer.begin("outer");
  EXPECT_DEATH(timer.begin("inner"), "stage inner begun inside stage outer");
  timer.end();
  EXPECT_DEATH(timer.end(), "no stage was begun");
}

// ---- shared structs
// ------------------------------------------------------------------------------------------------------

class GlSharedStructs : public test::GlTest {
 protected:
  static GLint offsetOf(const Program& program, const char* name) {
    const GLuint index = glGetProgramResourceIndex(program.id(), GL_UNIFORM, name);
    if (index == GL_INVALID_INDEX) return -1;
    const GLenum property = GL_OFFSET;
    GLint offset = -1;
    glGetProgramResourceiv(program.id(), GL_UNIFORM, index, 1, &property, 1, nullptr, &offset);
    return offset;
  }
  static GLint sizeOf(const Program& program, const char* block) {
    const GLuint index = glGetProgramResourceIndex(program.id(), GL_UNIFORM_BLOCK, block);
    if (index == GL_INVALID_INDEX) return -1;
    const GLenum property = GL_BUFFER_DATA_SIZE;
    GLint size = -1;
    glGetProgramResourceiv(program.id(), GL_UNIFORM_BLOCK, index, 1, &property, 1, nullptr, &size);
    return size;
  }
};

TEST_F(GlSharedStructs, FrameBlock) {
  using shared::FrameConstants;
  const Program& program = programs().loadRaster("tone map", "lib/fullscreen.vert", "forward/tonemap.frag");
#define EXPECT_OFFSET(member) \
  EXPECT_EQ(offsetOf(program, "frame." #member), static_cast<GLint>(offsetof(FrameConstants, member))) << #member
  EXPECT_OFFSET(clipFromWorld);
  EXPECT_OFFSET(sunClipFromWorld);
  EXPECT_OFFSET(cameraPosition);
  EXPECT_OFFSET(exposure);
  EXPECT_OFFSET(sunDirection);
  EXPECT_OFFSET(shadowNormalOffset);
  EXPECT_OFFSET(sunIrradiance);
  EXPECT_OFFSET(background);
  EXPECT_OFFSET(orthographicAxis);
  EXPECT_OFFSET(sunTangent);
  EXPECT_OFFSET(sampleArea);
#undef EXPECT_OFFSET
  EXPECT_EQ(sizeOf(program, "FrameBlock"), static_cast<GLint>(sizeof(FrameConstants)));
}

TEST_F(GlSharedStructs, CascadeBlock) {
  using shared::CascadeConstants;
  using shared::CascadeGrid;
  const Program& program =
      programs().loadCompute("probe", "lpv/probe.comp", lucerna::LightPropagationVolume::lookupFlags({}));
  const auto inCascade = [](std::size_t k, std::size_t member) {
    return static_cast<GLint>(offsetof(CascadeConstants, cascades) + k * sizeof(CascadeGrid) + member);
  };
  for (std::size_t k = 0; k < MAX_CASCADES; ++k) {
    const auto name = [&](const char* member) { return "grids.cascades[" + std::to_string(k) + "]." + member; };
    EXPECT_EQ(offsetOf(program, name("minimum").c_str()), inCascade(k, offsetof(CascadeGrid, minimum)));
    EXPECT_EQ(offsetOf(program, name("cellSize").c_str()), inCascade(k, offsetof(CascadeGrid, cellSize)));
    EXPECT_EQ(offsetOf(program, name("blendCentre").c_str()), inCascade(k, offsetof(CascadeGrid, blendCentre)));
    EXPECT_EQ(offsetOf(program, name("blendHalf").c_str()), inCascade(k, offsetof(CascadeGrid, blendHalf)));
  }
  EXPECT_EQ(offsetOf(program, "grids.shape"), static_cast<GLint>(offsetof(CascadeConstants, shape)));
  EXPECT_EQ(offsetOf(program, "grids.referenceIrradiance"),
            static_cast<GLint>(offsetof(CascadeConstants, referenceIrradiance)));
  EXPECT_EQ(offsetOf(program, "grids.blendBand"), static_cast<GLint>(offsetof(CascadeConstants, blendBand)));
  EXPECT_EQ(offsetOf(program, "grids.lookupOffset"), static_cast<GLint>(offsetof(CascadeConstants, lookupOffset)));
  EXPECT_EQ(sizeOf(program, "CascadeBlock"), static_cast<GLint>(sizeof(CascadeConstants)));
}

TEST_F(GlSharedStructs, CacheBlockAndBuffer) {
  using shared::CacheConstants;
  using shared::CacheRecord;
  const Program& program = programs().loadCompute("keep", "irradiance_cache/keep.comp",
                                                  {{"GRID_FULL_FLOAT", 0}, {"FOLLOWS", 1}, {"KEEPS", 0}});
#define EXPECT_OFFSET(member) \
  EXPECT_EQ(offsetOf(program, "cache." #member), static_cast<GLint>(offsetof(CacheConstants, member))) << #member
  EXPECT_EQ(offsetOf(program, "cache.firstCell[0]"), static_cast<GLint>(offsetof(CacheConstants, firstCell)));
  EXPECT_OFFSET(rayOrigin);
  EXPECT_OFFSET(frame);
  EXPECT_OFFSET(capacity);
  EXPECT_OFFSET(mostSegments);
  EXPECT_OFFSET(markEvery);
#undef EXPECT_OFFSET
  EXPECT_EQ(sizeOf(program, "CacheBlock"), static_cast<GLint>(sizeof(CacheConstants)));
  const auto property = [&](const char* name, GLenum which) {
    const GLuint index = glGetProgramResourceIndex(program.id(), GL_BUFFER_VARIABLE, name);
    GLint value = -1;
    if (index != GL_INVALID_INDEX)
      glGetProgramResourceiv(program.id(), GL_BUFFER_VARIABLE, index, 1, &which, 1, nullptr, &value);
    return value;
  };
#define EXPECT_OFFSET(member) \
  EXPECT_EQ(property("before[0]." #member, GL_OFFSET), static_cast<GLint>(offsetof(CacheRecord, member))) << #member
  EXPECT_OFFSET(cell);
  EXPECT_OFFSET(triangle);
  EXPECT_OFFSET(state);
  EXPECT_OFFSET(second);
  EXPECT_OFFSET(third);
  EXPECT_OFFSET(irradiance);
  EXPECT_OFFSET(paths);
  EXPECT_OFFSET(born);
  EXPECT_OFFSET(pixel);
  EXPECT_OFFSET(shown);
  EXPECT_OFFSET(blendWeight);
#undef EXPECT_OFFSET
  EXPECT_EQ(property("before[0].cell", GL_TOP_LEVEL_ARRAY_STRIDE), static_cast<GLint>(sizeof(CacheRecord)));
}

// Mesa gives names that rise for ever: 10,000 frames that make and delete some objects each reach 65536.
TEST_F(GlObjects, AreCountedWhateverTheirNames) {
  std::vector<GLuint> names(70000);
  glGenBuffers(static_cast<GLsizei>(names.size()), names.data());
  glDeleteBuffers(static_cast<GLsizei>(names.size()), names.data());
  const std::size_t before = gl::countLiveObjects();
  const gl::Buffer buffer("late", 16, nullptr, gl::Usage::staticDraw);
  EXPECT_EQ(gl::countLiveObjects(), before + 1);
}

}  // namespace
}  // namespace lucerna::gl
