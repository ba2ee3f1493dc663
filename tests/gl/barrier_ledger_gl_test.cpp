// The barrier ledger on a context: missing barriers in programs made for it, and each barrier of the engine.
#include "gl/barrier_ledger.hpp"
#include "gl/draw.hpp"
#include "gl/pass.hpp"
#include "gl/wait.hpp"
#include "irradiance_cache/settings.hpp"
#include "lpv/settings.hpp"
#include "render/renderer.hpp"
#include "rsm/rsm_gather.hpp"
#include "support/contains.hpp"
#include "support/gl_fixture.hpp"
#include "support/media_scenes.hpp"
#include "support/small_scenes.hpp"
#include "support/temp_folder.hpp"

namespace lucerna {
namespace {

class BarrierLedgerOnGl : public test::SharedProgramsTest {
 protected:
  BarrierLedgerOnGl() {
    folder_.write("write.comp", R"(layout(local_size_x = 4) in;
layout(std430, binding = 0) writeonly buffer Cells { uint cells[]; };
void main() { cells[gl_GlobalInvocationID.x] = 1u; }
)");
    folder_.write("read.comp", R"(layout(local_size_x = 4) in;
layout(binding = 0) uniform usamplerBuffer source;
layout(r32ui, binding = 0) writeonly uniform uimage2D target;
void main() { imageStore(target, ivec2(gl_GlobalInvocationID.x, 0), texelFetch(source, int(gl_GlobalInvocationID.x))); }
)");
    folder_.write("chunks.comp", R"(layout(local_size_x = 4) in;
// unordered Cells: each dispatch writes its own four cells
layout(std430, binding = 0) buffer Cells { uint cells[]; };
uniform int first;
void main() { cells[first + gl_LocalInvocationID.x] += 1u; }
)");
  }
  /// Writes cells, reads them as texels into a picture, and reads that back.
  std::vector<std::string> findings(gl::Barrier afterWrite, gl::Barrier afterRead) {
    gl::ProgramLibrary programs(folder_.path());
    gl::BufferTexture cells("cells", gl::Format::r32ui, 16, nullptr);
    const gl::Texture picture("picture", gl::Format::r32ui, glm::ivec2(4, 1));
    {
      const gl::ComputePass pass("fill", afterWrite);
      programs.loadCompute("write", "write.comp").use();
      cells.buffer().bindStorage(0);
      pass.dispatch({4, 1, 1}, {4, 1, 1});
    }
    {
      const gl::ComputePass pass("copy", afterRead);
      programs.loadCompute("read", "read.comp").use();
      cells.bind(0);
      picture.bindImage(0, gl::Access::write);
      pass.dispatch({4, 1, 1}, {4, 1, 1});
    }
    {
      const gl::ComputePass pass("fill again", gl::Barrier::bufferUpdate);
      programs.loadCompute("write", "write.comp").use();
      cells.buffer().bindStorage(0);
      pass.dispatch({4, 1, 1}, {4, 1, 1});
    }
    return context().takeErrors();
  }
  test::TempFolder folder_;
};

TEST_F(BarrierLedgerOnGl, RightBarriersAreNoFinding) {
  EXPECT_EQ(findings(gl::Barrier::textureFetch, gl::Barrier::storage), std::vector<std::string>{});
}

TEST_F(BarrierLedgerOnGl, AMissingBarrierNamesResourceWriterReaderAndBit) {
  EXPECT_EQ(findings(gl::Barrier::storage, gl::Barrier::storage),
            std::vector<std::string>{"RAW: 'cells' was written by dispatch 'write' as storage block Cells; then "
                                     "dispatch 'read' accesses it as sampler source without "
                                     "GL_TEXTURE_FETCH_BARRIER_BIT"});
  EXPECT_EQ(findings(gl::Barrier::textureFetch, gl::Barrier::image),
            (std::vector<std::string>{"WAR: 'cells' was accessed by dispatch 'read' as sampler source; then dispatch "
                                      "'write' accesses it as storage block Cells without "
                                      "GL_SHADER_STORAGE_BARRIER_BIT",
                                      "WAW: 'cells' was written by dispatch 'write' as storage block Cells; then "
                                      "dispatch 'write' accesses it as storage block Cells without "
                                      "GL_SHADER_STORAGE_BARRIER_BIT"}));
}

TEST_F(BarrierLedgerOnGl, DeclaredChunksNeedNoOrderButTheirReaderDoes) {
  gl::ProgramLibrary programs(folder_.path());
  gl::BufferTexture cells("cells", gl::Format::r32ui, 32, nullptr);
  cells.clear();
  const gl::Texture picture("picture", gl::Format::r32ui, glm::ivec2(4, 1));
  const gl::Program& chunks = programs.loadCompute("chunks", "chunks.comp");
  const gl::ComputePass pass("chunks", gl::Barrier::bufferUpdate, gl::Barrier::storage);
  chunks.use();
  cells.buffer().bindStorage(0);
  for (const int first : {0, 4}) {
    chunks.set("first", first);
    pass.dispatch({4, 1, 1}, {4, 1, 1});
  }
  EXPECT_EQ(context().takeErrors(), std::vector<std::string>{});
  programs.loadCompute("read", "read.comp").use();
  cells.bind(0);
  picture.bindImage(0, gl::Access::write);
  pass.dispatch({4, 1, 1}, {4, 1, 1});
  EXPECT_EQ(context().takeErrors().size(), 1u);
}

TEST_F(BarrierLedgerOnGl, NothingBoundIsNamed) {
  gl::ProgramLibrary programs(folder_.path());
  {
    const gl::BufferTexture cells("cells", gl::Format::r32ui, 16, nullptr);
    cells.bind(0);
  }  // deleted, which unbinds it
  const gl::Texture picture("picture", gl::Format::r32ui, glm::ivec2(4, 1));
  const gl::ComputePass pass("copy", gl::Barrier::image);
  programs.loadCompute("read", "read.comp").use();
  picture.bindImage(0, gl::Access::write);
  pass.dispatch({4, 1, 1}, {4, 1, 1});
  EXPECT_EQ(context().takeErrors(),
            std::vector<std::string>{"nothing bound: dispatch 'read' has nothing at sampler source, 0"});
}

// Every barrier on which an access depended in some frames of each technique, taken away: the ledger notices.
TEST_F(BarrierLedgerOnGl, EachBarrierOfTheEngineIsMissed) {
  Scene scene = test::openBox();
  scene.points.push_back({{-1.0, 1.0, 2.0}, glm::vec3(5.0f, 9.0f, 12.0f)});
  RenderSettings base;
  base.size = {32, 24};
  base.shadow.size = base.of<ReflectiveShadowMap::Settings>().size = base.lights.pointSize = 32;
  base.of<LpvSettings>().cascades.cells = base.of<IrradianceCacheSettings>().cascades.cells = 8;
  base.of<LpvSettings>().cascades.cascades = base.of<IrradianceCacheSettings>().cascades.cascades = 3;
  base.of<IrradianceCacheSettings>().samples = 64;
  base.of<IrradianceCacheSettings>().bounces = 1;
  base.of<RsmGather::Settings>().samples = 16;
  struct Case {
    std::string_view technique;
    CacheTransport transport = CacheTransport::rays;
    int lowResolution = 4;
    bool haze = false;
  };
  Scene hazy = scene;
  hazy.media.push_back({});
  hazy.media.back().scattering = glm::vec3(0.1f);
  test::addBox(hazy, glm::dvec3(-4.0), glm::dvec3(4.0), test::addBoundary(hazy, Bsdf::none, 1.0, 0));
  const auto frames = [&](const Case& c) {
    RenderSettings settings = base;
    settings.technique = c.technique;
    settings.of<IrradianceCacheSettings>().transport = c.transport;
    settings.of<RsmGather::Settings>().lowResolution = c.lowResolution;
    settings.of<LpvSettings>().shafts = c.haze;
    settings.of<LpvSettings>().blocking = !c.haze;  // merged views issue the barrier of the shafts' next frame too
    Renderer renderer(context(), library(), c.haze ? hazy : scene, settings);
    renderer.render(test::openBoxCamera());
    renderer.render(test::lookingAt({3.0, 4.0, 4.0}, {-2.0, -2.0, -1.0}));
    renderer.render(test::openBoxCamera());
    if (c.technique == "radiosity") renderer.inspect(library(), test::openBoxCamera(), settings.size / 2);
    renderer.drain();
    renderer.readRadiance();
  };
  gl::BarrierLedger& ledger = *gl::barrierLedger();
  for (const Case& c : {Case{"rsm"}, Case{"rsm", {}, 0}, Case{"lpv"}, Case{"irradiance-cache", CacheTransport::gather},
                        Case{"irradiance-cache"}, Case{"lpv", {}, 4, true}, Case{"path"}, Case{"radiosity"}}) {
    const auto before = ledger.barriers();
    frames(c);
    ASSERT_EQ(context().takeErrors(), std::vector<std::string>{});
    int tried = 0;
    for (const auto& [barrier, use] : std::map(ledger.barriers())) {
      const auto [site, bit] = barrier;
      const auto old = before.find(barrier);
      if (use.needed == (old == before.end() ? 0 : old->second.needed)) continue;
      ledger.omit(site, bit);
      frames(c);
      ledger.omitNothing();
      EXPECT_FALSE(context().takeErrors().empty())
          << c.technique << ": '" << site << "' without " << gl::nameOfBarrierBit(bit);
      ++tried;
    }
    EXPECT_GT(tried, 0) << c.technique;
  }
}

class WaitOnGl : public test::GlTest {};

PFNGLCLIENTWAITSYNCPROC g_driversWait = nullptr;
int g_expiries = 0;
GLenum GLAPIENTRY neverDone(GLsync, GLbitfield, GLuint64) {
  ++g_expiries;
  return GL_TIMEOUT_EXPIRED;
}

TEST_F(WaitOnGl, AGpuThatDoesNotEndIsAnErrorThatNamesThePass) {
  g_driversWait = __glewClientWaitSync;
  __glewClientWaitSync = neverDone;
  gl::setWaitLimit(0.01);
  { const gl::DebugGroup pass("the hung pass"); }
  std::string message;
  try {
    gl::finish();
  } catch (const Error& error) { message = error.what(); }
  gl::setWaitLimit(0.0);
  __glewClientWaitSync = g_driversWait;
  EXPECT_TRUE(test::contains(message, "the GPU has not finished")) << message;
  EXPECT_TRUE(test::contains(message, "the last pass was 'the hung pass'")) << message;
  EXPECT_GT(g_expiries, 1);
  EXPECT_NO_THROW(gl::finish());
}

}  // namespace
}  // namespace lucerna
