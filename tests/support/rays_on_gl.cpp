#include "support/rays_on_gl.hpp"

#include "gl/pass.hpp"

#include <algorithm>

namespace lucerna::test {

std::vector<GlHit> trace(gl::ProgramLibrary& programs, const RayScene& scene, std::span<const GlRay> rays,
                         const TraceOptions& options) {
  if (rays.empty()) return {};
  const gl::Program& program = programs.loadCompute("trace rays", "rays/trace_rays.comp",
                                                    {{"ALPHA_MASKS", options.alphaMasks},
                                                     {"ANY_HIT", options.anyHit},
                                                     {"COUNT_WORK", 0},
                                                     {"OFFSET_ORIGINS", options.offsetOrigins},
                                                     {"SHARED_STACK", scene.sharedStack()}});
  std::vector<std::uint32_t> skip(options.skip.begin(), options.skip.end());
  skip.resize(rays.size(), kNoHit);
  const gl::Buffer rayBuffer("rays", rays.size_bytes(), rays.data(), GL_STATIC_DRAW);
  const gl::Buffer hitBuffer("hits", rays.size() * sizeof(GlHit), nullptr, GL_STREAM_READ);
  const gl::Buffer skipBuffer("skipped", skip.size() * sizeof skip[0], skip.data(), GL_STATIC_DRAW);
  constexpr int kBatch = 1 << 16;
  const int count = static_cast<int>(rays.size());
  program.use();
  scene.bind();
  rayBuffer.bind(GL_SHADER_STORAGE_BUFFER, 2);
  hitBuffer.bind(GL_SHADER_STORAGE_BUFFER, 3);
  skipBuffer.bind(GL_SHADER_STORAGE_BUFFER, 4);
  program.set("rayCount", count);
  for (int first = 0; first < count; first += kBatch) {
    const gl::ComputePass pass("trace rays", GL_BUFFER_UPDATE_BARRIER_BIT);
    program.set("firstRay", first);
    pass.dispatch(glm::ivec3(std::min(kBatch, count - first), 1, 1), glm::ivec3(64, 1, 1));
  }
  return hitBuffer.read<GlHit>();
}

}  // namespace lucerna::test
