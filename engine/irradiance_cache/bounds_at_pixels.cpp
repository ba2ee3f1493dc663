// Floors of IrradianceCache: light at the surfaces that pixels show.
#include "gl/pass.hpp"
#include "gl/chunks.hpp"
#include "irradiance_cache/irradiance_cache.hpp"
#include "shared/bindings.h"
#include "shared/irradiance_cache.h"

#include <algorithm>

namespace lucerna {

namespace {
constexpr std::size_t kAtOnce = 1u << 14;  // of CACHE_LANES lanes each, per submission: gl/chunks.hpp
}  // namespace

// light: adds to the records bound, which are listed and counted like those of cells. The mean of `rounds`.
Image IrradianceCache::atPixels(int rounds, const std::function<void(const gl::Buffer& work)>& light) const {
  const gl::Program& program =
      programs_->loadCompute("cache records of pixels", "irradiance_cache/pixels.comp", rayFlags(CACHE_LANES));
  const glm::ivec2 size = path_.picture;
  Image picture(size.x, size.y);
  const std::size_t pixels = picture.pixels.size();
  const gl::Buffer records("cache records of pixels", kAtOnce * sizeof(shared::CacheRecord), nullptr,
                           gl::Usage::dynamicCopy),
      list("cache list of pixels", kAtOnce * sizeof(GLuint), nullptr, gl::Usage::dynamicCopy);
  gl::Buffer work("cache work of pixels", kWorkWords * sizeof(GLuint), nullptr, gl::Usage::dynamicCopy);
  const std::size_t blocks = (pixels + kAtOnce - 1) / kAtOnce;
  for (std::size_t i = 0; i < blocks * static_cast<std::size_t>(rounds); ++i) {
    const std::size_t first = i % blocks * kAtOnce, count = std::min(kAtOnce, pixels - first);
    bindRecords();
    scene_.bind();
    records.bindStorage(CACHE_RECORDS_BUFFER);
    list.bindStorage(CACHE_LIST_BUFFER);
    work.upload(0, kWorkWords * sizeof(GLuint), noWork().data());
    work.bindStorage(CACHE_WORK_BUFFER);
    {
      const gl::ComputePass pass("cache records of pixels", gl::Barrier::storage | gl::Barrier::command);
      program.use();
      program.set("first", static_cast<unsigned>(first));
      program.set("round", static_cast<int>(i / blocks));
      program.set("pixels", static_cast<unsigned>(count));
      pass.dispatch(glm::ivec3(static_cast<int>(count), 1, 1), glm::ivec3(64, 1, 1));
    }
    light(work);
    const std::vector<shared::CacheRecord> lit = records.read<shared::CacheRecord>(count);
    for (std::size_t k = 0; k < count; ++k) {
      const auto pixel = static_cast<int>(first + k);  // rows from the bottom
      picture.at(pixel % size.x, size.y - 1 - pixel / size.x) +=
          glm::max(lit[k].irradiance, 0.0f) / static_cast<float>(rounds);
    }
  }
  return picture;
}

Image IrradianceCache::gatheredAtPixels(const std::vector<ReflectiveShadowMap::Outputs>& maps) const {
  CHECK(gather_, "cache.transport is not gather");
  constexpr int kRounds = 4;  // of 64 rays each: cells average over several records, pixels do not
  return atPixels(kRounds,
                  [&](const gl::Buffer& work) { gather_->gather(maps, work, kLitGroups * sizeof(GLuint), kAtOnce); });
}

Image IrradianceCache::readFromCells(const CascadeSettings& settings, const std::vector<Cascade>& cascades,
                                     float blendBand, int paths) const {
  const shared::CascadeConstants grids = cascadeConstants(settings, cascades, blendBand, referenceIrradiance_);
  const gl::Buffer cells("cascades of cells", sizeof grids, &grids, gl::Usage::staticDraw);
  gl::ShaderFlags flags = rayFlags(CACHE_LANES);
  flags.insert(flags.end(), {{"CACHED", 0}, {"FROM_CELLS", 1}, {"KEEPS", 0}});
  const gl::Program& program = programs_->loadCompute("cache paths from cells", "irradiance_cache/paths.comp", flags);
  return atPixels(1, [&](const gl::Buffer& work) {
    cells.bindUniform(BLOCK_CASCADES);
    for (int done = 0; done < paths; done += CACHE_LANES) {
      gl::Submission::add(static_cast<double>(kAtOnce * CACHE_LANES) * kIterationsOfPath);
      const gl::ComputePass pass("cache paths from cells", gl::Barrier::storage);
      program.use();
      dispatchListed(pass, program, work);
    }
  });
}

}  // namespace lucerna
