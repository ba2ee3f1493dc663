// Memory: gpuBytes() is what the driver was asked for, and long walks and reloads take no more than short ones.
#include "irradiance_cache/settings.hpp"
#include "lpv/settings.hpp"
#include "pathtracer/path_tracer.hpp"
#include "radiosity/radiosity_view.hpp"
#include "render/renderer.hpp"
#include "rsm/rsm_gather.hpp"
#include "support/gl_fixture.hpp"
#include "support/long_tests.hpp"
#include "support/sanitizers.hpp"
#include "support/small_scenes.hpp"
#include "support/temp_folder.hpp"

#include <gtest/gtest.h>

#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace lucerna {
namespace {

// ------------------------------------------------------------------------------------------------ what the driver
// holds

/// Buffers and textures that were given storage while it lives, by the driver's own answers about those that are still
/// there.
class Allocations {
 public:
  Allocations() {
    buffers().clear(), textures().clear();
    bufferData_ = __glewBufferData, storage2d_ = __glewTexStorage2D, storage3d_ = __glewTexStorage3D;
    __glewBufferData = [](GLenum target, GLsizeiptr size, const void* data, GLenum usage) GLAPIENTRY {
      GLint id = 0;
      EXPECT_EQ(target, static_cast<GLenum>(GL_COPY_WRITE_BUFFER));
      glGetIntegerv(GL_COPY_WRITE_BUFFER_BINDING, &id);
      buffers().insert(static_cast<GLuint>(id));
      bufferData_(target, size, data, usage);
    };
    __glewTexStorage2D = [](GLenum target, GLsizei levels, GLenum format, GLsizei width, GLsizei height) GLAPIENTRY {
      remember(target, levels);
      storage2d_(target, levels, format, width, height);
    };
    __glewTexStorage3D = [](GLenum target, GLsizei levels, GLenum format, GLsizei width, GLsizei height, GLsizei depth)
                             GLAPIENTRY {
                               remember(target, levels);
                               storage3d_(target, levels, format, width, height, depth);
                             };
  }
  ~Allocations() { __glewBufferData = bufferData_, __glewTexStorage2D = storage2d_, __glewTexStorage3D = storage3d_; }
  Allocations(const Allocations&) = delete;
  Allocations& operator=(const Allocations&) = delete;

  std::size_t liveBytes() const {
    std::size_t bytes = 0;
    for (const GLuint id : buffers()) {
      if (!glIsBuffer(id)) continue;
      GLint64 size = 0;
      glBindBuffer(GL_COPY_READ_BUFFER, id);
      glGetBufferParameteri64v(GL_COPY_READ_BUFFER, GL_BUFFER_SIZE, &size);
      bytes += static_cast<std::size_t>(size);
    }
    for (const auto& [id, kind] : textures()) {
      if (!glIsTexture(id)) continue;
      const auto [target, levels] = kind;
      const GLenum face = target == GL_TEXTURE_CUBE_MAP ? GL_TEXTURE_CUBE_MAP_POSITIVE_X : target;
      glBindTexture(target, id);
      for (GLint level = 0; level < levels; ++level) {
        const auto ask = [face, level](GLenum what) {
          GLint value = 0;
          glGetTexLevelParameteriv(face, level, what, &value);
          return static_cast<std::size_t>(value);
        };
        std::size_t bits = 0;
        for (const int part : {GL_TEXTURE_RED_SIZE, GL_TEXTURE_GREEN_SIZE, GL_TEXTURE_BLUE_SIZE, GL_TEXTURE_ALPHA_SIZE,
                               GL_TEXTURE_DEPTH_SIZE})
          bits += ask(static_cast<GLenum>(part));
        bytes += bits / 8 * ask(GL_TEXTURE_WIDTH) * ask(GL_TEXTURE_HEIGHT) * ask(GL_TEXTURE_DEPTH) *
                 (target == GL_TEXTURE_CUBE_MAP ? 6 : 1);
      }
    }
    return bytes;
  }

