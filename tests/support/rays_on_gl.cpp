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
                                                     {"COUNT_WORK", options.countsWork},
                                                     {"OFFSET_ORIGINS", options.offsetOrigins},
                                                     {"SHARED_STACK", scene.sharedStack()}});
  std::vector<std::uint32_t> skip(options.skip.begin(), options.skip.end());
  skip.resize(rays.size(), kNoHit);
  const gl::Buffer rayBuffer("rays", rays.size_bytes(), rays.data(), gl::Usage::staticDraw);
  const gl::Buffer hitBuffer("hits", rays.size() * sizeof(GlHit), nullptr, gl::Usage::streamRead);
  const gl::Buffer skipBuffer("skipped", skip.size() * sizeof skip[0], skip.data(), gl::Usage::staticDraw);
  constexpr int kBatch = 1 << 16;
  const int count = static_cast<int>(rays.size());
  program.use();
  scene.bind();
  rayBuffer.bindStorage(2);
  hitBuffer.bindStorage(3);
  skipBuffer.bindStorage(4);
  program.set("rayCount", count);
  const gl::ComputePass pass("trace rays");
  for (int first = 0; first < count; first += kBatch) {
    program.set("firstRay", first);
    pass.dispatch(glm::ivec3(std::min(kBatch, count - first), 1, 1), glm::ivec3(64, 1, 1));
  }
  return hitBuffer.read<GlHit>();
}

}  // namespace lucerna::test
