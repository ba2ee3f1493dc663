// Floors of LpvReceivers: light at the surfaces that pixels show.
#include "gl/pass.hpp"
#include "gl/pieces.hpp"
#include "lpv/receivers.hpp"
#include "shared/bindings.h"
#include "shared/lpv_receivers.h"

#include <algorithm>

namespace lucerna {

namespace {
constexpr GLuint kListBuffer = 1;  // GL_SHADER_STORAGE_BUFFER
constexpr std::size_t kAtOnce = 1u << 14;  // of LPV_LANES lanes each, per submission: gl/pieces.hpp
}  // namespace

// light: adds to the receivers bound, which are listed and counted like those of cells. The mean of `rounds`.
Image LpvReceivers::atPixels(int rounds, const std::function<void(const gl::Buffer& work)>& light) const {
  const gl::Program& program =
      programs_->loadCompute("lpv receivers of pixels", "lpv/receivers/pixels.comp", rayFlags(LPV_LANES));
  const glm::ivec2 size = path_.picture;
  Image picture(size.x, size.y);
  const std::size_t pixels = picture.pixels.size();
  const gl::Buffer receivers("lpv receivers of pixels", kAtOnce * sizeof(shared::LpvReceiver), nullptr,
                             gl::Usage::dynamicCopy),
      list("lpv list of pixels", kAtOnce * sizeof(GLuint), nullptr, gl::Usage::dynamicCopy);
  gl::Buffer work("lpv work of pixels", kWorkWords * sizeof(GLuint), nullptr, gl::Usage::dynamicCopy);
  const std::size_t blocks = (pixels + kAtOnce - 1) / kAtOnce;
  for (std::size_t i = 0; i < blocks * static_cast<std::size_t>(rounds); ++i) {
    const std::size_t first = i % blocks * kAtOnce, count = std::min(kAtOnce, pixels - first);
    bindReceivers();
    scene_.bind();
    receivers.bindStorage(kReceiversBuffer);
    list.bindStorage(kListBuffer);
    work.upload(0, kWorkWords * sizeof(GLuint), noWork().data());
    work.bindStorage(kWorkBuffer);
    {
      const gl::ComputePass pass("lpv receivers of pixels", gl::Barrier::storage | gl::Barrier::command);
      program.use();
      program.set("first", static_cast<unsigned>(first));
      program.set("round", static_cast<int>(i / blocks));
      program.set("pixels", static_cast<unsigned>(count));
      pass.dispatch(glm::ivec3(static_cast<int>(count), 1, 1), glm::ivec3(64, 1, 1));
    }
    light(work);
    const std::vector<shared::LpvReceiver> lit = receivers.read<shared::LpvReceiver>(count);
    for (std::size_t k = 0; k < count; ++k) {
      const auto pixel = static_cast<int>(first + k);  // rows from the bottom
      picture.at(pixel % size.x, size.y - 1 - pixel / size.x) +=
          glm::max(lit[k].irradiance, 0.0f) / static_cast<float>(rounds);
    }
  }
  return picture;
}

Image LpvReceivers::gatheredAtPixels(const std::vector<ReflectiveShadowMap::Outputs>& maps) const {
  CHECK(gather_, "lpv.transport is not gather");
  constexpr int kRounds = 4;  // of 64 rays each: cells average over several receivers, pixels do not
  return atPixels(kRounds,
                  [&](const gl::Buffer& work) { gather_->gather(maps, work, kLitGroups * sizeof(GLuint), kAtOnce); });
}

Image LpvReceivers::readFromCells(const std::vector<Cascade>& cascades, int paths) const {
  const shared::LpvConstants lpv = lpvConstants(settings_, cascades, referenceIrradiance_);
  const gl::Buffer cells("lpv constants of cells", sizeof lpv, &lpv, gl::Usage::staticDraw);
  gl::ShaderFlags flags = rayFlags(LPV_LANES);
  flags.insert(flags.end(), {{"CACHED", 0}, {"FROM_CELLS", 1}});
  const gl::Program& program = programs_->loadCompute("lpv paths from cells", "lpv/receivers/paths.comp", flags);
  return atPixels(1, [&](const gl::Buffer& work) {
    cells.bindUniform(BLOCK_LPV);
    for (int done = 0; done < paths; done += LPV_LANES) {
      gl::Submission::add(static_cast<double>(kAtOnce * LPV_LANES) * kTurnsOfPath);
      const gl::ComputePass pass("lpv paths from cells", gl::Barrier::storage);
      program.use();
      dispatchListed(pass, program, work);
    }
  });
}

}  // namespace lucerna
