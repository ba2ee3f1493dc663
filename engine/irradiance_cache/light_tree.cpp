#include "irradiance_cache/light_tree.hpp"

#include "base/error.hpp"
#include "gl/pass.hpp"
#include "shared/irradiance_cache.h"

#include <algorithm>
#include <bit>

namespace lucerna {

namespace {
constexpr std::size_t kNodeBytes = 48;
}  // namespace

LightTree::LightTree(gl::ProgramLibrary& programs, const gl::Capabilities& capabilities, int size, int layers,
                     Area area)
    : size_(size),
      layers_(layers),
      depth_(std::max(1, static_cast<int>(std::bit_width(static_cast<unsigned>(size - 1))))),
      top_(std::min(depth_ - 1, kTop)) {
  const std::size_t nodes = ((std::size_t{1} << (2 * depth_ + 2)) - 1) / 3 * static_cast<std::size_t>(layers);
  const std::size_t texels = nodes * kNodeBytes / 16;
  if (texels > static_cast<std::size_t>(capabilities.maxTextureBufferSize))
    throwMissingCapability(
        "light tree of a map of {} texels per side: {} texels; this driver's texture buffers have at most {} "
        "(GL_MAX_TEXTURE_BUFFER_SIZE)",
        size, texels, capabilities.maxTextureBufferSize);
  nodes_ = gl::BufferTexture("light tree", gl::Format::rgba32ui, nodes * kNodeBytes, nullptr, gl::Usage::dynamicCopy);
  fromTexels_ = &programs.loadCompute("light tree of texels", "irradiance_cache/gather/build.comp",
                                      {{"FROM_TEXELS", 1}, {"MEAN_AREA", area == Area::mean}});
  fromNodes_ = &programs.loadCompute("light tree of nodes", "irradiance_cache/gather/build.comp",
                                     {{"FROM_TEXELS", 0}, {"MEAN_AREA", area == Area::mean}});
}

void LightTree::setShape(const gl::Program& program) const {
  program.set("treeSize", size_);
  program.set("treeLayers", layers_);
  program.set("treeDepth", depth_);
  program.set("treeTop", top_);
}

void LightTree::build(const ReflectiveShadowMap::Outputs& map) {
  for (int depth = depth_ - 1; depth >= top_; --depth) {
    const gl::ComputePass pass("light tree", gl::Barrier::storage | gl::Barrier::textureFetch);
    const bool fromTexels = depth == depth_ - 1;
    const gl::Program& program = fromTexels ? *fromTexels_ : *fromNodes_;
    program.use();
    setShape(program);
    program.set("depth", depth);
    if (fromTexels) map.bind();
    nodes_.buffer().bindStorage(CACHE_NODES_BUFFER);
    pass.dispatch(glm::ivec3(1 << depth, 1 << depth, layers_), glm::ivec3(8, 8, 1));
  }
}

void LightTree::bind(const gl::Program& program, GLuint unit) const {
  setShape(program);
  nodes_.bind(unit);
}

}  // namespace lucerna