 private:
  static std::set<GLuint>& buffers() {
    static std::set<GLuint> ids;
    return ids;
  }
  /// Target and levels.
  static std::map<GLuint, std::pair<GLenum, GLint>>& textures() {
    static std::map<GLuint, std::pair<GLenum, GLint>> ids;
    return ids;
  }
  static void remember(GLenum target, GLint levels) {
    const std::map<GLenum, GLenum> bindings{{GL_TEXTURE_2D, GL_TEXTURE_BINDING_2D},
                                            {GL_TEXTURE_3D, GL_TEXTURE_BINDING_3D},
                                            {GL_TEXTURE_2D_ARRAY, GL_TEXTURE_BINDING_2D_ARRAY},
                                            {GL_TEXTURE_CUBE_MAP, GL_TEXTURE_BINDING_CUBE_MAP},
                                            {GL_TEXTURE_CUBE_MAP_ARRAY, GL_TEXTURE_BINDING_CUBE_MAP_ARRAY}};
    GLint id = 0;
    glGetIntegerv(bindings.at(target), &id);
    textures()[static_cast<GLuint>(id)] = {target, levels};
  }
  inline static PFNGLBUFFERDATAPROC bufferData_ = nullptr;
  inline static PFNGLTEXSTORAGE2DPROC storage2d_ = nullptr;
  inline static PFNGLTEXSTORAGE3DPROC storage3d_ = nullptr;
};

/// The open box with lamps of every kind, pictures of every kind and a sky.
Scene everything() {
  Scene scene = test::openBox();
  scene.spots.push_back({{0.0, 3.0, 0.0}, {0.0, -1.0, 0.0}, glm::vec3(5.0f), 0.4, 0.6});
  scene.points.push_back({{1.0, 1.0, 0.0}, glm::vec3(2.0f)});
  scene.environment = Environment{glm::vec3(0.2f), Image(4, 2, glm::vec3(1.0f)), 0.0};
  Texture& texture = scene.textures.emplace_back();
  texture.file = "a picture";
  texture.bitmap = {5, 3, std::vector<std::uint8_t>(60, 200), true};
  Material& material = scene.materials.front();
  material.diffuseTexture = material.emissionTexture = material.normalTexture = 0;
  material.alphaMasked = true;
  material.emission = material.emissionScale = glm::vec3(0.1f);
  material.metalMap = MetalMap{material.diffuse, 0.5f, 0.5f, 0};
  return scene;
}

using Memory = test::GlTest;

RenderSettings smallSettings() {
  RenderSettings settings;
  settings.size = {48, 32};
  settings.shadow.size = 128;
  settings.of<ReflectiveShadowMap::Settings>().size = 32;
  settings.lights.spotSize = settings.lights.pointSize = 32;
  settings.of<LpvSettings>().cascades.cells = settings.of<IrradianceCacheSettings>().cascades.cells = 8;
  settings.of<IrradianceCacheSettings>().samples = 16;
  settings.of<IrradianceCacheSettings>().bounces = 1;
  settings.of<RadiosityView::Settings>().solution.hemicubes.resolution = 32;
  settings.of<RadiosityView::Settings>().solution.patches.longestEdge = 6.0;
  return settings;
}

TEST_F(Memory, GpuBytesAreWhatTheDriverWasAskedFor) {
  const Scene lean = test::openBox(), full = everything();
  for (const Scene* scene : {&lean, &full})
    for (const std::string_view technique : {"direct", "rsm", "lpv", "irradiance-cache", "radiosity"})
      for (const CacheTransport transport : {CacheTransport::rays, CacheTransport::gather})
        for (const int cascades : {1, 2}) {
          const bool isCache = technique == "irradiance-cache";
          if (!isCache && transport != CacheTransport::rays) continue;
          if (cascades == 2 && (technique == "radiosity" || isCache)) continue;
          RenderSettings settings = smallSettings();
          settings.technique = technique;
          settings.of<IrradianceCacheSettings>().transport = transport;
          settings.shadow.cascades.cascades = cascades;
          settings.of<RsmGather::Settings>().lowResolution = cascades == 1 ? 4 : 1;
          const Allocations allocations;
          Renderer renderer(context(), programs(), *scene, settings);
          for (int frame = 0; frame < 3; ++frame) renderer.render(test::openBoxCamera());
          EXPECT_EQ(renderer.gpuBytes(), allocations.liveBytes())
              << technique << " " << nameOf(transport) << " " << cascades << (scene == &full ? " full" : "");
        }
  for (const Scene* scene : {&lean, &full}) {
    PathTracer::Settings settings;
    settings.size = {48, 32};
    const Allocations allocations;
    PathTracer tracer(context(), programs(), *scene, settings);
    tracer.record(2);
    EXPECT_EQ(tracer.gpuBytes(), allocations.liveBytes()) << "path" << (scene == &full ? " full" : "");
  }
}

// ---------------------------------------------------------------------------------------------------- what stays flat

struct MemoryTaken {
  double resident = 0.0;  ///< of this process in bytes, without what free() keeps for later
  double heap = 0.0;  ///< bytes that malloc() has given away
};

MemoryTaken memoryTaken() {
  malloc_trim(0);
  std::ifstream file("/proc/self/statm");
  double pages = 0.0, resident = 0.0;
  file >> pages >> resident;
  const struct mallinfo2 heap = mallinfo2();
  return {resident * static_cast<double>(sysconf(_SC_PAGESIZE)), static_cast<double>(heap.uordblks + heap.hblkhd)};
}

/// `step` is called so often. A leak grows in every quarter; a driver's one step (a pool that fills) in one. llvmpipe's
/// threads keep 0.6 MiB or more for each frame that was in flight at once, so ctest runs these tests without threads.
template <class Step>
void expectFlat(const char* what, int times, const Step& step) {
  std::array<MemoryTaken, 4> taken;
  for (int i = 0; i < times; ++i) {
    step(i);
    if ((i + 1) % (times / 4) == 0) taken.at(static_cast<std::size_t>((i + 1) / (times / 4) - 1)) = memoryTaken();
  }
  for (const auto member : {&MemoryTaken::resident, &MemoryTaken::heap}) {
    double least = std::numeric_limits<double>::infinity();
    std::printf("%s, %s:", what, member == &MemoryTaken::heap ? "heap" : "resident");
    for (std::size_t quarter = 0; quarter < 4; ++quarter) {
      std::printf(" %.2f", taken[quarter].*member / 1048576.0);
      if (quarter > 0) least = std::min(least, taken[quarter].*member - taken[quarter - 1].*member);
    }
    std::printf(" MiB after the quarters of %d\n", times);
    EXPECT_LT(least, 0.0025 * taken[0].*member) << what << ": memory grows in every quarter";
  }
}

TEST_F(Memory, AWalkTakesNoMoreInTheEndThanAtItsBeginning) {
  if (test::kSanitized) GTEST_SKIP() << "a sanitizer allocates, and keeps what was freed";
  const Scene scene = everything();
  for (const std::string_view technique : {"irradiance-cache", "lpv"}) {
    RenderSettings settings = smallSettings();
    settings.technique = technique;
    Renderer renderer(context(), programs(), scene, settings);
    std::size_t bytes = 0;
    const int frames = test::longTests() ? 2000 : 80;
    expectFlat(std::string(technique).c_str(), frames, [&](int i) {
      Camera camera = test::openBoxCamera();
      const double angle = 0.05 * i;
      camera.position += glm::dvec3(std::sin(angle), 0.3 * std::sin(0.7 * angle), std::cos(angle));
      camera.direction = glm::normalize(-camera.position);
      renderer.render(camera);
      if (i == 8) bytes = renderer.gpuBytes();
      if (i > 8) { EXPECT_EQ(renderer.gpuBytes(), bytes) << i; }
    });
  }
}

TEST_F(Memory, ReloadedScenesLeaveNothing) {
  if (test::kSanitized) GTEST_SKIP() << "a sanitizer allocates, and keeps what was freed";
  const test::TempFolder folder;
  std::string text = "mtllib m.mtl\nusemtl a\n";
  constexpr int kSide = 60;
  for (int y = 0; y <= kSide; ++y)
    for (int x = 0; x <= kSide; ++x)
      text +=
          fmt::format("v {} {} {}\nvt {} {}\n", x, 0.3 * std::sin(0.5 * x) * std::cos(0.4 * y), y, 0.1 * x, 0.1 * y);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const int i = y * (kSide + 1) + x + 1;
      text += fmt::format("f {0}/{0} {1}/{1} {2}/{2} {3}/{3}\n", i, i + kSide + 1, i + kSide + 2, i + 1);
    }
  folder.write("m.mtl", "newmtl a\nKd 0.5 0.4 0.3\nmap_Kd t.tga\n");
  folder.write("t.tga",
               std::string("\0\0\2\0\0\0\0\0\0\0\0\0\0\1\0\1\x20\x28", 18) + std::string(256 * 256 * 4, '\x60'));
  const auto file = folder.write("m.obj", text);
  expectFlat("reloads", test::longTests() ? 52 : 12, [&](int) {
    const Scene scene = loadScene(file);
    gl::ProgramLibrary library;
    RenderSettings settings = smallSettings();
    settings.technique = "irradiance-cache";
    Renderer renderer(context(), library, scene, settings);
    for (int frame = 0; frame < 3; ++frame) renderer.render(scene.cameras.front());
    renderer.drain();
  });
}

}  // namespace
}  // namespace lucerna
