#include "lpv/light_tree.hpp"

#include "base/error.hpp"
#include "gl/pass.hpp"

namespace lucerna {

namespace {
constexpr GLuint kNodesBuffer = 0;
constexpr std::size_t kNodeBytes = 48;
}  // namespace

LightTree::LightTree(gl::ProgramLibrary& programs, const gl::Capabilities& capabilities, int size, int layers,
                     Area area)
    : size_(size), layers_(layers) {
  const auto widthOf = [&](int level) { return (size + (1 << level) - 1) >> level; };
  std::size_t nodes = 0;
  for (int level = 1;; ++level) {
    levels_ = level;
    nodes += static_cast<std::size_t>(widthOf(level)) * static_cast<std::size_t>(widthOf(level)) *
             static_cast<std::size_t>(layers);
    if (widthOf(level) <= kTop) break;
  }
  const std::size_t texels = nodes * kNodeBytes / 16;
  if (texels > static_cast<std::size_t>(capabilities.maxTextureBufferSize))
    throwMissingCapability(
        "light tree of a map of {} texels per side: {} texels; this driver's texture buffers have at most {} "
        "(GL_MAX_TEXTURE_BUFFER_SIZE)",
        size, texels, capabilities.maxTextureBufferSize);
  nodes_ = gl::BufferTexture("light tree", gl::Format::rgba32ui, nodes * kNodeBytes, nullptr, gl::Usage::dynamicCopy);
  fromTexels_ = &programs.loadCompute("light tree of texels", "lpv/gather/build.comp",
                                      {{"FROM_TEXELS", 1}, {"MEAN_AREA", area == Area::mean}});
  fromNodes_ = &programs.loadCompute("light tree of nodes", "lpv/gather/build.comp",
                                     {{"FROM_TEXELS", 0}, {"MEAN_AREA", area == Area::mean}});
}

void LightTree::setShape(const gl::Program& program) const {
  program.set("treeSize", size_);
  program.set("treeLayers", layers_);
  program.set("treeLevels", levels_);
}

void LightTree::build(const ReflectiveShadowMap::Outputs& map) {
  for (int level = 1; level <= levels_; ++level) {
    const gl::ComputePass pass("light tree", gl::Barrier::storage | gl::Barrier::textureFetch);
    const gl::Program& program = level == 1 ? *fromTexels_ : *fromNodes_;
    program.use();
    setShape(program);
    program.set("level", level);
    if (level == 1) map.bind();
    nodes_.buffer().bindStorage(kNodesBuffer);
    const int width = (size_ + (1 << level) - 1) >> level;
    pass.dispatch(glm::ivec3(width, width, layers_), glm::ivec3(8, 8, 1));
  }
}

void LightTree::bind(const gl::Program& program, GLuint unit) const {
  setShape(program);
  nodes_.bind(unit);
}

}  // namespace lucerna
